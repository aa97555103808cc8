#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "schemas/day/day.h"
#include "store/yaml_input.h"
#include "store/yaml_output.h"
#include "store_test_support.h"

// A day's file: what its entries are with the defaults, and what is refused.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

/// The text of the only attempt of a day with those defaults and that entry.
std::string text_of(const std::string& defaults, const std::string& entry) {
    const DayFile day = read_day_file(
        "schema: day/1.0\ndefaults: " + defaults + "\nattempts: [" + entry + "]\n", "f");
    const DayEntry& one = day.entries.at(0);
    return one.refused ? one.refused->what() : attempt_text(one.id, one.keys, "c");
}

const std::string head = "# c\nschema: attempt/1.0\nid: a\n";

TEST(DayDefaults, StandWhereTheEntryIsSilent) {
    const struct {
        const char *defaults, *entry, *expected;
    } cases[] = {
        {"{}", "{place: a}", "place: a\n"},
        {"{place: a}", "{}", "place: a\n"},
        {"{place: a}", "{place: b}", "place: b\n"},
        // A value is replaced whole, and null takes it away.
        {"{craft: {name: A, class: car}}", "{craft: {name: B}}", "craft:\n  name: B\n"},
        {"{profiles: [nalsa, fisly]}", "{profiles: [fisly]}", "profiles:\n  - fisly\n"},
        {"{place: a, craft: {name: A}}", "{place: null}", "craft:\n  name: A\n"},
        // What is of a receiver stands beside the recording.
        {"{format: csv, columns: {time: 1}}", "{recording: r, columns: {time: 2}}",
         "receivers:\n  - id: primary\n    format: csv\n    recording: r\n    columns:\n"
         "      time: 2\n"},
    };
    for (const auto& one : cases) {
        std::string entry = one.entry;
        entry.insert(1, entry == "{}" ? "id: a" : "id: a, ");
        EXPECT_EQ(text_of(one.defaults, entry), head + one.expected) << one.defaults << entry;
    }
    EXPECT_NE(text_of("{format: csv}", "{id: a, receivers: [{id: b, recording: r}]}")
                  .find("the defaults have \"format\" of a receiver"),
              std::string::npos);
}

TEST(DayDefaults, TextStaysAsItIsWritten) {
    EXPECT_EQ(text_of("{}",
                      "{id: a, craft: {name: 0042, \"x: y\": \"\"}, place: 1.50, date: "
                      "\"2026-03-14\", officials: [], record: {}}"),
              head +
                  "craft:\n  name: 0042\n  \"x: y\": \"\"\nplace: 1.50\ndate: "
                  "\"2026-03-14\"\nofficials: []\nrecord: {}\n");
}

/// The lines of an attempt as an entry of a day.
std::string indented_keys(const std::string& text) {
    std::string all;
    for (const std::string& line : lines_of(text))
        if (!line.starts_with("schema:")) all += "    " + line + "\n";
    return all;
}

