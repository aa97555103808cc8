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

/// Of what runs; on a busy machine that may be any. The pace hangs on it.
std::vector<std::string> without_seconds(std::vector<std::string> rows) {
    rows.back() = std::regex_replace(rows.back(), std::regex(" [0-9]+ s"), " N s");
    return rows;
}

class TerminalProgressTest : public testing::Test {
  protected:
    void SetUp() override {
        setenv("TERM", "xterm", 1);
        setenv("NO_COLOR", "1", 1);
    }
    void TearDown() override { unsetenv("NO_COLOR"); }

    static Progress progress_on(const Terminal& terminal, std::size_t total) {
        return make_progress(
            {.style = ProgressStyle::terminal, .total = total, .to = terminal.file()});
    }
    static std::vector<std::string> plain_lines(int columns, std::size_t total,
                                                const std::function<void(const Progress&)>& work) {
        const Output output;
        work(make_progress(
            {.columns = static_cast<std::size_t>(columns), .total = total, .to = output.file()}));
        Screen screen(1000);
        screen.take(output.text());
        return screen.rows();
    }
};

TEST_F(TerminalProgressTest, WhatRemainsIsThePlainText) {
    for (const int columns : {40, 80, 200}) {
        const std::vector<std::string> plain =
            plain_lines(columns - 1, 30, [](const Progress& progress) {
                for (std::size_t index = 0; index < 30; ++index)
                    tell(progress, index);
                progress({.what = DaySummary{.attempts = 30, .closing = {"closing"}}});
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
                    tell(progress, order[i]);
                    std::this_thread::sleep_for(std::chrono::milliseconds(17 * (t + 1)));
                }
            });
        for (std::thread& thread : threads)
            thread.join();
        progress({.what = DaySummary{.attempts = 30, .closing = {"closing"}}});
        progress = nullptr;
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
    progress({0, AttemptBegins{"first"}});
    progress({1, AttemptBegins{"second-" + chinese}});
    progress({2, AttemptBegins{"third-" + accented}});
    progress({1, StepBegins{"smooth"}});
    progress({2, StepBegins{"window"}});
    progress({.what = Note{"a note\n\nof three lines"}});  // before what the line is known by
    progress({0, AttemptReport{.id = "first", .state = "failed", .error = "line 7: wrong"}});
    EXPECT_EQ(without_seconds(terminal.rows_when_last_has("1 of 9, 1 failed")),
              (std::vector<std::string>{
                  "a note", "", "of three lines", "[1/9] first  failed  0.0 s", "    line 7: wrong",
                  "1 of 9, 1 failed; second-" + chinese + ": smooth N s, 1 more"}));
    progress({2, AttemptReport{.id = "third", .state = "done"}});
    progress({1, AttemptReport{.id = "second", .state = "interrupted"}});
    EXPECT_EQ(
        terminal.rows_when_last_has("3 of 9, 1 failed"),
        (std::vector<std::string>{"a note", "", "of three lines", "[1/9] first  failed  0.0 s",
                                  "    line 7: wrong", "[2/9] second  interrupted  0.0 s",
                                  "[3/9] third  done  0.0 s", "3 of 9, 1 failed"}));
    progress = nullptr;
    EXPECT_EQ(terminal.end().rows().size(), 7U);
}

TEST_F(TerminalProgressTest, NothingIsLeftOfAStepOfOneAttempt) {
    Terminal terminal(80, 24);
    auto progress = progress_on(terminal, 0);
    progress({.what = StepBegins{"import"}});
    EXPECT_EQ(without_seconds(terminal.rows_when_last_has("import")).back(), "import N s");
    progress({.what = Note{"import  281 epochs"}});
    progress({.what = StepBegins{"smooth"}});
    EXPECT_EQ(without_seconds(terminal.rows_when_last_has("smooth")),
              (std::vector<std::string>{"import  281 epochs", "smooth N s"}));
    progress = nullptr;
    const Screen screen = terminal.end();
    EXPECT_EQ(screen.rows(), std::vector<std::string>{"import  281 epochs"});
    EXPECT_TRUE(screen.cursor_is_at_the_left());
}

TEST_F(TerminalProgressTest, FollowsTheWidthOfTheTerminal) {
    Terminal terminal(100, 24);
    auto progress = progress_on(terminal, 4);
    const std::string id(60, 'x');
    progress({1, AttemptBegins{id}});
    progress({2, AttemptBegins{id}});
    tell(progress, 0);
    EXPECT_EQ(terminal.rows_when_last_has("1 of 4").size(), 2U);
    for (const int columns : {30, 60, 20, 100}) {
        terminal.resize(columns, 24);
        // The first attempt's line is the terminal's to break, and what was drawn before stands
        // until it is drawn again.
        const auto fits = [&](const std::string& row) {
            return row.size() == static_cast<std::size_t>(std::min(columns - 1, 79)) &&
                   row.starts_with("1 of 4") && row.ends_with("...");
        };
        std::vector<std::string> rows;
        for (int tries = 0; tries < 24'000 && (rows.empty() || !fits(rows.back())); ++tries) {
            std::this_thread::sleep_for(10ms);
            rows = terminal.rows_when_last_has("...");
        }
        EXPECT_TRUE(fits(rows.back())) << columns;
        EXPECT_EQ(std::ranges::count_if(
                      rows, [](const std::string& row) { return row.starts_with("1 of 4"); }),
                  1)
            << columns;
    }
    progress({.what = DaySummary{.attempts = 4}});
    progress = nullptr;
    const std::vector<std::string> rows = terminal.end().rows();
    ASSERT_EQ(rows.size(), 2U);
    EXPECT_TRUE(rows[0].starts_with("[1/4] attempt-0") && rows[0].ends_with("fisly: not proven"));
    EXPECT_TRUE(rows[1].starts_with("4 attempts: "));
}

TEST_F(TerminalProgressTest, DrawsAtMostTenTimesASecond) {
    Terminal terminal(80, 24);
    auto progress = progress_on(terminal, 1'000'000);
    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t index = 0; std::chrono::steady_clock::now() - begin < 1s; ++index)
        progress({index, AttemptSkipped{}});
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress = nullptr;
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
        progress({0, report_of(4)});
        progress = nullptr;
        EXPECT_EQ(terminal.end().rows()[0], "[1/5] attempt-4  failed  1 of 2 steps ran  2.0 s");
        EXPECT_EQ(terminal.bytes().find("\x1b[31mfailed\x1b[0m") != std::string::npos, colour);
        EXPECT_EQ(terminal.bytes().find("\x1b[3") != std::string::npos, colour);
    }
}

TEST_F(TerminalProgressTest, ADumbTerminalAndAFileAreGivenPlainText) {
    const Terminal terminal(80, 24);
    EXPECT_EQ(progress_style_for(terminal.file()), ProgressStyle::terminal);
    EXPECT_EQ(progress_style_for(Output().file()), ProgressStyle::plain);
    for (const char* type : {"dumb", ""}) {
        setenv("TERM", type, 1);
        EXPECT_EQ(progress_style_for(terminal.file()), ProgressStyle::plain);
    }
    unsetenv("TERM");
    EXPECT_EQ(progress_style_for(terminal.file()), ProgressStyle::plain);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
