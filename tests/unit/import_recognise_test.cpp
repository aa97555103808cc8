#include "core/random.h"
#include "import_test_support.h"
#include "stages/import/format.h"
#include "stages/import/recording.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;
using std::string_literals::operator""s;

TEST(ImportRecognise, WhatIsNotReadIsNamed) {
    const struct {
        std::string bytes, where, what;
    } cases[] = {
        {"", "f:1:1", "empty, 0 bytes"},
        {"\xff\xfe\0\0%\0\0\0"s, "f:1:1", "UTF-32 text, which is not read. Save as UTF-8"},
        {"PK\x03\x04zip", "f:1:1", "ZIP archive"},
        {"\x1f\x8b\x08", "f:1:1", "gzip"},
        {"abc\ndef\0g"s, "f:2:4", "byte 7 is NUL"},
        {"%PDF-1.4\n", "f:1:1", "PDF document, which is not read"},
        {"     2.11           OBSERVATION DATA    M (MIXED)           RINEX VERSION / TYPE\n",
         "f:1:1", "RINEX"},
        {"hello\n", "f:1:1", "it begins \"hello\". Formats that are read: RTKLIB"},
        {"hello there, you\nhello to all of you\n", "f:1:1", "is not recognised"},
        {"a,b,c,d\n1,2,3,4\n", "f:1:1", "the attempt names no columns"},
        {"a b  c d\n1 2 3  4\n", "f:1:1", "the attempt names no columns"},
    };
    for (const auto& bad : cases) {
        const std::string message = failure_of(pos_receiver(), bad.bytes);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_NE(message.find(bad.what), std::string::npos) << message;
    }
}

// Each as a file of its kind begins, whatever follows.
TEST(ImportNotRead, EachKindSaysWhatToDo) {
    for (const NotRead& kind : kinds_not_read())
        for (const std::string& after : {std::string("\n"), std::string(600, '\x01')}) {
            std::string bytes(kind.offset, kind.offset == 30 ? 'P' : 'x');
            if (kind.offset == 30) bytes.replace(0, 4, "PK\x03\x04");
            bytes =
                (kind.is_line ? "# log of today\n" : "") + bytes + std::string(kind.bytes) + after;
            const std::string message = failure_of(pos_receiver(), bytes);
            EXPECT_EQ(message.rfind(fmt::format("f:1:1: the file is {}, which is not read. {}",
                                                kind.name, kind.remedy),
                                    0),
                      0U)
                << message;
        }
}

TEST(ImportNotRead, EachKindIsListedForPeople) {
    const std::string readme = slurp(std::string(RUNCERT_SOURCE_DIR) + "/stages/import/README.md");
    for (const NotRead& kind : kinds_not_read())
        EXPECT_TRUE(has(readme, fmt::format("| {} |", kind.name)) && has(readme, kind.remedy))
            << kind.name << ": " << kind.remedy;
}

TEST(ImportFormats, EachIsListedForPeople) {
    const std::string readme = slurp(std::string(RUNCERT_SOURCE_DIR) + "/stages/import/README.md");
    for (const Format* format : formats())
        EXPECT_TRUE(has(readme, fmt::format("| `{}` |", format->name))) << format->name;
}

/// The text in UTF-16, the low byte of each unit first or last.
std::string in_utf16(const std::u16string& text, bool big_endian, bool mark) {
    std::string bytes;
    for (const char16_t unit : (mark ? u"\xfeff" : u"") + text) {
        const auto low = static_cast<char>(unit & 0xff), high = static_cast<char>(unit >> 8);
        bytes += big_endian ? high : low;
        bytes += big_endian ? low : high;
    }
    return bytes;
}

// RTKLIB's, a table and a track: what a spreadsheet or an editor saved as "Unicode".
TEST(ImportUtf16, EveryTextFormatIsReadAsItsUtf8) {
    Receiver table = csv_receiver();
    table.columns.erase("height");
    table.height_m = 10.0;
    const std::pair<Receiver, std::string> texts[] = {
        {pos_receiver(), fixture("degrees.pos")},
        {table, "time,lat,lon\n1.5,45.25,9.125\n2.5,45.5,9.25\n"},
        {pos_receiver(),
         "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" creator=\"x\"><trk><trkseg><trkpt "
         "lat=\"45.25\" lon=\"9.125\"><ele>10</ele><time>2026-03-14T01:00:00Z</time></trkpt>"
         "</trkseg></trk></gpx>\n"}};
    for (const auto& [receiver, text] : texts) {
        const Observations plain = import_text(receiver, text);
        const std::u16string wide(text.begin(), text.end());
        for (const bool big_endian : {false, true})
            for (const bool mark : {false, true}) {
                const Observations read = import_text(receiver, in_utf16(wide, big_endian, mark));
                EXPECT_EQ(read.format, plain.format);
                ASSERT_EQ(read.rows.size(), plain.rows.size());
                for (std::size_t i = 0; i < plain.rows.size(); ++i) {
                    EXPECT_EQ(read.rows[i].latitude_deg, plain.rows[i].latitude_deg);
                    EXPECT_EQ(read.rows[i].time, plain.rows[i].time);
                    EXPECT_EQ(read.rows[i].source_line, plain.rows[i].source_line);
                    EXPECT_FALSE(read.rows[i].source_byte);
                }
                EXPECT_NE(read.notes.back().find("UTF-16"), std::string::npos);
            }
    }
}