/// Every attempt that the reader takes is the same attempt once it was written by the day.
TEST(DayDefaults, AnAttemptIsTheSameAttemptAfterwards) {
    int read = 0;
    for (const char* name : {"v1.0/attempt.yaml", "v1.0/attempt.plane.yaml"}) {
        const std::string file = std::string(RUNCERT_SOURCE_DIR "/tests/golden/") + name;
        SCOPED_TRACE(name);
        const std::string text = test::slurp(file);
        const DayFile day =
            read_day_file("schema: day/1.0\nattempts:\n  -\n" + indented_keys(text), "f");
        const DayEntry& entry = day.entries.at(0);
        ASSERT_FALSE(entry.refused) << entry.refused->what();
        const std::string again = attempt_text(entry.id, entry.keys, "again");
        const YamlValue before(parse_yaml(text, "f"), "f"), after(parse_yaml(again, "g"), "g");
        const Attempt a = read_attempt(text, "f"), b = read_attempt(again, "g");
        EXPECT_EQ(a.id, b.id);
        EXPECT_EQ(json_from_yaml(a.resolved["parameters"]),
                  json_from_yaml(b.resolved["parameters"]));
        EXPECT_EQ(a.overrides, b.overrides);
        EXPECT_EQ(a.profiles, b.profiles);
        EXPECT_EQ(a.attempts_made, b.attempts_made);
        ASSERT_EQ(a.receivers.size(), b.receivers.size());
        for (std::size_t i = 0; i < a.receivers.size(); ++i) {
            EXPECT_EQ(a.receivers[i].columns, b.receivers[i].columns);
            EXPECT_EQ(a.receivers[i].recordings, b.receivers[i].recordings);
            EXPECT_EQ(a.receivers[i].solution, b.receivers[i].solution);
            EXPECT_EQ(a.receivers[i].time_source, b.receivers[i].time_source);
        }
        // And key by key, as text.
        const std::function<void(const YamlValue&, const YamlValue&)> compare =
            [&](const YamlValue& x, const YamlValue& y) {
                for (const std::string& key : x.keys()) {
                    if (x.path().empty() && key == "schema") continue;
                    compare(x[key], y[key]);
                }
                if (x.is_list()) {
                    ASSERT_EQ(x.list().size(), y.list().size()) << x.path();
                    for (std::size_t i = 0; i < x.list().size(); ++i)
                        compare(x.list()[i], y.list()[i]);
                } else if (!x.is_map() && x.exists()) {
                    const auto number = parse_double(x.text());
                    if (number)
                        EXPECT_EQ(number, parse_double(y.text())) << x.path();
                    else
                        EXPECT_EQ(x.text(), y.text()) << x.path();
                }
            };
        compare(before, after);
        ++read;
    }
    EXPECT_EQ(read, 2);
}

TEST(DayFile, AShortEntryIsOneReceiver) {
    const DayFile day = read_day_file(
        "schema: day/1.0\n"
        "attempts:\n"
        "  - {recording: a.csv, format: csv, columns: {time: 1}, id: x, height_m: 1}\n"
        "  - {recording: [a, b]}\n",
        "f");
    EXPECT_EQ(day.id, "");
    EXPECT_TRUE(day.entries.at(0).short_form);
    EXPECT_EQ(day.entries[0].place, "f:3:5");
    EXPECT_EQ(day.entries[0].id, "x");
    EXPECT_EQ(plain_yaml_text(day.entries[0].keys),
              "receivers:\n  - id: primary\n    recording: a.csv\n    format: csv\n    columns:\n"
              "      time: 1\n    height_m: 1\n");
    EXPECT_EQ(plain_yaml_text(day.entries[1].keys),
              "receivers:\n  - id: primary\n    recording:\n      - a\n      - b\n");
}

