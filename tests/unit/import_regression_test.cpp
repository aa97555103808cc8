#include <fmt/format.h>

#include "import_test_support.h"
#include "stages/import/format.h"

// Faults that fuzzing and hostile recordings have found, each by its name.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

std::string failure_of_files(const std::vector<RecordingBytes>& files) {
    try {
        (void)import_recordings(pos_receiver(), files);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "read";
}

// Splitting a line at blanks never came past a NUL, and took memory until there was none.
TEST(ImportRegression, ANulInTheFirstLineIsNoRowOfAPos) {
    const std::string binary("1\0\0 2 \0\0\0 3\n\0", 14);
    EXPECT_FALSE(find_format("rtklib-pos")->recognises(binary));
    EXPECT_NE(failure_of(pos_receiver(), binary).find("byte 1 is NUL"), std::string::npos);
}

// A column's name of bytes that are no text stood in a note, and came back as another.
TEST(ImportRegression, AColumnsNameOfAnyBytesIsWrittenAndComesBack) {
    const std::string text =
        "%  GPST  latitude(deg)  longitude(deg)  height(m)  Q  ns  sdn(m)  sde(m)  sdu(m)  "
        "sdne(m)  sdeu(m)  sdun(m)  age(s)  ratio  \xe7\xe7\n"
        "2023/07/11 06:04:30.000  45.1  9.2  41.4  1  16  0.005  0.005  0.01  "
        "0.003  0.002  -0.003  0.03  6.4  1.0\n";
    const Observations read = import_text(pos_receiver(), text);
    EXPECT_TRUE(has_note(read, "Columns that are not used: \\xe7\\xe7."));
}

// Its epochs counted as two measurements each.
TEST(ImportRegression, AFileGivenTwiceIsRefused) {
    const std::string one = fixture("degrees.pos");
    const std::string other = replaced(one, "made by hand", "made again");
    EXPECT_EQ(failure_of_files({{"a.pos", one}, {"b.pos", other}}), "read");
    const std::string refused =
        failure_of_files({{"a.pos", one}, {"b.pos", other}, {"copy.pos", one}});
    EXPECT_NE(refused.find("copy.pos:1:1: files 1 and 3 are the same"), std::string::npos)
        << refused;
}

// Each pair of bytes began a header of 512 bytes whose checksum was formed: minutes for a GiB.
TEST(ImportRegression, OaoOfNothingButBeginningsIsGivenUp) {
    Receiver receiver = pos_receiver();
    receiver.format = "oao";
    std::string bytes;
    for (std::size_t i = 0; i < std::size_t{16} << 20; ++i)
        bytes += "\xd0\x0a";
    const std::string refused = failure_of(receiver, bytes);
    // Its beginning alone was looked through.
    EXPECT_NE(refused.find("50000 of 50000"), std::string::npos) << refused;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
