#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "make/progress_text.h"

namespace runcert::RUNCERT_FILE {
namespace {

const std::string chinese = "\xe8\xb5\x9b\xe8\xbd\xa6";  // two wide characters
const std::string accented = "e\xcc\x81";                // one column, of two characters

AttemptReport that_ran(const std::string& state, bool ran = true) {
    return {
        .id = "one", .state = state, .steps = {{.step = "smooth", .ran = ran, .seconds = 29.0}}};
}

TEST(MovingLine, SaysHowFarHowFastAndHowLongYet) {
    MovingLine line({.total = 40});
    EXPECT_EQ(line.text(0.0), "0 of 40");
    line.take({0, AttemptBegins{"heat-1"}}, 1.0);
    EXPECT_EQ(line.text(1.5), "0 of 40; heat-1: begins 0 s");
    line.take({1, AttemptBegins{"heat-" + chinese}}, 1.0);
    line.take({0, StepBegins{"smooth"}}, 2.0);
    EXPECT_EQ(line.text(5.9), "0 of 40; heat-1: smooth 3 s, 1 more");
    line.take({0, StepReport{.step = "smooth", .ran = true, .seconds = 29.0}}, 31.0);
    line.take({0, that_ran("failed")}, 31.0);
    line.take({1, StepBegins{"smooth"}}, 31.0);
    EXPECT_EQ(line.text(41.0), "1 of 40, 1 failed, 19 min 20 s left, 2.0 a minute; heat-" +
                                   chinese + ": smooth 10 s of about 29 s");
    for (std::size_t index = 2; index < 39; ++index)
        line.take({index, AttemptSkipped{}}, 42.0);
    line.take({1, that_ran("done")}, 61.0);
    EXPECT_EQ(line.text(61.0), "39 of 40, 1 failed, 30 s left, 2.0 a minute");
    // What takes longer than expected is not said to be over.
    EXPECT_EQ(line.text(100.0), "39 of 40, 1 failed, 2.0 a minute");
}

TEST(MovingLine, ThePaceIsThatOfTheAttemptsThatReallyRan) {
    MovingLine line({.total = 110});
    // A hundred that were kept take a second together.
    for (std::size_t index = 0; index < 100; ++index) {
        line.take({index, AttemptBegins{"kept"}}, 0.01 * static_cast<double>(index));
        line.take({index, that_ran("done", false)}, 0.01 * static_cast<double>(index + 1));
    }
    EXPECT_EQ(line.text(1.0), "100 of 110");
    // Two side by side, 30 s each.
    for (const std::size_t index : {100U, 101U})
        line.take({index, AttemptBegins{"ran"}}, 1.0);
    for (const std::size_t index : {100U, 101U})
        line.take({index, that_ran("done")}, 30.0);
    EXPECT_EQ(line.text(60.0), "102 of 110, 90 s left, 4.0 a minute");
}

TEST(MovingLine, OfOneAttemptSaysTheStepAndHowLongItTookBefore) {
    MovingLine line({.took = {{"smooth", 8.2}, {"enu", 0.1}}});
    EXPECT_EQ(line.text(0.0), "");
    line.take({.what = StepBegins{"enu"}}, 1.0);
    line.take({.what = Note{"import 281 epochs"}}, 1.0);
    EXPECT_EQ(line.text(1.0), "enu 0 s");
    line.take({.what = StepBegins{"smooth"}}, 1.0);
    EXPECT_EQ(line.text(4.5), "smooth 3 s of about 8 s");
    line.take({.what = StepBegins{"x\x1b[2J"}}, 5.0);
    EXPECT_EQ(line.text(5.0), "x\xef\xbf\xbd[2J 0 s");
}

TEST(SecondsOfSteps, AreThoseOfTheRunBeforeIfItCanBeRead) {
    const auto file = std::filesystem::path(testing::TempDir()) / "times-of-steps.yaml";
    std::ofstream(file) << "stages:\n- {stage: smooth, seconds: 8.2}\n"
                           "- {stage: report, seconds: 3}\n";
    EXPECT_EQ(seconds_of_steps(file),
              (std::map<std::string, double>{{"smooth", 8.2}, {"report", 3.0}}));
    std::ofstream(file) << "stages:\n- {stage: smooth, seconds: 8.2}\n- {stage: enu}\n";
    EXPECT_TRUE(seconds_of_steps(file).empty());
    std::filesystem::remove(file);
    EXPECT_TRUE(seconds_of_steps(file).empty());
}

TEST(TerminalText, KnowsTheColumnsOfCharacters) {
    // Unicode's EastAsianWidth.txt: W and F are two columns wide; Mn takes none.
    const struct {
        std::string text;
        std::size_t columns;
    } cases[] = {
        {"", 0},
        {"abc", 3},
        {"\xc3\xa9", 1},
        {accented, 1},
        {chinese, 4},
        {"\xed\x95\x9c", 2},
        {"\xef\xbc\xa1", 2},
        {"\xf0\x9f\x98\x80", 2},
        {"\xef\xbf\xbd", 1},
        {"\xe2\x82\xac", 1},
    };
    for (const auto& c : cases)
        EXPECT_EQ(columns_of(c.text), c.columns) << c.text;
}

TEST(TerminalText, CutsBetweenWholeCharacters) {
    EXPECT_EQ(fitted("abcdefgh", 8), "abcdefgh");
    EXPECT_EQ(fitted("abcdefgh", 7), "abcd...");
    EXPECT_EQ(fitted("abcdefgh", 2), "..");
    EXPECT_EQ(fitted("abcdefgh", 0), "");
    // Half of a wide character is none.
    EXPECT_EQ(fitted("a" + chinese + "bc", 6), "a\xe8\xb5\x9b...");
    EXPECT_EQ(fitted("a" + chinese + "bc", 5), "a...");
    EXPECT_EQ(fitted(accented + accented + accented + accented + "x", 4), accented + "...");
    const std::string mixed = "a" + chinese + accented + "\xf0\x9f\x98\x80" + chinese + "b";
    for (std::size_t columns = 0; columns < 16; ++columns)
        EXPECT_LE(columns_of(fitted(mixed, columns)), columns);
}

TEST(DurationText, IsReadAtAGlance) {
    EXPECT_EQ(duration_text(0.04), "0.0 s");
    EXPECT_EQ(duration_text(8.31), "8.3 s");
    EXPECT_EQ(duration_text(99.96), "1 min 40 s");
    EXPECT_EQ(duration_text(754.0), "12 min 34 s");
    EXPECT_EQ(duration_text(3599.6), "1 h 0 min");
    EXPECT_EQ(duration_text(7500.0), "2 h 5 min");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
