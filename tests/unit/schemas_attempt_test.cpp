#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "schemas/attempt/attempt.h"
#include "schemas_attempt_support.h"
#include "store/yaml_output.h"
#include "store_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

/// The attempt of DESIGN.md, word for word.
const std::string design = R"(schema: attempt/1.0
id: urban-car                    # letters, digits, - and _: names the run folder
craft: {name: test car, class: car}       # class sets defaults: land-yacht, ice-yacht, sail-boat, board, car, skydiver, other
place: Nagoya
officials: [{role: measurer}]    # name: and key: where there are some
receivers:
  - id: primary
    recording: rover.pos         # relative to this file
    format: auto                 # or rtklib-pos, csv, nmea, ubx, vbo, flysight, oao, ...
    # for csv: columns: {time: time_s, east: east_m, north: north_m, up: null}, frame: local_plane | geodetic | ecef | {utm: {zone: 55, hemisphere: south}}
    # accuracy: {horizontal_m: 0.010, vertical_m: 0.020}     # where the recording states none
    # lever_arm_m: {forward: 0.0, right: 0.0, down: -1.2}    # antenna to reference point
    # start_gps: "2022-03-18T08:51:22.300"                   # where the recording's time is relative
origin: {latitude_deg: 35.134709483, longitude_deg: 136.977574275, height_m: 104.728}   # optional: the base station
record: {speed: 202.9, unit: km/h, source: "..."}            # the record to beat; may be left out
profiles: [nalsa, fisly]
parameters: {}                   # overrides by stage, e.g. smooth: {jerk_density: 1.0}; each is printed in the report
)";

/// The least that an attempt says.
const std::string least = R"(schema: attempt/1.0
id: a
craft: {name: b, class: board}
receivers:
  - {id: primary, recording: r.csv}
profiles: [nalsa]
)";

TEST(Attempt, TheExampleOfTheDesignIsRead) {
    const Attempt attempt = read_attempt(design, "attempt.yaml");
    EXPECT_EQ(attempt.id, "urban-car");
    EXPECT_EQ(attempt.craft.name, "test car");
    EXPECT_EQ(attempt.craft.kind, "car");
    EXPECT_EQ(attempt.place, "Nagoya");
    EXPECT_EQ(attempt.date, "");
    ASSERT_EQ(attempt.officials.size(), 1U);
    EXPECT_EQ(attempt.officials[0].role, "measurer");
    EXPECT_EQ(attempt.officials[0].name, "");
    ASSERT_EQ(attempt.receivers.size(), 1U);
    const Receiver& receiver = attempt.receivers[0];
    EXPECT_EQ(receiver.id, "primary");
    EXPECT_EQ(receiver.recordings, std::vector<std::string>{"rover.pos"});
    EXPECT_EQ(receiver.format, "auto");
    EXPECT_EQ(receiver.place, "attempt.yaml:7:5");
    EXPECT_FALSE(receiver.frame || receiver.accuracy || receiver.start_gps || receiver.lever_arm);
    ASSERT_TRUE(attempt.origin && attempt.record);
    EXPECT_EQ(attempt.origin->latitude.degrees(), 35.134709483);
    EXPECT_EQ(attempt.origin->longitude.degrees(), 136.977574275);
    EXPECT_EQ(attempt.origin->height_m, 104.728);
    EXPECT_EQ(attempt.record->speed, 202.9);
    EXPECT_EQ(attempt.record->unit, "km/h");
    EXPECT_EQ(attempt.record->source, "...");
    EXPECT_EQ(attempt.profiles, (std::vector<std::string>{"nalsa", "fisly"}));
    EXPECT_TRUE(attempt.overrides.empty());
}

TEST(Attempt, WhatIsLeftOutHasItsDefault) {
    const Receiver receiver = read_attempt(least, "f").receivers.at(0);
    EXPECT_EQ(receiver.format, "auto");
    EXPECT_EQ(receiver.time_format, "seconds");
    EXPECT_EQ(receiver.time_scale, "");
    EXPECT_EQ(receiver.delimiter, "auto");
    EXPECT_TRUE(receiver.columns.empty());
    EXPECT_EQ(receiver.solution, "");
    EXPECT_EQ(receiver.time_source, "");
    EXPECT_EQ(read_attempt(least, "f").attempts_made, 1);
}

