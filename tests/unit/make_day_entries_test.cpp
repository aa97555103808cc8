#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "../chain/day_support.h"
#include "make_day_support.h"
#include "schemas/attempt/attempt.h"
#include "schemas/simulation/simulation.h"
#include "simulation/recording_text.h"
#include "store/yaml_output.h"

// A day file as a day: the attempts that its entries make.

namespace runcert::RUNCERT_FILE {
namespace {

namespace fs = std::filesystem;
using test::DayTest;
using test::Ids;
using test::ids_of;
using test::notes_say;
using test::said_of;

struct DayEntries : DayTest {};

std::vector<std::string> recordings_of(const GivenAttempt& attempt) {
    return read_attempt(attempt.text, attempt.source).receivers.at(0).recordings;
}

TEST_F(DayEntries, AnAttemptForEachEntry) {
    put("logs/heat-2.nmea");
    put("logs/heat-10.nmea");
    put_day(
        "  - {recording: logs/heat-10.nmea}\n"
        "  - {recording: logs/heat-2.nmea, place: \"0042\"}\n");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"heat-10", "heat-2"}));
    EXPECT_EQ(day.attempts[0].source, "day.yaml:4");
    EXPECT_TRUE(day.attempts[0].file.empty());
    EXPECT_EQ(day.attempts[0].folder, this->day());
    EXPECT_EQ(day.attempts[1].text,
              "# Made by runcert batch from day.yaml, the attempt heat-2.\n"
              "schema: attempt/1.0\nid: heat-2\ncraft:\n  name: A\n  class: board\nprofiles:\n"
              "  - nalsa\nplace: \"0042\"\nreceivers:\n"
              "  - id: primary\n    recording: logs/heat-2.nmea\n");
    EXPECT_EQ(read_attempt(day.attempts[1].text, "f").id, "heat-2");
    EXPECT_TRUE(day.notes.size() == 1U && notes_say(day, "what its day.yaml says"));
}

TEST_F(DayEntries, IdsMadeOfNames) {
    put("\xc3\x89mile's run.pos");
    put("--.obs");
    put("-x.vbo");
    put("a.b.sbp");
    put(std::string(100, 'z') + ".ubx");
    put("run2.csv");
    put_day(
        "  - {recording: \"\xc3\x89mile's run.pos\"}\n"
        "  - {recording: --.obs}\n"
        "  - {recording: -x.vbo}\n"
        "  - {recording: a.b.sbp}\n"
        "  - {recording: " +
        std::string(100, 'z') +
        ".ubx}\n"
        "  - {recording: [run2.csv, a.b.sbp]}\n");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"mile-s-run", "run", "x", "a-b", std::string(64, 'z'), "run2"}));
    EXPECT_TRUE(notes_say(day, "day.yaml:4: \"\xc3\x89mile's run\" as an id is mile-s-run"));
    EXPECT_TRUE(notes_say(day, "\"--\" as an id is run"));
    EXPECT_EQ(day.notes.size(), 6U);
    for (const GivenAttempt& attempt : day.attempts)
        EXPECT_EQ(read_attempt(attempt.text, "f").id, attempt.id);
}

TEST_F(DayEntries, WhatIsWrongWithOneIsSaidInItsOwnWords) {
    put("a.pos");
    put("b.pos");
    put("sub/c.pos");
    put("../outside.pos");
    fs::create_symlink("../outside.pos", day() / "link.pos");
    const struct {
        const char *entry, *label, *said;
    } cases[] = {
        {"{recording: none.pos}", "none", "day.yaml:5:5: recording: \"none.pos\" does not exist"},
        {"{recording: \"*.ubx\"}", "run",
         "day.yaml:5:5: recording: \"*.ubx\" is a pattern, and an entry is one attempt"},
        {"{recording: \"a?.pos\"}", "a-", "List the attempts; `runcert new --day` writes them out"},
        {"{id: \"b-*\", recording: \"*.pos\"}", "b--", "is a pattern"},
        {"{recording: ../outside.pos}", "outside", "is outside of the day file's folder"},
        {"{recording: \"../*.pos\"}", "run", "is outside of the day file's folder"},
        {"{recording: /etc/passwd}", "passwd", "is outside of the day file's folder"},
        {"{recording: link.pos}", "link", "by a symbolic link"},
        {"{recording: \"\"}", "run", "is empty"},
        {"{recording: a.pos, format: ubxx}", "a", "day.yaml:5:5: format: \"ubxx\" is not one of"},
        {"{recording: a.pos, columns: {tim: 1}}", "a", "unknown key \"tim\" in columns"},
        {"{recording: a.pos, craft: {class: 7}}", "a", "craft.class: \"7\" is not one of"},
        {"{recording: a.pos, craft: null}", "a", "the key \"craft\" is missing"},
        {"{recording: a.pos, height_m: high}", "a", "height_m: \"high\" is not a number"},
        {"{recording: a.pos, profiles: [nalsa, nalsa]}", "a", "claimed twice"},
        {"{id: x, place: b}", "x", "\"receivers\" is missing"},
        {"{place: b}", "line-5", "\"receivers\" is missing"},
        {"{id: a b, recording: a.pos}", "a-b", "\"a b\" cannot be an id"},
        {"{id: .., recording: a.pos}", "run", "cannot be an id"},
        {"{id: .runcert, recording: a.pos}", "runcert", "cannot be an id"},
        {"{unknown: 5}", "line-5", "unknown key \"unknown\""},
        {"7", "line-5", "attempts[1]: is not a map"},
        {"{attempt: none.yaml}", "none", "none.yaml"},
        {"{attempt: \"no*.yaml\"}", "no-", "attempt: \"no*.yaml\" is a pattern"},
    };
    for (const auto& one : cases) {
        put_day("  - {recording: a.pos, id: first}\n  - " + std::string(one.entry) +
                "\n  - {recording: b.pos, id: last}\n");
        const Day day = read();
        EXPECT_EQ(ids_of(day), (Ids{"first", std::string("!") + one.label, "last"})) << one.entry;
        if (day.attempts.size() != 3U) continue;
        EXPECT_NE(said_of(day.attempts[1]).find(one.said), std::string::npos)
            << one.entry << "\n"
            << said_of(day.attempts[1]);
        EXPECT_EQ(said_of(day.attempts[1]).find("receivers["), std::string::npos) << one.entry;
    }
}

