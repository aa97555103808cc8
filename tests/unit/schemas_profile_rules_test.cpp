#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/failure.h"
#include "schemas/profile/profile.h"
#include "store_test_support.h"

// Kinds of window, and computations that decide a clause.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

/// A rule over a stretch, with all that can stand beside it.
const std::string complete = R"(schema: profile/1.0
id: my-rule
body: Some Body
title: top speed
window: {kind: time, duration_s: 10, definition: displacement}
margin: {kind: absolute, value: 1, unit: mph}
clauses:
  - {id: c1, text: t, source: s, certainty: quoted, decided_by: attest}
)";

TEST(ProfileWindow, EveryMemberIsRead) {
    const Profile stretch = read_profile(
        replaced(replaced(complete, "definition: displacement",
                          "definition: displacement, dimension: vertical, exact: true, count: 5, "
                          "ends: epochs, source: position"),
                 "margin:",
                 "runs: {start_m_s: 4, stop_m_s: 3, stop_s: 2, turn_deg: 45}\n"
                 "decision: {probability: 0.9}\ncurrent: ignored\n"
                 "result: {mode: nearest, unit: kn, decimals: 1}\nmargin:"),
        "p");
    EXPECT_EQ(stretch.dimension, Dimension::vertical);
    EXPECT_TRUE(stretch.exact_duration);
    EXPECT_EQ(stretch.windows, 5);
    EXPECT_EQ(stretch.ends, WindowEnds::epochs);
    EXPECT_EQ(stretch.runs.start_m_s, 4.0);
    EXPECT_EQ(stretch.runs.stop_m_s, 3.0);
    EXPECT_EQ(stretch.runs.stop_s, 2.0);
    EXPECT_EQ(stretch.runs.turn_deg, 45.0);
    EXPECT_EQ(stretch.decision_probability, 0.9);
    EXPECT_EQ(stretch.current, CurrentUse::ignored);
    EXPECT_EQ(stretch.result->unit, "kn");
    EXPECT_EQ(stretch.result->decimals, 1);
    const Profile alpha =
        read_profile(replaced(complete, "kind: time, duration_s: 10, definition: displacement",
                              "kind: alpha, distance_m: 250, proximity_m: 25, turn_deg: 120, "
                              "definition: path_length, source: velocity"),
                     "p");
    EXPECT_EQ(alpha.window_kind, WindowKind::alpha);
    EXPECT_EQ(alpha.distance_m, 250.0);
    EXPECT_EQ(alpha.duration_s, 0.0);
    EXPECT_EQ(alpha.proximity_m, 25.0);
    EXPECT_EQ(alpha.turn_deg, 120.0);
    EXPECT_EQ(alpha.speed_source, SpeedSource::velocity);
    const Profile pair =
        read_profile(replaced(replaced(complete, "displacement}", "path_length, ends: any}"),
                              "margin:", "opposite_runs: {within_s: 1800}\nmargin:"),
                     "p");
    EXPECT_EQ(pair.ends, WindowEnds::any);
    EXPECT_EQ(pair.opposite_runs_within_s, 1800.0);
}

TEST(ProfileWindow, WhatIsLeftOutHasItsDefault) {
    for (const std::string& text : {complete, replaced(complete, "kind: time, ", "")}) {
        const Profile profile = read_profile(text, "p");
        EXPECT_EQ(profile.window_kind, WindowKind::time);
        EXPECT_EQ(profile.dimension, Dimension::horizontal);
        EXPECT_EQ(profile.speed_source, SpeedSource::position);
        EXPECT_EQ(profile.ends, WindowEnds::epochs);
        EXPECT_FALSE(profile.exact_duration);
        EXPECT_EQ(profile.windows, 1);
        EXPECT_EQ(profile.runs.start_m_s, 2.0);
        EXPECT_EQ(profile.runs.stop_m_s, 1.0);
        EXPECT_EQ(profile.runs.stop_s, 5.0);
        EXPECT_EQ(profile.runs.turn_deg, 90.0);
        EXPECT_FALSE(profile.opposite_runs_within_s || profile.result);
        EXPECT_EQ(profile.margin_above, MarginBase::value);
        EXPECT_EQ(profile.current, CurrentUse::ignored);
        EXPECT_EQ(profile.decision_probability, 0.975);
    }
}