TEST(Attempt, ARecordingMayBeSeveralFilesOrRaw) {
    const Attempt attempt =
        read_attempt(replaced(least, "  - {id: primary, recording: r.csv}\n", R"(  - id: primary
    recording: [a.obs, b.obs]
    format: rinex
    base: base.obs
    navigation: [n.nav, g.nav]
    base_position: {latitude_deg: 35, longitude_deg: 137, height_m: 100}
    solution_pass: backward
    utc_offset_h: -7.5
    start_date: "2026-08-01"
    gpsbabel_type: garmin_fit
)"),
                     "f");
    const Receiver& receiver = attempt.receivers.at(0);
    EXPECT_EQ(receiver.recordings, (std::vector<std::string>{"a.obs", "b.obs"}));
    EXPECT_EQ(receiver.base, "base.obs");
    EXPECT_EQ(receiver.navigation, (std::vector<std::string>{"n.nav", "g.nav"}));
    EXPECT_EQ(receiver.base_position->height_m, 100.0);
    EXPECT_EQ(receiver.solution_pass, "backward");
    EXPECT_EQ(receiver.utc_offset_h, -7.5);
    EXPECT_EQ(receiver.start_date, "2026-08-01");
    EXPECT_EQ(receiver.gpsbabel_type, "garmin_fit");
    EXPECT_EQ(recording_names(receiver), "a.obs, b.obs");
}

TEST(Attempt, EveryMemberOfAReceiverIsKept) {
    const Attempt attempt = read_attempt(replaced(least, "  - {id: primary, recording: r.csv}\n",
                                                  R"(  - id: primary
    recording: day 1/r.csv
    format: csv
    frame: {utm: {zone: 55, hemisphere: south}}
    columns: {time: t, east: 2, north: "3", up: null}
    time_format: seconds_of_week
    time_scale: utc
    delimiter: semicolon
    start_gps: "2022-03-18T08:51:22.300"
    height_m: 12.5
    accuracy: {horizontal_m: 0.01, vertical_m: 0.02, velocity_mps: 0.05}
    antenna_height_m: 1.5
    lever_arm_m: {forward: 0.5, right: -0.25, down: -1.2}
  - {id: secondary, recording: s.pos, frame: local_plane, accuracy: {velocity_mps: 0.5}}
)"),
                                         "f");
    ASSERT_EQ(attempt.receivers.size(), 2U);
    const Receiver& first = attempt.receivers[0];
    EXPECT_EQ(first.recordings, std::vector<std::string>{"day 1/r.csv"});
    EXPECT_EQ(first.frame->kind, CoordinateFrame::utm);
    EXPECT_EQ(first.frame->utm_zone->zone, 55);
    EXPECT_FALSE(first.frame->utm_zone->northern);
    EXPECT_EQ(first.columns,
              (std::map<std::string, std::string>{{"time", "t"}, {"east", "2"}, {"north", "3"}}));
    EXPECT_EQ(first.time_format, "seconds_of_week");
    EXPECT_EQ(first.time_scale, "utc");
    EXPECT_EQ(first.delimiter, "semicolon");
    EXPECT_EQ(to_iso(*first.start_gps), "2022-03-18T08:51:22.300");
    EXPECT_EQ(first.height_m, 12.5);
    EXPECT_EQ(first.accuracy->horizontal_m, 0.01);
    EXPECT_EQ(first.accuracy->vertical_m, 0.02);
    EXPECT_EQ(first.accuracy->velocity_m_s, 0.05);
    EXPECT_EQ(first.antenna_height_m, 1.5);
    ASSERT_TRUE(first.lever_arm);
    EXPECT_EQ(*first.lever_arm, (std::array<double, 3>{0.5, -0.25, -1.2}));
    const Receiver& second = attempt.receivers[1];
    EXPECT_EQ(second.frame->kind, CoordinateFrame::local_plane);
    EXPECT_FALSE(second.frame->utm_zone || second.accuracy->vertical_m || second.lever_arm);
}

