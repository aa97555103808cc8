#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "schemas/attempt/attempt.h"
#include "schemas/day/day.h"
#include "schemas/day/merge.h"
#include "store/yaml_input.h"
#include "store_test_support.h"

// A day's file: what its entries are with the defaults, and what is refused.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using Json = nlohmann::ordered_json;

Json keys_of(const std::string& yaml) {
    return attempt_keys(YamlValue(parse_yaml(yaml, "f"), "f"));
}

TEST(DayMerge, LaterWinsKeyByKey) {
    const struct {
        const char *defaults, *entry, *expected;
    } cases[] = {
        {"{}", "{place: a}", "{place: a}"},
        {"{place: a}", "{}", "{place: a}"},
        {"{place: a}", "{place: b}", "{place: b}"},
        // Maps are joined, at any depth.
        {"{craft: {name: A, class: car}}", "{craft: {name: B}}", "{craft: {name: B, class: car}}"},
        {"{parameters: {smooth: {jerk_density: 1, noise: stated}}}",
         "{parameters: {smooth: {jerk_density: 2}, window: {seed: 3}}}",
         "{parameters: {smooth: {jerk_density: 2, noise: stated}, window: {seed: 3}}}"},
        // Other lists are replaced.
        {"{profiles: [nalsa, fisly]}", "{profiles: [fisly]}", "{profiles: [fisly]}"},
        {"{officials: [{role: measurer, name: A}]}", "{officials: [{role: measurer}]}",
         "{officials: [{role: measurer}]}"},
        {"{profiles: [nalsa]}", "{profiles: []}", "{profiles: []}"},
        // What is of another kind replaces the whole.
        {"{craft: {name: A}}", "{craft: B}", "{craft: B}"},
        {"{craft: B}", "{craft: {name: A}}", "{craft: {name: A}}"},
        // Null takes a default away.
        {"{place: a, record: {speed: 1, unit: kn}}", "{place: null, record: {unit: ~}}",
         "{record: {speed: 1}}"},
        // Receivers by their id: the entry says which, and in which order.
        {"{receivers: [{id: a, format: csv, columns: {time: 1, up: 2}}, {id: b, format: nmea}]}",
         "{receivers: [{id: b, recording: y}, {id: a, recording: x, columns: {up: 5}}]}",
         "{receivers: [{id: b, format: nmea, recording: y}, {id: a, format: csv, columns: {time: "
         "1, up: 5}, recording: x}]}"},
        {"{receivers: [{id: a, format: csv}]}", "{receivers: [{id: c, recording: x}]}",
         "{receivers: [{id: c, recording: x}]}"},
        {"{receivers: [{id: a, format: csv}]}",
         "{receivers: [{id: a, format: null, recording: x}]}",
         "{receivers: [{id: a, recording: x}]}"},
        {"{receivers: [{id: a, recording: x}]}", "{place: b}",
         "{receivers: [{id: a, recording: x}], place: b}"},
    };
    for (const auto& one : cases)
        EXPECT_EQ(over_defaults(keys_of(one.defaults), keys_of(one.entry)), keys_of(one.expected))
            << one.defaults << " " << one.entry;
}

TEST(DayMerge, TextStaysAsItIsWrittenAndFiguresAreNumbers) {
    const Json keys = keys_of(
        "{craft: {name: 0042}, place: 1.50, date: 2026-03-14, record: {speed: 202.90, unit: kn, "
        "source: 12}, receivers: [{columns: {time: 1, east: 01}}], parameters: {window: {seed: 7}, "
        "smooth: {jerk_density: \"1.5\"}}, signatures: [{role: judge, count: 2}]}");
    EXPECT_EQ(keys.dump(),
              R"({"craft":{"name":"0042"},"place":"1.50","date":"2026-03-14","record":{"speed":)"
              R"(202.9,"unit":"kn","source":"12"},"receivers":[{"columns":{"time":"1","east":)"
              R"("01"}}],"parameters":{"window":{"seed":7},"smooth":{"jerk_density":"1.5"}},)"
              R"("signatures":[{"role":"judge","count":2}]})");
}

/// Every attempt that the reader takes is the same attempt once it was written by the day.
TEST(DayMerge, AnAttemptIsTheSameAttemptAfterwards) {
    int read = 0;
    for (const char* name : {"v1.0/attempt.yaml", "v1.0/attempt.plane.yaml"}) {
        const std::string file = std::string(RUNCERT_SOURCE_DIR "/tests/golden/") + name;
        SCOPED_TRACE(name);
        const std::string text = test::slurp(file);
        Json keys = keys_of(text);
        keys.erase("schema");
        const std::string again = attempt_text(over_defaults(Json::object(), keys), "again");
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

TEST(DayMerge, TheOrderOfKeysDoesNotMatter) {
    EXPECT_EQ(
        attempt_text(keys_of("{profiles: [nalsa], craft: {class: car, name: A}, id: a}"), "c"),
        attempt_text(keys_of("{id: a, craft: {name: A, class: car}, profiles: [nalsa]}"), "c"));
    EXPECT_EQ(
        attempt_text(keys_of("{profiles: [nalsa], craft: {class: car, name: A}, id: a}"), "c"),
        "# c\nschema: attempt/1.0\nid: a\ncraft:\n  name: A\n  class: car\nprofiles:\n"
        "  - nalsa\n");
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
    EXPECT_EQ(day.entries[0].keys->dump(),
              R"({"id":"x","receivers":[{"id":"primary","recording":"a.csv","format":"csv",)"
              R"("columns":{"time":"1"},"height_m":1.0}]})");
    EXPECT_EQ(day.entries[1].keys->dump(),
              R"({"receivers":[{"id":"primary","recording":["a","b"]}]})");
    const DayFile other = read_day_file(
        "schema: day/1.0\ndefaults: {receivers: [{id: mast, format: ubx}]}\n"
        "attempts: [{recording: a.ubx}]\n",
        "f");
    EXPECT_EQ(other.entries.at(0).keys->dump(),
              R"({"receivers":[{"id":"mast","format":"ubx","recording":"a.ubx"}]})");
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
        {"schema: day/1.0\nattempts: {a: b}\n", "f:2:11", "is not a list"},
        {"schema: day/1.0\nattempts: 5\n", "f", "attempts"},
        {"schema: day/1.0\nid: a b\nattempts: [{recording: a}]\n", "f:2:5", "cannot be an id"},
        {"schema: day/1.0\ndefault: {}\nattempts: [{recording: a}]\n", "f:2:1",
         "Did you mean \"defaults\"?"},
        {"schema: day/1.0\ndefaults: {crafd: {}}\nattempts: [{recording: a}]\n", "f:2:12",
         "Did you mean \"craft\"?"},
        {"schema: day/1.0\ndefaults: {id: a}\nattempts: [{recording: a}]\n", "f:2:12",
         "\"id\" cannot be the same for all"},
        {"schema: day/1.0\ndefaults: [a]\nattempts: [{recording: a}]\n", "f:2:11", "not map"},
        {"schema: day/1.0\ndefaults: {receivers: [{format: csv}]}\nattempts: [{recording: a}]\n",
         "f:2:24", "id"},
        {"schema: day/1.0\ndefaults: {receivers: {id: a}}\nattempts: [{recording: a}]\n", "f:2:23",
         "list"},
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
        {"{receivers: [7]}", "f:4:18", "is not a map"},
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
