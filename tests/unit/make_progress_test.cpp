#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "make/progress.h"
#include "make/progress_text.h"
#include "make_progress_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::day_of;
using test::Output;
using test::report_of;
using test::tell;

std::string shown(ProgressOptions options, const std::function<void(const Progress&)>& work) {
    const Output output;
    options.to = output.file();
    Progress progress = make_progress(options);
    work(progress);
    progress = nullptr;
    return output.text();
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

/// Attempts in a random order and side by side in threads.
void tell_all(const Progress& progress, std::size_t total, unsigned seed) {
    std::vector<std::size_t> order(total);
    for (std::size_t i = 0; i < total; ++i)
        order[i] = i;
    std::mt19937 random(seed);
    std::shuffle(order.begin(), order.end(), random);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 4; ++t)
        threads.emplace_back([&, t] {
            for (std::size_t i = t; i < total; i += 4)
                tell(progress, order[i]);
        });
    for (std::thread& thread : threads)
        thread.join();
    progress({.what = day_of(total)});
}

TEST(PlainProgress, OneLineForEachAttempt) {
    const std::string text = shown({.columns = 200, .total = 6}, [](const Progress& progress) {
        for (const std::size_t index : {4U, 1U, 0U})
            tell(progress, index);
        progress({.what = day_of(6)});
    });
    EXPECT_EQ(text,
              "[1/6] attempt-0  done  0 of 2 steps ran  2.0 s  nalsa: beaten by 1.25 km/h; fisly: "
              "not proven\n"
              "[2/6] attempt-1  done  1 of 2 steps ran  2.0 s  nalsa: beaten by 1.25 km/h; fisly: "
              "not proven\n"
              "[5/6] attempt-4  failed  1 of 2 steps ran  2.0 s\n"
              "    rover.pos, line 7: it holds no number\n"
              "    Correct the line\n"
              "6 attempts: 4 done, 1 failed, 1 not processed; 7 steps run, 9 kept; 2 min 5 s\n"
              "Results: out/day.html\n"
              "Go on with: runcert batch day\n");
}

TEST(PlainProgress, ExplainsEachStep) {
    const std::string text =
        shown({.explain = true, .columns = 40, .total = 2}, [](const Progress& progress) {
            tell(progress, 0);
            tell(progress, 1);
        });
    EXPECT_EQ(text,
              "[1/2] attempt-0  done  0 of 2 steps r...\n"
              "    import kept: nothing changed\n"
              "    smooth kept: nothing changed\n"
              "[2/2] attempt-1  done  1 of 2 steps r...\n"
              "    import kept: nothing changed\n"
              "    smooth ran: parameters.smooth.robust_scale 2 -> 2.5 (1.5 s)\n");
}

TEST(PlainProgress, HoldsBackUntilThoseBeforeHaveEnded) {
    const Output output;
    const auto progress = make_progress({.total = 3, .to = output.file()});
    tell(progress, 2);
    tell(progress, 1);
    EXPECT_EQ(output.text(), "");
    progress({.what = Note{"waiting for process 4711"}});
    EXPECT_EQ(output.text(), "waiting for process 4711\n");
    progress({0, AttemptSkipped{}});
    EXPECT_EQ(lines_of(output.text()).size(), 3U);
}

TEST(QuietProgress, SaysFailuresAndTheClosingLines) {
    const auto work = [](const Progress& progress) {
        for (std::size_t index = 0; index < 6; ++index)
            tell(progress, index);
        progress({.what = Note{"a note"}});
        progress({.what = day_of(6)});
    };
    EXPECT_EQ(shown({.style = ProgressStyle::quiet, .total = 6}, work),
              "[5/6] attempt-4  failed  1 of 2 steps ran  2.0 s\n"
              "    rover.pos, line 7: it holds no number\n"
              "    Correct the line\n"
              "Go on with: runcert batch day\n");
}

TEST(Progress, TheTextIsTheSameWhateverTheOrderOfFinishing) {
    for (const ProgressStyle style :
         {ProgressStyle::plain, ProgressStyle::quiet, ProgressStyle::json}) {
        const ProgressOptions options{.style = style, .explain = true, .total = 40};
        const std::string in_order = shown(options, [](const Progress& progress) {
            for (std::size_t index = 0; index < 40; ++index)
                tell(progress, index);
            progress({.what = day_of(40)});
        });
        EXPECT_GT(lines_of(in_order).size(), 8U);
        for (unsigned seed = 0; seed < 50; ++seed)
            ASSERT_EQ(shown(options, [&](const Progress& p) { tell_all(p, 40, seed); }), in_order)
                << "seed " << seed;
    }
}

TEST(Progress, NothingThatEndedIsLostWhereOneBeforeItNeverEnds) {
    for (const bool says_the_end : {true, false})
        for (const ProgressStyle style : {ProgressStyle::plain, ProgressStyle::json}) {
            const Output output;
            auto progress = make_progress({.style = style, .total = 5, .to = output.file()});
            progress({0, AttemptBegins{"attempt-0"}});
            tell(progress, 3);
            tell(progress, 1);
            if (says_the_end) progress({.what = day_of(5)});
            progress = nullptr;
            const std::string text = output.text();
            EXPECT_LT(text.find("attempt-1"), text.find("attempt-3"));
            EXPECT_NE(text.find("attempt-3"), std::string::npos);
        }
}