TEST(ProfileWindow, WhatNoComputationExistsForIsRefusedWithItsPlace) {
    const std::string window = "{kind: time, duration_s: 10, definition: displacement}";
    const struct {
        std::string window, where, said;
    } cases[] = {
        {"{kind: time, definition: displacement}", "p:5:16",
         "kind: time needs duration_s. Add duration_s:"},
        {"{kind: distance, definition: path_length}", "p:5:16",
         "kind: distance needs distance_m. Add distance_m:"},
        {"{kind: alpha, duration_s: 10, definition: path_length}", "p:5:16",
         "kind: alpha needs distance_m. Add distance_m:"},
        {"{kind: course, distance_m: 500, duration_s: 10, definition: elapsed_time}", "p:5:53",
         "kind: course goes without duration_s. Remove duration_s"},
        {"{kind: time, duration_s: 10, distance_m: 5, definition: displacement}", "p:5:50",
         "kind: time goes without distance_m. Remove distance_m"},
        {"{kind: course, distance_m: 500, definition: displacement}", "p:5:16",
         "over a course the speed is its length over the elapsed time. Write definition: "
         "elapsed_time"},
        {"{duration_s: 10, definition: elapsed_time}", "p:5:38",
         "elapsed_time is the speed over a course. Give kind: course, or another definition"},
        {"{kind: course, distance_m: 500, definition: elapsed_time, dimension: space}", "p:5:16",
         "the lines of a course are crossed horizontally, by positions"},
        {"{kind: course, distance_m: 500, definition: elapsed_time, source: velocity}", "p:5:16",
         "Leave out dimension and source"},
        {"{duration_s: 10, definition: mean_n, source: velocity, ends: any}", "p:5:54",
         "recorded velocities are known at the measured epochs only"},
        {"{duration_s: 10, definition: displacement, source: velocity}", "p:5:60",
         "Use definition: mean_n_plus_1, mean_n or path_length, and ends: epochs"},
        {"{duration_s: 10, definition: mean_n_plus_1, ends: any}", "p:5:59",
         "a mean of the speeds of epochs begins and ends at epochs. Use ends: epochs"},
        {"{duration_s: 10, definition: mean_n, dimension: space}", "p:5:57",
         "speed in space is computed by displacement over time only. Write definition: "
         "displacement"},
        {"{duration_s: 10, definition: path_length, dimension: space}", "p:5:62",
         "speed in space is computed by displacement over time only"},
        {"{kind: alpha, distance_m: 500, definition: displacement, dimension: space}", "p:5:16",
         "an alpha is a horizontal path between measured epochs. Use definition: path_length"},
        {"{kind: alpha, distance_m: 500, definition: path_length, dimension: vertical}", "p:5:16",
         "an alpha is a horizontal path"},
        {"{kind: alpha, distance_m: 500, definition: path_length, ends: any}", "p:5:16",
         "an alpha is a horizontal path"},
        {"{kind: distance, distance_m: 500, definition: mean_n}", "p:5:16",
         "a distance is reached along the path, or by the straight line between measured epochs"},
        {"{kind: distance, distance_m: 500, definition: displacement, ends: any}", "p:5:16",
         "Use definition: path_length, or displacement with ends: epochs"},
        {"{kind: distance, distance_m: 500, definition: path_length, exact: true}", "p:5:75",
         "only windows of kind time between measured epochs can be exact. Remove it"},
        {"{duration_s: 10, definition: displacement, ends: any, exact: true}", "p:5:70",
         "can be exact. Remove it"},
        {"{kind: lap, duration_s: 10, definition: displacement}", "p:5:16",
         "\"lap\" is not one of time, distance, course, alpha"},
        {"{duration_s: 10, definition: displacement, count: 0}", "p:5:59", "0 is below 1"},
        {"{kind: distance, distance_m: 0.5, definition: path_length}", "p:5:38",
         "0.5 is below 1 m"},
    };
    for (const auto& c : cases) {
        const auto said =
            failure_of([&] { read_profile(replaced(complete, window, c.window), "p"); });
        EXPECT_EQ(said.where, c.where) << c.window << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.window << "\n" << said.problem << said.remedy;
    }
}

