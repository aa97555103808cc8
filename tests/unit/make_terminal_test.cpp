#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <regex>
#include <string>
#include <thread>
#include <vector>

#include "make/progress.h"
#include "make_progress_support.h"
#include "make_screen.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace std::chrono_literals;
using test::day_of;
using test::Output;
using test::report_of;
using test::Screen;
using test::tell;
using test::Terminal;

const std::string chinese = "\xe8\xb5\x9b\xe8\xbd\xa6";  // two wide characters
const std::string accented = "e\xcc\x81";                // one column, of two characters

/// Of what runs; on a busy machine that may be any.
std::vector<std::string> without_seconds(std::vector<std::string> rows) {
    for (std::string& row : rows)
        if (row.starts_with("  ")) row = std::regex_replace(row, std::regex(" [0-9]+ s$"), " N s");
    return rows;
}

class TerminalProgressTest : public testing::Test {
  protected:
    void SetUp() override {
        setenv("TERM", "xterm", 1);
        setenv("NO_COLOR", "1", 1);
    }
    void TearDown() override { unsetenv("NO_COLOR"); }

    static std::unique_ptr<Progress> progress_on(const Terminal& terminal, std::size_t total) {
        return make_progress(
            {.style = ProgressStyle::terminal, .total = total, .to = terminal.file()});
    }
    static std::vector<std::string> plain_lines(int columns, std::size_t total,
                                                const std::function<void(Progress&)>& work) {
        const Output output;
        work(*make_progress({.columns = columns, .total = total, .to = output.file()}));
        Screen screen(1000);
        screen.take(output.text());
        return screen.rows();
    }
};

TEST_F(TerminalProgressTest, WhatRemainsIsThePlainText) {
    for (const int columns : {40, 80, 200}) {
        const std::vector<std::string> plain = plain_lines(columns - 1, 30, [](Progress& progress) {
            for (std::size_t index = 0; index < 30; ++index)
                tell(progress, index);
            progress.ends({.attempts = 30, .closing = {"closing"}});
        });
        Terminal terminal(columns, 24);
        auto progress = progress_on(terminal, 30);
        std::vector<std::size_t> order(30);
        for (std::size_t i = 0; i < order.size(); ++i)
            order[i] = i;
        std::mt19937 random(static_cast<unsigned>(columns));
        std::shuffle(order.begin(), order.end(), random);
        std::vector<std::thread> threads;
        for (std::size_t t = 0; t < 3; ++t)
            threads.emplace_back([&, t] {
                for (std::size_t i = t; i < order.size(); i += 3) {
                    tell(*progress, order[i]);
                    std::this_thread::sleep_for(std::chrono::milliseconds(17 * (t + 1)));
                }
            });
        for (std::thread& thread : threads)
            thread.join();
        progress->ends({.attempts = 30, .closing = {"closing"}});
        progress.reset();
        const Screen screen = terminal.end();
        // The error of a failed attempt may be broken into rows; put together it is the same.
        std::string rows;
        for (const std::string& row : screen.rows())
            rows += row;
        std::string lines;
        for (const std::string& line : plain)
            lines += line;
        std::erase(rows, ' ');
        std::erase(lines, ' ');
        EXPECT_EQ(rows, lines) << columns;
        if (columns == 80) {
            EXPECT_EQ(screen.rows(), plain);
        }
        EXPECT_TRUE(screen.cursor_is_at_the_left());
    }
}

TEST_F(TerminalProgressTest, ShowsWhatRunsBelowWhatEnded) {
    Terminal terminal(80, 24);
    auto progress = progress_on(terminal, 9);
    progress->attempt_begins(0, "first");
    progress->attempt_begins(1, "second-" + chinese);
    progress->attempt_begins(2, "third-" + accented);
    progress->step_begins(1, "smooth");
    progress->step_begins(2, "window");
    progress->note("a note");  // before what the frame below is known by
    progress->attempt_ends(0, {.id = "first", .state = "failed", .error = "line 7: wrong"});
    EXPECT_EQ(without_seconds(terminal.rows_when_last_has("1/9, 1 failed")),
              (std::vector<std::string>{"a note", "[1/9] first  failed  0.0 s", "    line 7: wrong",
                                        "  second-" + chinese + "  smooth  N s",
                                        "  third-" + accented + "      window  N s",
                                        "[###...........................] 1/9, 1 failed"}));
    progress->attempt_ends(2, {.id = "third", .state = "done"});
    progress->attempt_ends(1, {.id = "second", .state = "interrupted"});
    EXPECT_EQ(
        terminal.rows_when_last_has("3/9, 1 failed"),
        (std::vector<std::string>{"a note", "[1/9] first  failed  0.0 s", "    line 7: wrong",
                                  "[2/9] second  interrupted  0.0 s", "[3/9] third  done  0.0 s",
                                  "[##########....................] 3/9, 1 failed"}));
    progress.reset();
    EXPECT_EQ(terminal.end().rows().size(), 5U);
}