TEST(Attempt, ACalibrationStatesAnUncertaintyWithUnitAndQuantityOrNone) {
    const auto with = [](const std::string& more) {
        return replaced(
            least, "r.csv}",
            "r.csv, calibration: {certificate: c, laboratory: l, date: 2026-01-02" + more + "}}");
    };
    EXPECT_FALSE(read_attempt(with(""), "f").receivers.at(0).calibration->expanded_uncertainty);
    for (const char* unit : {"km/h", "m/s", "kn", "mph"})
        EXPECT_EQ(
            read_attempt(with(std::string(", expanded_uncertainty: 0.5, of: speed, unit: ") + unit),
                         "f")
                .receivers.at(0)
                .calibration->unit,
            unit);
    EXPECT_NO_THROW(read_attempt(with(", expanded_uncertainty: 1, of: time, unit: s"), "f"));
    EXPECT_NO_THROW(read_attempt(with(", expanded_uncertainty: 1, of: distance, unit: m"), "f"));
    for (const auto& [more, said] :
         {std::pair{", expanded_uncertainty: 1", "belong together"},
          {", unit: km/h, of: speed", "belong together"},
          {", expanded_uncertainty: 1, of: speed", "belong together"},
          {", expanded_uncertainty: 1, unit: s, of: speed", "of: speed needs unit: km/h or m/s or kn or mph"},
          {", expanded_uncertainty: 1, unit: km/h, of: time", "of: time needs unit: s"},
          {", expanded_uncertainty: 1, unit: s, of: distance", "of: distance needs unit: m"},
          {", expanded_uncertainty: 0, unit: s, of: time", "below"}}) {
        const auto failure = failure_of([&, text = more] { read_attempt(with(text), "f"); });
        EXPECT_TRUE(failure.where.starts_with("f:5:")) << failure.where;
        EXPECT_TRUE(failure.contains(said)) << failure.problem;
    }
    const auto day = failure_of(
        [] { read_attempt(least + "decision_rule_agreed: {date: March, by: us}\n", "f"); });
    EXPECT_EQ(day.where, "f:7:30");
}

TEST(Attempt, EveryFrameHasAWord) {
    for (const char* word : {"geodetic", "ecef", "local_plane"}) {
        const std::string text =
            replaced(least, "r.csv}", std::string("r.csv, frame: ") + word + "}");
        EXPECT_EQ(to_text(read_attempt(text, "f").receivers.at(0).frame->kind), word);
    }
}