TEST(ImportUtf16, EveryCharacterHasItsUtf8) {
    // Of one, two, three and four bytes: Unicode 15, table 3-6.
    const std::u16string wide = u"A\u00b0\u20ac\U0001f600";
    for (const bool big_endian : {false, true})
        EXPECT_EQ(utf8_of_utf16({.name = "f", .bytes = in_utf16(wide, big_endian, true)}),
                  "A\xc2\xb0\xe2\x82\xac\xf0\x9f\x98\x80");
}

TEST(ImportUtf16, WhatIsBrokenIsSaidWithItsByte) {
    const struct {
        std::string bytes, what;
    } cases[] = {
        {"\xff\xfe%\0 "s, "f:byte 4: the UTF-16 text ends within a character"},
        {"\xff\xfe%\0\x3d\xd8 \0"s, "f:byte 4: the UTF-16 text holds half a surrogate pair"},
        {"\xff\xfe%\0\0\xde"s, "f:byte 4: the UTF-16 text holds half a surrogate pair"},
        {"\xff\xfe%\0\x3d\xd8"s, "f:byte 4: the UTF-16 text holds half a surrogate pair"},
        {"\xff\xfe\xff\xfe%\0"s, "f:1:1: "},
    };
    for (const auto& bad : cases)
        EXPECT_EQ(failure_of(pos_receiver(), bad.bytes).rfind(bad.what, 0), 0U)
            << failure_of(pos_receiver(), bad.bytes);
}

/// Reads, or throws a Failure that says where: anything else ends the test.
void read_or_refuse(const Receiver& receiver, const std::string& text) {
    try {
        const Observations read = import_text(receiver, text);
        ASSERT_FALSE(read.rows.empty());
        // What is read can be written, and read again.
        const std::string table = write_observations(read);
        ASSERT_EQ(read_observations(table, "table").rows.size(), read.rows.size());
    } catch (const Failure& failure) {
        ASSERT_EQ(failure.where().rfind("f:", 0), 0u) << failure.what();
    }
}

std::string mutated(std::string text, RandomGenerator& random) {
    static const std::string likely = "0123456789.-+,;%#\"\t\n\r eEnaif\xff\0:/"s;
    const std::uint64_t changes = 1 + random.next() % 4;
    for (std::uint64_t i = 0; i < changes && !text.empty(); ++i) {
        const auto at = static_cast<std::size_t>(random.next() % text.size());
        const char byte = likely[static_cast<std::size_t>(random.next() % likely.size())];
        switch (random.next() % 4) {
            case 0:
                text[at] = byte;
                break;
            case 1:
                text.insert(at, 1, byte);
                break;
            case 2:
                text.erase(at, 1 + random.next() % 8);
                break;
            default:
                text.insert(at, text.substr(static_cast<std::size_t>(random.next() % text.size()),
                                            random.next() % 40));
        }
    }
    return text;
}

struct Sample {
    Receiver receiver;
    std::string text;
};

std::vector<Sample> samples() {
    std::vector<Sample> all;
    for (const char* file : {"degrees_velocity_floats.pos", "dms_semicolon.pos",
                             "ecef_velocity_week.pos", "baseline_base_dms.pos"}) {
        Receiver receiver = pos_receiver();
        receiver.format = "rtklib-pos";
        all.push_back({receiver, fixture(file)});
    }
    Receiver receiver = csv_receiver();
    receiver.columns["sigma_east"] = "se";
    receiver.columns["sigma_north"] = "sn";
    receiver.columns["fix"] = "fix";
    receiver.time_format = "iso";
    all.push_back({receiver,
                   "# c\ntime,lat,lon,h,se,sn,fix\n2023-07-11T06:04:30.0,35.5,-137.25,40,0.01,0.02,"
                   "fixed\n2023-07-11T06:04:30.1,35.5,-137.25,40,\"0.01\",,1\n"});
    receiver.frame = StatedFrame{CoordinateFrame::utm};
    receiver.frame->utm_zone = UtmZone{.zone = 33, .northern = true};
    receiver.time_format = "seconds";
    receiver.columns = {{"time", "1"},       {"east", "2"},        {"north", "3"}, {"up", "4"},
                        {"sigma_east", "5"}, {"sigma_north", "6"}, {"fix", "7"}};
    all.push_back(
        {receiver, "0.0;500000.5;5500000;40;0.01;0.02;1\n0.1;500001.5;5500000;40;0.01;0;float\n"});
    return all;
}

TEST(ImportFuzz, EveryTruncationReadsOrFails) {
    for (const Sample& sample : samples())
        for (std::size_t size = 0; size <= sample.text.size(); ++size)
            read_or_refuse(sample.receiver, sample.text.substr(0, size));
}

TEST(ImportFuzz, MutationsReadOrFail) {
    RandomGenerator random(20230711);
    for (const Sample& sample : samples())
        for (int i = 0; i < 1500; ++i) {
            const std::string text = mutated(sample.text, random);
            read_or_refuse(sample.receiver, text);
            if (HasFatalFailure()) FAIL() << text;
        }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
