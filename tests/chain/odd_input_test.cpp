#include <algorithm>
#include <sstream>

#include "hostile_support.h"

// Recordings that look odd and are read all the same.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// The observations of a recording, and of an attempt with it.
std::string imported(const std::string& recording, const std::string& attempt = good_attempt) {
    const TemporaryFolder folder;
    write_plainly(folder.path() / "attempt.yaml", attempt);
    write_plainly(folder.path() / "recording.pos", recording);
    const Measured run =
        run_measured({"runcert-import", "--attempt", folder.path() / "attempt.yaml", "--run-dir",
                      folder.path() / "run"});
    EXPECT_EQ(run.exit_status, 0) << run.errors;
    EXPECT_LE(run.seconds, longest_s);
    return run.exit_status == 0 ? read_file(folder.path() / "run" / "1-observations.ecsv") : "";
}

std::string rows_of(const std::string& table) {
    return table.substr(std::min(table.find("\nepoch,"), table.size()));
}

/// Without the bytes at which its lines begin.
std::string without_last_cells(const std::string& table) {
    std::string rows;
    std::istringstream lines(rows_of(table));
    for (std::string line; std::getline(lines, line);) {
        for (int i = 0; i < 2; ++i)
            line.resize(std::min(line.rfind(','), line.size()));
        rows += line + "\n";
    }
    return rows;
}

std::string with_year(const std::string& year) {
    std::string text = replaced(good_recording(), "GPST", "UTC ");
    for (std::size_t at = 0; (at = text.find("2022/", at)) != std::string::npos; at += 5)
        text.replace(at, 4, year);
    return text;
}

TEST(OddInput, LineEndsAndMarksChangeNothing) {
    const std::string plain = without_last_cells(imported(good_recording()));
    EXPECT_GT(std::count(plain.begin(), plain.end(), '\n'), 20);
    EXPECT_EQ(without_last_cells(imported(good_recording("\r\n"))), plain);
    EXPECT_EQ(without_last_cells(imported(good_recording() + "\n\r\n\n")), plain);
    const std::string marked = imported("\xef\xbb\xbf" + good_recording());
    EXPECT_EQ(without_last_cells(marked), plain);
    EXPECT_NE(marked.find("byte order mark"), std::string::npos);
    const std::string whole = good_recording();
    const std::string open_ended = imported(whole.substr(0, whole.size() - 1));
    EXPECT_EQ(without_last_cells(open_ended), plain);
    EXPECT_NE(open_ended.find("no line end"), std::string::npos);
}

TEST(OddInput, DatesWithoutKnownLeapSecondsAreNoted) {
    EXPECT_EQ(imported(with_year("2022")).find("leap seconds are not known"), std::string::npos);
    for (const char* year : {"1979", "2080"})
        EXPECT_NE(imported(with_year(year)).find("leap seconds are not known"), std::string::npos)
            << year;
    EXPECT_EQ(imported(with_year("1980")).find("leap seconds are not known"), std::string::npos);
}

TEST(OddInput, MinusZeroIsZero) {
    EXPECT_EQ(without_last_cells(imported(replaced(good_recording(), "10.000 1", "-0.000 1"))),
              without_last_cells(imported(replaced(good_recording(), "10.000 1", "0.000 1"))));
}

TEST(OddInput, ManyFilesThatFollowOneAnother) {
    const TemporaryFolder folder;
    std::string list;
    for (int i = 0; i < 60; ++i) {
        std::string text = good_recording();
        for (std::size_t at = 0; (at = text.find("08:51:", at)) != std::string::npos; at += 6)
            text.replace(at, 6, fmt::format("09:{:02}:", i));
        write_plainly(folder.path() / fmt::format("r{}.pos", i), text);
        list += fmt::format("{}r{}.pos", i == 0 ? "[" : ", ", i);
    }
    write_plainly(folder.path() / "attempt.yaml",
                  replaced(good_attempt, "recording.pos", list + "]"));
    const Measured run =
        run_measured({"runcert-import", "--attempt", folder.path() / "attempt.yaml", "--run-dir",
                      folder.path() / "run"});
    EXPECT_EQ(run.exit_status, 0) << run.errors;
    EXPECT_NE(run.output.find("1200 epochs"), std::string::npos) << run.output;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