TEST(DayFile, FaultsOfTheWhole) {
    const struct {
        const char *text, *where, *said;
    } cases[] = {
        {"", "f", "empty"},
        {"- a\n", "f:1:1", "day/1.0"},
        {"schema: attempt/1.0\nattempts: []\n", "f:1:9", "day/1.0"},
        {"schema: day/1.1\nattempts: []\n", "f:1:9", "day/1.0"},
        {"schema: day/2.0\nattempts: []\n", "f:1:9", "day/1.0"},
        {"schema: day/1.0\n", "f", "\"attempts\" is missing"},
        {"schema: day/1.0\nattempts: []\n", "f:2:11", "no attempt is listed"},
        {"schema: day/1.0\nattempts: {a: b}\n", "f:2:11", "is a map, not list"},
        {"schema: day/1.0\nattempts: 5\n", "f", "attempts"},
        {"schema: day/1.0\nid: a b\nattempts: [{recording: a}]\n", "f:2:5", "cannot be an id"},
        {"schema: day/1.0\ndefault: {}\nattempts: [{recording: a}]\n", "f:2:1",
         "Did you mean \"defaults\"?"},
        {"schema: day/1.0\ndefaults: {crafd: {}}\nattempts: [{recording: a}]\n", "f:2:12",
         "Did you mean \"craft\"?"},
        {"schema: day/1.0\ndefaults: {id: a}\nattempts: [{recording: a}]\n", "f:2:12",
         "\"id\" cannot be the same for all"},
        {"schema: day/1.0\ndefaults: [a]\nattempts: [{recording: a}]\n", "f:2:11", "not map"},
        {"schema: day/1.0\ndefaults: {receivers: [{id: a}]}\nattempts: [{recording: a}]\n",
         "f:2:12", "\"receivers\" cannot be the same for all attempts. List the attempts"},
        {"schema: day/1.0\ndefaults: {recording: a}\nattempts: [{recording: a}]\n", "f:2:12",
         "\"recording\" cannot be the same for all attempts"},
        {"schema: day/1.0\na: &x [1]\nattempts: [*x]\n", "f:2:4", "anchors and aliases"},
        {"schema: day/1.0\nattempts: [\n", "f:", "not valid YAML"},
    };
    for (const auto& one : cases) {
        const auto said = failure_of([&] { (void)read_day_file(one.text, "f"); });
        EXPECT_TRUE(said.where.starts_with(one.where)) << one.text << said.where;
        EXPECT_TRUE(said.contains(one.said)) << one.text << said.problem << said.remedy;
    }
    // Nine levels of ten aliases each: refused at the first, before anything is built.
    std::string bomb = "schema: day/1.0\na0: &a0 [x,x,x,x,x,x,x,x,x,x]\n";
    for (int i = 1; i < 9; ++i) {
        bomb += fmt::format("a{0}: &a{0} [", i);
        for (int j = 0; j < 10; ++j)
            bomb += fmt::format("*a{},", i - 1);
        bomb += "]\n";
    }
    EXPECT_EQ(failure_of([&] { (void)read_day_file(bomb, "f"); }).where, "f:2:5");
}

TEST(DayFile, AFaultOfAnEntryIsThatEntrysAlone) {
    const struct {
        const char *entry, *where, *said;
    } cases[] = {
        {"5", "f:4:5", "attempts[1]: is not a map"},
        {"[a]", "f:4:5", "map"},
        {"~", "f:4:5", "is empty"},
        {"{recording: {a: b}}", "f:4:17", "attempts[1].recording: is a map, not text"},
        {"{recordin: a}", "f:4:6", "Did you mean \"recording\"?"},
        {"{schema: attempt/1.0, recording: a}", "f:4:6", "unknown key \"schema\""},
        {"{id: [a], recording: a}", "f:4:10", "id"},
        {"{recording: a, receivers: [{id: b, recording: a}]}", "f:4:5", "recording and receivers"},
        {"{format: csv, receivers: [{id: b, recording: a}]}", "f:4:6", "belongs to a receiver"},
        {"{receivers: [{recording: a}]}", "f:4:18",
         "attempts[1].receivers[0]: the key \"id\" is missing"},
        {"{receivers: [7]}", "f:4:18", "is a single value, not a map"},
        {"{recording: [a, [b]]}", "f:4:21", "is a list, not text"},
        {"{receivers: 7}", "f:4:17", "receivers"},
        {"{attempt: a.yaml, id: b}", "f:4:23", "taken as it is"},
        {"{attempt: \"\"}", "f:4:15", "not the name of a file"},
        {"{attempt: [a.yaml]}", "f:4:15", "attempt"},
    };
    for (const auto& one : cases) {
        const DayFile day =
            read_day_file(std::string("schema: day/1.0\nattempts:\n  - {recording: a}\n  - ") +
                              one.entry + "\n  - {attempt: b.yaml}\n",
                          "f");
        ASSERT_EQ(day.entries.size(), 3U);
        EXPECT_FALSE(day.entries[0].refused || day.entries[2].refused) << one.entry;
        ASSERT_TRUE(day.entries[1].refused) << one.entry;
        EXPECT_EQ(day.entries[1].refused->where(), one.where) << one.entry;
        EXPECT_NE(std::string(day.entries[1].refused->what()).find(one.said), std::string::npos)
            << one.entry << "\n"
            << day.entries[1].refused->what();
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
