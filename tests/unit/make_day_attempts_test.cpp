#include <fmt/format.h>

#include <chrono>
#include <iostream>

#include "make_day_support.h"
#include "schemas/attempt/attempt.h"

// What may be given as a day, and ids that two attempts have.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::DayTest;
using test::Ids;
using test::ids_of;
using test::notes_say;
using test::said_of;

struct Days : DayTest {};

TEST_F(Days, AttemptFilesByName) {
    put_attempt("b.yaml", "b");
    put_attempt("a/attempt.yaml", "a");
    put("c.yaml", "schema: day/1.0\nattempts: [{recording: r}]\n");
    const Day one = read_day({day() / "b.yaml"}, out());
    EXPECT_EQ(ids_of(one), Ids{"b"});
    EXPECT_EQ(one.name, "day");
    const Day day =
        read_day({this->day() / "none.yaml", this->day() / "b.yaml", this->day() / "./b.yaml",
                  this->day() / "a/attempt.yaml", this->day() / "c.yaml"},
                 out());
    EXPECT_EQ(day.attempts.size(), 4U);
    std::string said;
    for (const GivenAttempt& attempt : day.attempts)
        said += said_of(attempt) + "\n";
    EXPECT_NE(said.find("none.yaml"), std::string::npos);
    EXPECT_NE(said.find("c.yaml:1:9: schema: the file does not say that it follows attempt/1.0"),
              std::string::npos)
        << said;
    EXPECT_TRUE(notes_say(day, "named twice"));
}

TEST_F(Days, WhatIsNoDayIsAFailure) {
    put_attempt("a.yaml", "a");
    put("list.txt", "a.yaml\n");
    put("results/day.yaml", "schema: day/1.0\nattempts: [{recording: r}]\n");
    const auto said = [&](const std::vector<fs::path>& given, const fs::path& to) {
        return test::failure_of([&] { (void)read_day(given, to); });
    };
    EXPECT_TRUE(said({}, out()).contains("no day is named"));
    EXPECT_TRUE(said({day() / "none"}, out()).contains("none"));
    EXPECT_TRUE(said({day() / "list.txt"}, out()).contains("day/1.0"));
    EXPECT_TRUE(said({day(), day() / "a.yaml"}, out()).contains("a folder is named beside"));
    EXPECT_TRUE(said({day()}, day()).contains("the results' folder is the day's own"));
    EXPECT_TRUE(said({day() / "results/day.yaml"}, day() / "results")
                    .contains("the results' folder is the day's own"));
}

TEST_F(Days, TwoAttemptsOfOneIdAreBothRefused) {
    put_attempt("a.yaml", "same");
    put_attempt("b.yaml", "other");
    put_attempt("c.yaml", "same");
    put_attempt("d.yaml", "Case");
    put_attempt("e.yaml", "cASE");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"!same", "other", "!same", "!Case", "!cASE"}));
    EXPECT_NE(said_of(day.attempts[0]).find("a.yaml: the id \"same\" is that of c.yaml too"),
              std::string::npos)
        << said_of(day.attempts[0]);
    EXPECT_NE(said_of(day.attempts[2]).find("is that of a.yaml too"), std::string::npos);
    EXPECT_NE(said_of(day.attempts[3]).find("e.yaml (as \"cASE\") too, but for the case"),
              std::string::npos)
        << said_of(day.attempts[3]);
}

TEST_F(Days, ManyAttemptsOfOneIdNameThree) {
    for (int i = 0; i < 9; ++i)
        put_attempt(fmt::format("a{}.yaml", i), "same");
    EXPECT_NE(said_of(read().attempts.at(4)).find("a0.yaml, a1.yaml, a2.yaml and 5 more too"),
              std::string::npos)
        << said_of(read().attempts.at(4));
}

/// What is known by a label alone must not stand in the way of an attempt.
TEST_F(Days, ALabelIsNoOtherAttemptsId) {
    put_attempt("x.yaml", "a-b");
    put("a b.yaml", "schema: attempt/1.0\nid: [\n");
    put("a'b.yaml", "schema: attempt/1.0\nid: [\n");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"!a-b-2", "!a-b-3", "a-b"}));
}

/// An attempt's id is read without parsing the file: it is what the parser reads.
TEST_F(Days, TheQuickIdIsTheParsersOrLeftToIt) {
    int same = 0;
    const std::vector<std::string> lines{"id: a",
                                         "id: \"a\"",
                                         "id: 'a'",
                                         "id:   a   ",
                                         "id: a # b",
                                         "id: a#b",
                                         "id: !!str a",
                                         "id: >-\n  a",
                                         "id:\n  a",
                                         "id: {a: b}",
                                         "id: null",
                                         "id: \"a\\x62\"",
                                         "id: 'it''s'",
                                         "id: a\nid: b",
                                         "  id: a",
                                         "place: |\n  x\nid: a",
                                         "place: \"x\n  id: b\"\nid: a",
                                         "id: a\n# id: b",
                                         "id: a\nidx: b",
                                         "\"id\": a",
                                         "id : a",
                                         "id: 0x1F",
                                         "id: 007",
                                         "id:\ta"};
    for (std::size_t i = 0; i < lines.size(); ++i) {
        put("a.yaml", "schema: attempt/1.0\n" + lines[i] +
                          "\ncraft: {name: b, class: board}\nreceivers: [{id: primary, recording: "
                          "r}]\nprofiles: [nalsa]\n");
        const GivenAttempt attempt = read().attempts.at(0);
        std::string parsed = "refused";
        try {
            parsed = read_attempt(
                         attempt.text.empty() ? test::slurp(day() / "a.yaml") : attempt.text, "f")
                         .id;
        } catch (const Failure&) {
        }
        // Refused by the parser: here already, or by who makes the run.
        if (attempt.refused) {
            EXPECT_EQ(parsed, "refused") << lines[i];
        } else if (parsed != "refused") {
            EXPECT_EQ(attempt.id, parsed) << lines[i];
        }
        same += !attempt.refused && attempt.id == parsed ? 1 : 0;
    }
    EXPECT_GE(same, 12);
}

TEST_F(Days, TwoThousandAttemptsAreListedAtOnce) {
    std::string entries;
    for (int i = 0; i < 2000; ++i) {
        const std::string n = std::to_string(i);
        put_attempt(fmt::format("files/{}/attempt.yaml", n), "id-" + n);
        put(fmt::format("logs/{}.pos", n));
        entries += fmt::format("  - {{recording: logs/{}.pos}}\n", n);
    }
    const auto timed = [&](const char* what, const fs::path& given) {
        const auto begin = std::chrono::steady_clock::now();
        const Day day = read_day({given}, out());
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        std::cout << "2,000 " << what << ": " << taken.count() << " s\n";
        EXPECT_EQ(day.attempts.size(), 2000U);
        for (const GivenAttempt& attempt : day.attempts)
            ASSERT_EQ(said_of(attempt), "");
    };
    timed("attempt files", day() / "files");
    put_day(entries);
    timed("entries of a day file", day() / "day.yaml");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