TEST(Attempt, BadInputIsNamedWithItsPlace) {
    const test::BadAttempt cases[] = {
        {"receivers:", "reciever:", "f:4:1",
         "unknown key \"reciever\". Did you mean \"receivers\""},
        {"recording", "recoding", "f:5:19", "Did you mean \"recording\""},
        {"class", "clas", "f:3:18", "unknown key \"clas\" in craft. Did you mean \"class\""},
        {"class: board", "class: plane", "f:3:25", "\"plane\" is not one of land-yacht"},
        {"name: b, ", "", "f:3:8", "craft: the key \"name\" is missing"},
        {"craft: {name: b, class: board}\n", "", "f:1:1", "the key \"craft\" is missing"},
        {"craft: {name: b, class: board}", "craft: board", "f:3:8", "not a map"},
        {"receivers:\n  - {id: primary, recording: r.csv}\n", "", "f:1:1",
         "\"receivers\" is missing"},
        {"receivers:\n  - {id: primary, recording: r.csv}\n", "receivers: []\n", "f:4:12",
         "0 receivers are listed"},
        {"r.csv}\n", "r.csv}\n  - {id: primary, recording: s}\n", "f:6:10",
         "two receivers have the id \"primary\""},
        {"r.csv}\n", "r.csv}\n  - {id: b, recording: s}\n  - {id: c, recording: s}\n", "f:5:3",
         "3 receivers are listed"},
        {"  - {id: primary, recording: r.csv}", "  - ~", "f:5:5", "is empty"},
        {"  - {id: primary, recording: r.csv}", "  id: primary", "f:5:3", "is a map, not list"},
        {"recording: r.csv", "recording: ''", "f:5:30", "is empty"},
        {"id: a\n", "", "f:1:1", "\"id\" is missing"},
        {"id: a\n", "id:\n", "f:1:1", "\"id\" is missing"},
        {"id: a\n", "id: ''\n", "f:2:5", "\"\" cannot be an id"},
        {"id: a\n", "id: a b\n", "f:2:5", "\"a b\" cannot be an id"},
        {"id: a\n", "id: ../a\n", "f:2:5", "cannot be an id"},
        {"id: a\n", "id: ..\n", "f:2:5", "cannot be an id"},
        {"id: a\n", "id: -a\n", "f:2:5", "cannot be an id"},
        {"id: a\n", "id: \"a\\n\"\n", "f:2:5", "\"a\\x0a\" cannot be an id"},
        {"id: a\n", "id: \xc3\xa9t\xc3\xa9\n", "f:2:5", "cannot be an id"},
        {"id: a\n", "id: " + std::string(65, 'x') + "\n", "f:2:5", "cannot be an id"},
        {"id: a\n", "id: [a]\n", "f:2:5", "is a list, not text"},
        {"id: a\n", "id: a\nid: b\n", "f:3:1", "the key \"id\" stands twice"},
        {"id: primary", "id: a/b", "f:5:10", "cannot be an id"},
        {"r.csv}", "r.csv, frame: utm}", "f:5:44", "need their zone and hemisphere"},
        {"r.csv}", "r.csv, frame: {utm: {zone: 55}}}", "f:5:50", "\"hemisphere\" is missing"},
        {"r.csv}", "r.csv, frame: {utm: {zone: 61, hemisphere: south}}}", "f:5:57", "above 60"},
        {"r.csv}", "r.csv, frame: {utm: {zone: 5, hemisphere: s}}}", "f:5:72", "north, south"},
        {"r.csv}", "r.csv, frame: lambert}", "f:5:44", "\"lambert\" is not a frame"},
        {"r.csv}", "r.csv, format: kml}", "f:5:45", "\"kml\" is not one of"},
        {"r.csv}", "r.csv, columns: {east: e}}", "f:5:46", "\"time\" is missing"},
        {"r.csv}", "r.csv, columns: {time: t, estward: e}}", "f:5:56", "Did you mean \"east\""},
        {"r.csv}", "r.csv, start_gps: yesterday}", "f:5:48", "expected 4 digits of the year"},
        {"r.csv}", "r.csv, start_gps: 2022-02-30T00:00:00}", "f:5:48", "the day 30"},
        {"r.csv}", "r.csv, accuracy: {horizontal_m: 0}}", "f:5:62", "is below 0.0001 m"},
        {"r.csv}", "r.csv, accuracy: {}}", "f:5:47", "the accuracy states nothing"},
        {"r.csv}", "r.csv, accuracy: {velocity_mps: 0}}", "f:5:62", "is below 0.001 m / s"},
        {"r.csv}", "r.csv, accuracy: 0.01}", "f:5:47", "not a map"},
        {"r.csv}", "r.csv, height_m: high}", "f:5:47", "\"high\" is not a number"},
        {"r.csv}", "r.csv, height_m: \"12\"}", "f:5:47", "\"12\" is not a number"},
        {"r.csv}", "r.csv, height_m: 1,5}", "f:5:47",
         "\"1,5\" is not a number: it has a decimal comma"},
        {"r.csv}", "r.csv, lever_arm_m: {forward: 0, right: 0}}", "f:5:50", "\"down\" is missing"},
        {"id: a\n", "id: a\ndate: 18 March\n", "f:3:7", "\"18 March\" is not a date"},
        {"id: a\n", "id: a\ndate: 2022-02-30\n", "f:3:7", "is not a date"},
        {"id: a\n", "id: a\ndate: 2022/03/18\n", "f:3:7", "is not a date"},
        {"id: a\n", "id: a\ndate: 2022-3-18\n", "f:3:7", "is not a date"},
        {"id: a\n", "id: a\nofficials: [{name: x}]\n", "f:3:13", "\"role\" is missing"},
        {"id: a\n", "id: a\norigin: {latitude_deg: 91, longitude_deg: 0, height_m: 0}\n", "f:3:24",
         "91 is above 90 deg"},
        {"id: a\n", "id: a\norigin: {latitude_deg: 1, longitude_deg: 0}\n", "f:3:9",
         "\"height_m\" is missing"},
        {"id: a\n", "id: a\nrecord: {speed: 1, unit: km, source: x}\n", "f:3:26",
         "\"km\" is not one of km/h, m/s, kn, mph"},
        {"id: a\n", "id: a\nrecord: {speed: '1', unit: kn, source: x}\n", "f:3:17", "not a number"},
        {"id: a\n", "id: a\nrecord: {speed: 1, unit: kn}\n", "f:3:9", "\"source\" is missing"},
        {"[nalsa]", "[]", "f:6:11", "no profile is named"},
        {"[nalsa]", "nalsa", "f:6:11", "not a list"},
        {"[nalsa]", "[nalsa, nalsa]", "f:6:19", "claimed twice"},
        {"[nalsa]", "[nalsa, rules/nalsa.yaml]", "f:6:19", "claimed twice"},
        {"[nalsa]", "['']", "f:6:12", "\"\" cannot be a profile"},
        {"[nalsa]", "[rules/]", "f:6:12", "cannot be a profile"},
        {"[nalsa]", "[..]", "f:6:12", "cannot be a profile"},
        {"[nalsa]", "[~]", "f:6:12", "is empty"},
        {"[nalsa]", "[nalsa]\nparameters: {smoth: {jerk_density: 1}}", "f:7:14",
         "Did you mean \"smooth\""},
        {"[nalsa]", "[nalsa]\nparameters: {smooth: {jerk_density: 0}}", "f:7:37", "below 0.001"},
        {"[nalsa]", "[nalsa]\nparameters: {screen: {restart_after: 3.5}}", "f:7:38", "whole"},
        {"[nalsa]", "[nalsa]\nparameters: {screen: {allowed_fixes: [best]}}", "f:7:39", "\"best\""},
        {"[nalsa]", "[nalsa]\nparameters: {screen: {allowed_fixes: [~]}}", "f:7:39", "is empty"},
        {"[nalsa]", "[nalsa]\nparameters.smooth: {jerk_density: 1}", "f:7:1", "unknown key"},
        {"schema: attempt/1.0\n", "", "f:1:1", "does not say that it follows attempt/1.0"},
        {"attempt/1.0", "attempt/2.0", "f:1:9", "version \"2.0\" of attempt is not known"},
        {"attempt/1.0", "attempt/1.1", "f:1:9", "version \"1.1\" of attempt is not known"},
        {"attempt/1.0", "attempt/1.01", "f:1:9", "version \"1.01\" of attempt is not known"},
        {"attempt/1.0", "profile/1.0", "f:1:9", "does not say that it follows attempt/1.0"},
        {"attempt/1.0", "{name: attempt}", "f:1:9", "is a map, not text"},
        {"profiles: [nalsa]", "place: \"Nagoya\nprofiles: [nalsa]", "f:6:8", "not closed"},
    };
    ASSERT_NO_THROW(read_attempt(least, "f"));
    test::expect_named(least, cases);
}

