#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "make/progress_parts.h"
#include "make/progress_text.h"

namespace runcert::RUNCERT_FILE {
namespace {

const std::string chinese = "\xe8\xb5\x9b\xe8\xbd\xa6";  // two wide characters
const std::string accented = "e\xcc\x81";                // one column, of two characters

TEST(Frame, FitsEveryWidth) {
    FrameContents contents{.total = 2000,
                           .ended = 1234,
                           .failed = 12,
                           .runs_per_minute = 31.4,
                           .seconds_left = 1480.0};
    for (const std::string& id : {std::string("short"), std::string(200, 'x'), chinese,
                                  chinese + chinese + chinese + chinese + chinese, accented})
        contents.running.push_back({.id = id, .step = "smooth", .seconds = 12.9});
    for (std::size_t columns = 1; columns < 120; ++columns)
        for (const std::string& line : frame_lines(contents, {.columns = columns, .rows = 24}))
            EXPECT_LT(columns_of(line), std::max<std::size_t>(columns, 2)) << line;
    EXPECT_EQ(frame_lines(contents, {.columns = 80, .rows = 24}).back(),
              "[##################............] 1234/2000, 12 failed, 31 runs/min, 25 min left");
    EXPECT_EQ(frame_lines(contents, {.columns = 40, .rows = 24}).back(),
              "1234/2000, 12 failed, 25 min left");
    EXPECT_EQ(frame_lines(contents, {.columns = 80, .rows = 24})[0].substr(0, 8), "  short ");
}

TEST(Pace, IsThatOfTheAttemptsThatReallyRan) {
    Pace pace;
    EXPECT_FALSE(pace.seconds_left(10, 0.0));
    // A hundred that were kept take a second together.
    for (std::size_t i = 0; i < 100; ++i) {
        pace.begins(i, 0.01 * static_cast<double>(i));
        pace.ends(i, false, 0.01 * static_cast<double>(i + 1));
    }
    EXPECT_FALSE(pace.runs_per_minute(1.0));
    EXPECT_FALSE(pace.seconds_left(10, 1.0));
    // Two side by side, 30 s each.
    pace.begins(100, 0.0);
    pace.begins(101, 0.0);
    pace.ends(100, true, 30.0);
    pace.ends(101, true, 30.0);
    EXPECT_DOUBLE_EQ(*pace.runs_per_minute(60.0), 2.0);
    EXPECT_DOUBLE_EQ(*pace.seconds_left(10, 60.0), 150.0);
    // One of two has 10 s to go and the other takes longer than expected.
    pace.begins(102, 60.0);
    pace.begins(103, 10.0);
    EXPECT_DOUBLE_EQ(*pace.seconds_left(10, 80.0), 155.0);
    // With nothing waiting, what is left is the longest, not the half of it.
    EXPECT_DOUBLE_EQ(*pace.seconds_left(0, 80.0), 10.0);
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