TEST_F(DayEntries, AttemptFilesAreTakenAsTheyAre) {
    put_attempt("heats/run-1.yaml", "one");
    put_attempt("heats/run-2.yaml", "two");
    put_attempt("more/attempt.yaml", "three");
    put_day(
        "  - attempt: more/attempt.yaml\n"
        "  - attempt: heats/run-1.yaml\n"
        "  - attempt: heats/run-2.yaml\n");
    const Day day = read();
    EXPECT_EQ(ids_of(day), (Ids{"three", "one", "two"}));
    EXPECT_EQ(day.attempts[1].source, "heats/run-1.yaml");
    EXPECT_EQ(day.attempts[1].folder, this->day() / "heats");
    EXPECT_EQ(day.attempts[1].text, test::slurp(this->day() / "heats/run-1.yaml"));
}

/// Letters that YAML or a shell would read otherwise.
const std::vector<std::string> odd_names{
    "a b", "a'b",  "a\"b", "a: b #", "[a]",   "a\\b", "\xc3\x89mile", "\xf0\x9f\x8f\x81",
    "yes", "0042", "~",    "*",      "what?", "- a",  "!tag",         "&anchor",
    "%a"};

TEST_F(DayEntries, AFileOfAnyNameIsFoundByTheAttemptThatNamesIt) {
    std::string entries;
    for (std::size_t i = 0; i < odd_names.size(); ++i) {
        const std::string name = "logs/" + odd_names[i] + ".pos";
        put(name, odd_names[i]);
        entries += fmt::format("  - id: n-{}\n    recording: {}", i, to_yaml_text(name));
    }
    put_day(entries);
    const Day day = read();
    ASSERT_EQ(day.attempts.size(), odd_names.size());
    for (std::size_t i = 0; i < odd_names.size(); ++i)
        EXPECT_EQ(recordings_of(day.attempts[i]).at(0), "logs/" + odd_names[i] + ".pos")
            << said_of(day.attempts[i]);
}

/// Neither where the day is nor what stands above an entry changes its attempt's text.
TEST_F(DayEntries, TheTextDependsOnTheEntryAlone) {
    put("a.pos");
    put("z/a.pos");
    put_day("  - {recording: a.pos, id: a}\n");
    const std::string before = read().attempts.at(0).text;
    put_day("  # a remark\n  - {recording: z/a.pos, id: z}\n  - {id: a, recording: a.pos}\n");
    EXPECT_EQ(read().attempts.at(1).text, before);
    fs::rename(day(), day().string() + " moved");
    EXPECT_EQ(read_day({day().string() + " moved"}, out()).attempts.at(1).text, before);
    EXPECT_EQ(before.find(day().string()), std::string::npos);
}

TEST_F(DayEntries, SimulatedDaysForOtherTestsAreDaysAndTheSameEachTime) {
    const Day first = read_day({chain::make_day(day() / "one", 12, 100)}, out());
    const Day again = read_day({chain::make_day(day() / "two", 12, 100)}, out());
    ASSERT_EQ(first.attempts.size(), 12U);
    std::set<std::string> recordings;
    for (std::size_t i = 0; i < 12; ++i) {
        const GivenAttempt& attempt = first.attempts[i];
        EXPECT_EQ(said_of(attempt), "");
        EXPECT_EQ(attempt.text, again.attempts.at(i).text);
        const fs::path recording = recordings_of(attempt).at(0);
        EXPECT_EQ(test::slurp(attempt.folder / recording),
                  test::slurp(again.attempts[i].folder / recording));
        recordings.insert(test::slurp(attempt.folder / recording));
    }
    EXPECT_EQ(recordings.size(), 12U);
    EXPECT_EQ(first.attempts[11].id, "run-0012");
}

/// The example is what a new user reads first: its recordings are those of its specs.
TEST(DayExample, IsFourAttemptsOfSimulatedRecordings) {
    const fs::path folder = RUNCERT_SOURCE_DIR "/examples/day";
    const Day day = read_day({folder}, "/nowhere");
    EXPECT_EQ(day.name, "lake-day");
    EXPECT_EQ(ids_of(day),
              (Ids{"yacht-a-heat-1", "yacht-a-heat-2", "yacht-a-heat-3", "yacht-b-final"}));
    EXPECT_EQ(read_attempt(day.attempts.at(3).text, "f").craft.name, "Yacht B");
    for (const GivenAttempt& attempt : day.attempts) {
        const fs::path recording = recordings_of(attempt).at(0);
        const fs::path spec_file = folder / "specs" / recording.stem().concat(".yaml");
        const SimulationDocument spec = read_simulation(test::slurp(spec_file), "spec");
        EXPECT_TRUE(rtklib_pos_text(spec, simulate(spec)) == test::slurp(folder / recording));
        EXPECT_LT(fs::file_size(folder / recording), 60'000U);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