TEST(Attempt, WholeFilesThatAreNoAttempt) {
    std::string utf16 = "\xff\xfe";
    for (const char c : least)
        utf16 += {c, '\0'};
    const struct {
        std::string text, where, said;
    } cases[] = {
        {"", "f", "the file is empty"},
        {"# attempt\n", "f", "the file is empty"},
        {utf16, "f", "UTF-16"},
        {"[]\n", "f:1:1", "this is not an attempt"},
        {"hello\n", "f:1:1", "this is not an attempt"},
        {"{}\n", "f:1:1", "does not say that it follows"},
        {"schema: [\n", "f:2:1", "not valid YAML"},
        {least + "---\n" + least, "f:7:1", "more than one"},
    };
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_attempt(c.text, "f"); });
        EXPECT_EQ(said.where, c.where) << c.text;
        EXPECT_TRUE(said.contains(c.said)) << c.text << "\n" << said.problem;
    }
    EXPECT_NO_THROW(read_attempt("\xef\xbb\xbf" + least, "f"));  // as some editors save it
}

TEST(Attempt, ParametersAreTheClassesDefaults) {
    const auto of_class = [](const std::string& name) {
        return read_attempt(replaced(least, "class: board", "class: " + name), "f").parameters;
    };
    EXPECT_EQ(of_class("land-yacht").smooth.jerk_density, 0.6);
    EXPECT_EQ(of_class("ice-yacht").smooth.jerk_density, 0.8);
    EXPECT_EQ(of_class("board").smooth.jerk_density, 2.0);
    EXPECT_EQ(of_class("car").screen.jerk_density, 3.0);
    EXPECT_EQ(of_class("car").screen.allowed_fixes, std::vector<std::string>{"fixed"});
    EXPECT_EQ(of_class("skydiver").screen.allowed_fixes.size(), 6U);
    EXPECT_EQ(of_class("other").screen.restart_after, 3);
    EXPECT_EQ(of_class("other").screen.false_alarm_rate, 1e-6);
    EXPECT_EQ(of_class("other").window.duration_tolerance_s, 0.001);
}