TEST(ProfileRule, BadInputIsNamedWithItsPlaceAndRemedy) {
    const struct {
        std::string from, to, where, said;
    } cases[] = {
        {"attest", "dice", "p:8:65", "\"dice\" is not one of window_complete, accuracy, margin"},
        {", unit: mph", "", "p:6:16",
         "kind: absolute needs unit: km/h or m/s or kn or mph. Write unit: km/h or m/s"},
        {"kind: absolute, value: 1, unit: mph", "kind: elapsed_time, value: 1", "p:6:16",
         "kind: elapsed_time needs unit: s. Write unit: s"},
        {"kind: absolute, value: 1, unit: mph", "kind: elapsed_time, value: 1, unit: s", "p:6:16",
         "a margin of time belongs to a course. Use absolute or relative"},
        {"kind: absolute, value: 1, unit: mph", "kind: elapsed_time, value: 1, unit: kn", "p:6:16",
         "kind: elapsed_time needs unit: s. Write unit: s"},
        {"unit: mph", "unit: s", "p:6:16",
         "kind: absolute needs unit: km/h or m/s or kn or mph. Write unit: km/h or m/s"},
        {"kind: absolute", "kind: relative", "p:6:42",
         "kind: relative goes without unit. Remove unit"},
        {"unit: mph", "unit: mph, above: limit", "p:6:54",
         "\"limit\" is not one of value, upper_limit"},
        {"attest", "flatness", "p:8:65",
         "flatness needs a figure to compare with. Add limit: and unit: (m)"},
        {"attest", "wind_gust, unit: kn", "p:8:65",
         "wind_gust needs a figure to compare with. Add limit: and unit: (m/s, km/h, kn, mph)"},
        {"attest", "flatness, limit: 1", "p:8:82", "the limit has no unit. Give unit: m"},
        {"attest", "flatness, limit: 1, unit: Hz", "p:8:91",
         "flatness is not compared in \"Hz\". Give unit: m"},
        {"attest", "flatness, limit: 1, unit: ft", "p:8:91",
         "\"ft\" is not one of m, deg, Hz, %, km/h, m/s, kn, mph"},
        {"attest", "attest, limit: 1, unit: m", "p:8:80",
         "attest compares with no limit. Remove it"},
        {"attest", "margin, unit: m", "p:8:79", "margin compares with no limit. Remove it"},
        {"attest", "opposite_runs", "p:8:65",
         "the profile does not ask for two runs. Add opposite_runs: {within_s}"},
        {"attest", "accuracy", "p:8:65",
         "the profile states no limit of accuracy. Add accuracy: {limit, unit, coverage_factor}"},
        {"decided_by: attest}",
         "decided_by: attest}\n  - {id: c1, text: t, source: s, certainty: quoted, decided_by: "
         "attest}",
         "p:9:10", "two clauses have the id \"c1\". Give each an id of its own"},
        {"displacement}", "displacement, count: 2}\nopposite_runs: {within_s: 60}", "p:6:16",
         "the mean of two runs has one window of each. Leave out window.count"},
        {"title: top speed", "title: top speed\nopposite_runs: {}", "p:5:16",
         "\"within_s\" is missing"},
        {"title: top speed", "title: top speed\nruns: {start_m_s: 1, stop_m_s: 2}", "p:5:19",
         "start_m_s is 1 m / s, which is not above stop_m_s, 2 m / s. Give start_m_s above "
         "stop_m_s"},
        {"title: top speed", "title: top speed\nruns: {start_m_s: 1}", "p:5:19",
         "start_m_s is 1 m / s, which is not above stop_m_s, 1 m / s"},
        {"title: top speed", "title: top speed\nruns: {stop_m_s: 2}", "p:5:18",
         "start_m_s is 2 m / s, which is not above stop_m_s, 2 m / s"},
        {"title: top speed", "title: top speed\ndecision: {probability: 0.5}", "p:5:25",
         "0.5 is below 0.51"},
        {"title: top speed", "title: top speed\ncurrent: subtracted\nopposite_runs: {within_s: 60}",
         "p:6:16", "the current is known along one window"},
        {"displacement}", "mean_n, source: velocity}\nspeed_of: reference_point", "p:6:11",
         "recorded velocities are those of the antenna"},
        {"title: top speed", "title: top speed\ncurrent: added", "p:5:10",
         "\"added\" is not one of ignored, subtracted"},
        {"title: top speed", "title: top speed\nresult: {mode: nearest, unit: kn}", "p:5:9",
         "\"decimals\" is missing"},
    };
    ASSERT_NO_THROW(read_profile(complete, "p"));
    for (const auto& c : cases) {
        const auto said = failure_of([&] { read_profile(replaced(complete, c.from, c.to), "p"); });
        EXPECT_EQ(said.where, c.where) << c.to << "\n" << said.problem;
        EXPECT_TRUE(said.contains(c.said)) << c.to << "\n" << said.problem << said.remedy;
    }
}