TEST_F(TerminalProgressTest, FollowsTheWidthOfTheTerminal) {
    Terminal terminal(100, 24);
    auto progress = progress_on(terminal, 4);
    const std::string id(60, 'x');
    progress->attempt_begins(1, id);
    progress->attempt_begins(2, id);
    tell(*progress, 0);
    // Not the line of the attempt that ended, "[1/4] ...", which is the last for a moment.
    EXPECT_EQ(terminal.rows_when_last_has("] 1/4").size(), 4U);
    for (const int columns : {30, 60, 20, 100}) {
        terminal.resize(columns, 24);
        // The first attempt's line is the terminal's to break, and what was drawn before stands
        // until it is drawn again.
        const auto fits = [](const std::vector<std::string>& rows) {
            const auto running = std::ranges::count_if(
                rows, [](const std::string& row) { return row.starts_with("  xxx"); });
            return running == 2 && rows[rows.size() - 2].starts_with("  xxx");
        };
        std::vector<std::string> rows;
        for (int tries = 0; tries < 24'000 && !fits(rows); ++tries) {
            std::this_thread::sleep_for(10ms);
            rows = terminal.rows_when_last_has("1/4");
        }
        EXPECT_TRUE(fits(rows)) << columns;
    }
    progress->ends({.attempts = 4});
    progress.reset();
    const std::vector<std::string> rows = terminal.end().rows();
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_TRUE(rows[0].starts_with("[1/4] attempt-0"));
    EXPECT_TRUE(rows[1].starts_with("4 attempts: "));
}

TEST_F(TerminalProgressTest, IsNeverHigherThanTheTerminal) {
    Terminal terminal(80, 6);
    const auto progress = progress_on(terminal, 20);
    for (std::size_t index = 0; index < 12; ++index)
        progress->attempt_begins(index, test::id_of(index));
    progress->attempt_skipped(12);
    const std::vector<std::string> rows = terminal.rows_when_last_has("1/20");
    EXPECT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[3], "  and 9 more");
}

TEST_F(TerminalProgressTest, DrawsAtMostTenTimesASecond) {
    Terminal terminal(80, 24);
    auto progress = progress_on(terminal, 1'000'000);
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t index = 0; std::chrono::steady_clock::now() - begin < 1s; ++index)
        progress->attempt_skipped(index);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress.reset();
    terminal.end();
    const std::string bytes = terminal.bytes();
    std::size_t drawn = 0;
    for (std::size_t at = bytes.find("\x1b[J"); at != std::string::npos;
         at = bytes.find("\x1b[J", at + 1))
        ++drawn;
    EXPECT_GE(drawn, 1U);
    EXPECT_LE(static_cast<double>(drawn), seconds * 10.0 + 2.0);
}

TEST_F(TerminalProgressTest, ColoursUnlessToldNot) {
    for (const bool colour : {true, false}) {
        setenv("NO_COLOR", colour ? "" : "1", 1);
        Terminal terminal(80, 24);
        auto progress = progress_on(terminal, 5);
        progress->attempt_ends(0, report_of(4));
        progress.reset();
        EXPECT_EQ(terminal.end().rows()[0], "[1/5] attempt-4  failed  1 of 2 steps ran  2.0 s");
        EXPECT_EQ(terminal.bytes().find("\x1b[31mfailed\x1b[0m") != std::string::npos, colour);
        EXPECT_EQ(terminal.bytes().find("\x1b[3") != std::string::npos, colour);
    }
}

TEST_F(TerminalProgressTest, ADumbTerminalIsGivenPlainText) {
    for (const char* type : {"dumb", ""}) {
        setenv("TERM", type, 1);
        Terminal terminal(80, 24);
        auto progress = progress_on(terminal, 1);
        tell(*progress, 0);
        progress->ends(day_of(3));
        progress.reset();
        EXPECT_EQ(terminal.end().rows().size(), 4U);
        EXPECT_EQ(terminal.bytes().find('\x1b'), std::string::npos);
    }
}

TEST(ProgressStyleFor, IsThatOfTheFile) {
    const Terminal terminal(80, 24);
    EXPECT_EQ(progress_style_for(terminal.file()), ProgressStyle::terminal);
    EXPECT_EQ(progress_style_for(Output().file()), ProgressStyle::plain);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