TEST(JsonProgress, EachLineIsAnEvent) {
    const std::string text =
        shown({.style = ProgressStyle::json, .total = 6}, [](const Progress& progress) {
            tell(progress, 1);
            tell(progress, 0);
            progress({.what = Note{"a \"note\"\n\x1b[31m\xff"}});
            progress({.what = day_of(6)});
        });
    std::vector<nlohmann::json> events;
    for (const std::string& line : lines_of(text))
        events.push_back(nlohmann::json::parse(line));
    std::vector<std::string> names;
    for (const auto& event : events)
        names.push_back(event.at("event"));
    EXPECT_EQ(names, (std::vector<std::string>{"begin", "step", "step", "attempt", "begin", "step",
                                               "step", "attempt", "note", "end"}));
    EXPECT_EQ(events[0].at("id"), "attempt-0");
    EXPECT_EQ(events[6].at("reason"), "parameters.smooth.robust_scale 2 -> 2.5");
    EXPECT_EQ(events[6].at("ran"), true);
    EXPECT_EQ(events[7].at("index"), 1);
    EXPECT_EQ(events[7].at("source"), "attempt-1.yaml");
    EXPECT_EQ(events[7].at("steps_kept"), 1);
    EXPECT_EQ(events[7].at("said").at(1), "fisly: not proven");
    EXPECT_EQ(events[8].at("text"), "a \"note\"\n\x1b[31m\xef\xbf\xbd");
    EXPECT_EQ(events[9].at("not_processed"), 1);
    EXPECT_TRUE(std::all_of(text.begin(), text.end(),
                            [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); }));
}

TEST(JsonProgress, WhatIsNextIsSaidAtOnce) {
    const Output output;
    const auto progress =
        make_progress({.style = ProgressStyle::json, .total = 2, .to = output.file()});
    progress({1, AttemptBegins{"b"}});
    EXPECT_EQ(output.text(), "");
    progress({0, AttemptBegins{"a"}});
    EXPECT_EQ(lines_of(output.text()).size(), 1U);
    progress({0, report_of(0)});
    // The two steps that were only reported at the end, the attempt, and what was held back.
    EXPECT_EQ(lines_of(output.text()).size(), 5U);
}

TEST(Progress, TextFromOutsideSteersNoTerminal) {
    AttemptReport report = report_of(4);
    const std::string nasty = "x\x1b[2J\x07\r\n\xe2\x80\xae\xff";
    report.id = report.state = report.steps[0].step = report.steps[0].reason = nasty;
    report.said = {nasty};
    report.error = nasty;
    report.state = nasty;
    for (const ProgressStyle style : {ProgressStyle::plain, ProgressStyle::json}) {
        const std::string text =
            shown({.style = style, .explain = true, .columns = 400}, [&](const Progress& progress) {
                progress({0, AttemptBegins{nasty}});
                progress({0, report});
                progress({.what = Note{nasty}});
                DaySummary day = day_of(1);
                day.results = nasty;
                day.closing = {nasty};
                progress({.what = day});
            });
        EXPECT_NE(text.find("[2J"), std::string::npos);
        for (const char* bad : {"\x1b", "\x07", "\r", "\xe2\x80\xae", "\xff"})
            EXPECT_EQ(text.find(bad), std::string::npos) << text;
    }
}

TEST(EventLines, PassWhatIsFirstAndHoldBackTheRest) {
    EventLines lines({.style = ProgressStyle::json});
    // An attempt by its letter, and of it the number of the step that has ended.
    const auto after = [&](const Event& event) {
        std::string said;
        for (const std::string& line : lines_of(lines.after(event, 80))) {
            const nlohmann::json what = nlohmann::json::parse(line);
            said += what.contains("index") ? "abcdefg"[what["index"].get<std::size_t>()] : '-';
            said += what.contains("step") ? what["step"].get<std::string>() : "";
        }
        return said;
    };
    EXPECT_EQ(after({1, StepReport{.step = "1"}}), "");
    EXPECT_EQ(after({0, StepReport{.step = "1"}}), "a1");
    EXPECT_EQ(after({1, AttemptReport{.id = "b", .state = "done"}}), "");
    EXPECT_EQ(after({2, StepReport{.step = "1"}}), "");
    EXPECT_EQ(after({0, AttemptSkipped{}}), "b1bc1");
    EXPECT_EQ(after({2, StepReport{.step = "2"}}), "c2");
    EXPECT_EQ(after({4, StepReport{.step = "1"}}), "");
    EXPECT_EQ(after({.what = Note{}}), "-");
    EXPECT_EQ(after({.what = DaySummary{}}), "e1-");
    EXPECT_EQ(lines.rest(), "");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