TEST(ProfileRule, EveryComputationHasItsLimitInItsUnitsOrNone) {
    const struct {
        std::string computation;
        std::vector<std::string> units;
    } cases[] = {{"flatness", {"m"}},
                 {"slope", {"\"%\""}},
                 {"straightness", {"m"}},
                 {"turning", {"deg"}},
                 {"run_up", {"m"}},
                 {"wind_mean", {"m/s", "km/h", "kn", "mph"}},
                 {"wind_gust", {"m/s", "km/h", "kn", "mph"}},
                 {"current", {"m/s", "km/h", "kn", "mph"}},
                 {"sampling_rate", {"Hz"}},
                 {"sample_accuracy", {"m/s", "km/h", "kn", "mph"}},
                 {"acceleration", {"m/s2"}},
                 {"satellites", {"satellites"}},
                 {"least_speed", {"m/s", "km/h", "kn", "mph"}}};
    for (const auto& c : cases)
        for (const std::string unit :
             {"m", "deg", "Hz", "\"%\"", "km/h", "m/s", "kn", "mph", "m/s2", "satellites"}) {
            const std::string text =
                replaced(complete, "attest", c.computation + ", limit: 1.5, unit: " + unit);
            if (std::ranges::find(c.units, unit) == c.units.end()) {
                EXPECT_TRUE(failure_of([&] {
                                read_profile(text, "p");
                            }).contains(c.computation + " is not compared in \""))
                    << text;
            } else {
                EXPECT_EQ(read_profile(text, "p").clauses.at(0).limit, 1.5) << text;
            }
        }
    for (const char* none : {"window_complete", "margin", "georeferenced", "secondary_method",
                             "standing_start", "device_deduction", "sail_area", "attest"}) {
        EXPECT_NO_THROW(read_profile(replaced(complete, "attest", none), "p"));
        EXPECT_TRUE(failure_of([&] {
                        read_profile(replaced(complete, "attest", std::string(none) + ", limit: 1"),
                                     "p");
                    }).contains(std::string(none) + " compares with no limit. Remove it"));
    }
}

TEST(ProfileRule, OfEvidenceHasNoMeasureAndEveryOtherHasOne) {
    const std::string evidence =
        "schema: profile/1.0\nid: e\nbody: b\ntitle: t\nevidence: true\nclauses:\n"
        "  - {id: film, text: It was filmed., source: s, certainty: secondary, decided_by: "
        "attest}\n";
    EXPECT_TRUE(read_profile(evidence, "p").evidence);
    const auto says = [&](const std::string& from, const std::string& to, const char* what) {
        const auto said = failure_of([&] { read_profile(replaced(evidence, from, to), "p"); });
        EXPECT_TRUE(said.contains(what)) << to << "\n" << said.problem;
    };
    says("evidence: true\n", "", "\"window\" is missing");
    says("evidence: true\n", "window: {duration_s: 3, definition: displacement}\n",
         "\"margin\" is missing");
    says("title: t\n", "title: t\nmargin: {kind: relative, value: 0}\n",
         "a rule of evidence measures nothing. Remove it");
    says("decided_by: attest", "decided_by: margin", "measures nothing that could decide it");
    says("decided_by: attest}\n",
         "decided_by: attest}\nquestions:\n  - {id: film, text: \"Must it?\", source: s}\n",
         "two clauses or questions have the id \"film\"");
}

TEST(ProfileRule, SaysWhoAnswersForAClause) {
    const auto answerer = [](const std::string& more) {
        return read_profile(replaced(complete, "attest", "attest" + more), "p")
            .clauses.at(0)
            .answered_by;
    };
    EXPECT_EQ(answerer(", answered_by: {role: board, count: 3}"), (Answerer{"board", 3}));
    EXPECT_EQ(answerer(", answered_by: {role: board}"), (Answerer{"board", 1}));
    // Omitted fields take the schema's defaults, as does a report without the field.
    EXPECT_EQ(answerer(", answered_by: {count: 2}"), (Answerer{"judge", 2}));
    EXPECT_EQ(answerer(""), Answerer());
    EXPECT_EQ(Answerer(), (Answerer{"judge", 1}));
    EXPECT_TRUE(failure_of([&] {
                    answerer(", answered_by: {role: chief judge}");
                }).contains("a role is letters, digits"));
    for (const char* wrong :
         {"{role: judge, count: 0}", "{role: judge, count: 21}", "{role: judge, who: me}", "judge"})
        EXPECT_THROW(answerer(std::string(", answered_by: ") + wrong), Failure) << wrong;
}

TEST(ProfileRule, FieldsThatSayWhatHoldsAnyway) {
    for (const auto& [from, to] :
         {std::pair{"title", "runs: {}\ntitle"},
          {"unit: mph}", "unit: mph, above: value}"},
          {"definition: displacement", "definition: displacement, count: 1"},
          {"title", "current: ignored\ntitle"}}) {
        const std::string text = replaced(replaced(complete, "kind: time, ", ""), from, to);
        EXPECT_NO_THROW(read_profile(text, "p")) << to;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