TEST(Attempt, EveryParameterHasADefaultOfItsTypeForEveryClass) {
    const DocumentSchema& schema = attempt_schema();
    for (const std::string& name : schema.find("craft.class")->values) {
        const Attempt attempt =
            read_attempt(replaced(least, "class: board", "class: " + name), "f");
        // As if the attempt had set them all: types, ranges and words hold for defaults too.
        const nlohmann::ordered_json parameters{
            {"parameters", json_from_yaml(attempt.resolved["parameters"])}};
        std::size_t count = 0;
        for (const auto& stage : parameters["parameters"])
            count += stage.size();
        const Attempt again = read_attempt(
            replaced(least, "class: board", "class: " + name) + to_yaml_text(parameters), "f");
        EXPECT_EQ(json_from_yaml(again.resolved["parameters"]), parameters["parameters"]) << name;
        EXPECT_EQ(again.overrides.size(), count);
    }
}

TEST(Attempt, OverridesReplaceDefaultsAndAreListed) {
    const Attempt attempt =
        read_attempt(least +
                         "parameters:\n  smooth: {jerk_density: 1.25}\n"
                         "  screen: {restart_after: 5, allowed_fixes: [fixed], gap_factor: null}\n",
                     "f");
    EXPECT_EQ(attempt.overrides,
              (std::vector<std::string>{"screen.allowed_fixes", "screen.restart_after",
                                        "smooth.jerk_density"}));
    EXPECT_EQ(parameters_of(attempt, "smooth")->at("jerk_density"), 1.25);
    EXPECT_EQ(parameters_of(attempt, "screen")->at("restart_after"), 5);
    EXPECT_EQ(parameters_of(attempt, "screen")->at("allowed_fixes"),
              nlohmann::ordered_json({"fixed"}));
    EXPECT_EQ(parameters_of(attempt, "screen")->at("gap_factor"), 1.5);
    EXPECT_EQ(parameters_of(attempt, "screen")->at("jerk_density"), 2.0);
}

TEST(ProfileName, IsTheFilesNameWithoutFolderAndEnding) {
    EXPECT_EQ(profile_name("nalsa"), "nalsa");
    EXPECT_EQ(profile_name("rules/my-rule.yaml"), "my-rule");
    EXPECT_EQ(profile_name("../a.b.yaml"), "a.b");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
