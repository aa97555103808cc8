#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "schemas/profile/profile.h"
#include "store_test_support.h"

// Figures of a profile that an attempt replaces.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;
using test::replaced;

const std::string timed = R"(schema: profile/1.0
id: my-rule
body: b
title: t
window: {duration_s: 10, definition: displacement}
opposite_runs: {within_s: 3600}
accuracy: {limit: 0.5, unit: kn, coverage_factor: 3}
margin: {kind: absolute, value: 1, unit: mph}
decision: {probability: 0.95}
clauses:
  - {id: c1, text: t, source: s, certainty: quoted, decided_by: window_complete}
  - {id: wind, text: t, source: s, certainty: quoted, decided_by: wind_mean, limit: 20, unit: kn}
  - {id: slope, text: t, source: s, certainty: quoted, decided_by: slope, limit: 2, unit: "%"}
)";

const std::string course = replaced(
    replaced(
        replaced(replaced(timed, "{duration_s: 10, definition: displacement}",
                          "{kind: course, distance_m: 500, definition: elapsed_time}"),
                 "kind: absolute, value: 1, unit: mph", "kind: elapsed_time, value: 0.01, unit: s"),
        "opposite_runs: {within_s: 3600}\n", ""),
    "accuracy: {limit: 0.5, unit: kn, coverage_factor: 3}\n", "");

FigureOverride put(const std::string& figure, double value) {
    return {.profile = "my-rule",
            .figure = figure,
            .used = value,
            .unit = {},
            .reason = "as agreed",
            .place = "attempt.yaml:9:3"};
}

TEST(OverrideFigure, EachIsReplacedAndNotedInTheProfilesUnit) {
    constexpr double knot = 1852.0 / 3600.0;
    const struct {
        std::string text, figure, unit;
        double rule, used;
        double (*value)(const Profile&);
        double expected;  ///< of that value
    } cases[] = {
        {timed, "window.duration_s", "s", 10.0, 5.0, [](const Profile& p) { return p.duration_s; },
         5.0},
        {course, "window.distance_m", "m", 500.0, 250.0,
         [](const Profile& p) { return p.distance_m; }, 250.0},
        {timed, "margin.value", "mph", 1.0, 2.0, [](const Profile& p) { return p.margin; },
         2.0 * 0.44704},
        {course, "margin.value", "s", 0.01, 0.02, [](const Profile& p) { return p.margin; }, 0.02},
        {replaced(timed, "kind: absolute, value: 1, unit: mph", "kind: relative, value: 0.002"),
         "margin.value", "", 0.002, 0.001, [](const Profile& p) { return p.margin; }, 0.001},
        {timed, "accuracy.limit", "kn", 0.5, 1.0,
         [](const Profile& p) { return *p.accuracy_limit_m_s; }, knot},
        {timed, "accuracy.coverage_factor", "", 3.0, 2.0,
         [](const Profile& p) { return p.coverage_factor; }, 2.0},
        {timed, "decision.probability", "", 0.95, 0.99,
         [](const Profile& p) { return p.decision_probability; }, 0.99},
        {timed, "opposite_runs.within_s", "s", 3600.0, 7200.0,
         [](const Profile& p) { return *p.opposite_runs_within_s; }, 7200.0},
        {timed, "clauses.wind.limit", "kn", 20.0, 25.0,
         [](const Profile& p) { return *p.clauses.at(1).limit; }, 25.0},
        {timed, "clauses.slope.limit", "%", 2.0, -0.5,
         [](const Profile& p) { return *p.clauses.at(2).limit; }, -0.5},
    };
    for (const auto& c : cases) {
        SCOPED_TRACE(c.figure);
        Profile profile = read_profile(c.text, "p");
        EXPECT_TRUE(profile.overrides.empty());
        override_figure(profile, put(c.figure, c.used));
        EXPECT_DOUBLE_EQ(c.value(profile), c.expected);
        ASSERT_EQ(profile.overrides.size(), 1U);
        const FigureOverride& noted = profile.overrides[0];
        EXPECT_EQ(noted.figure, c.figure);
        EXPECT_DOUBLE_EQ(noted.rule, c.rule);
        EXPECT_EQ(noted.used, c.used);
        EXPECT_EQ(noted.unit, c.unit);
        EXPECT_EQ(noted.reason, "as agreed");
        EXPECT_EQ(noted.place, "attempt.yaml:9:3");
    }
}

TEST(OverrideFigure, SeveralAreNotedInTheirOrder) {
    Profile profile = read_profile(timed, "p");
    override_figure(profile, put("margin.value", 0.0));
    override_figure(profile, put("window.duration_s", 2.0));
    ASSERT_EQ(profile.overrides.size(), 2U);
    EXPECT_EQ(profile.overrides[0].figure, "margin.value");
    EXPECT_EQ(profile.margin, 0.0);
    EXPECT_EQ(profile.overrides[1].used, 2.0);
}

TEST(OverrideFigure, AnUnknownOneIsRefusedWithThoseThatThereAre) {
    const struct {
        std::string text, figure, known;
    } cases[] = {
        {timed, "window.distance_m",
         "Use one of: window.duration_s, margin.value, accuracy.limit, accuracy.coverage_factor, "
         "decision.probability, opposite_runs.within_s, clauses.wind.limit, clauses.slope.limit"},
        {course, "window.duration_s",
         "Use one of: window.distance_m, margin.value, decision.probability, clauses.wind.limit, "
         "clauses.slope.limit"},
        {course, "accuracy.limit", "Use one of: window.distance_m, "},
        {course, "opposite_runs.within_s", "Use one of: window.distance_m, "},
        {timed, "clauses.c1.limit", "Use one of: window.duration_s, "},
        {timed, "clauses.none.limit", "Use one of: window.duration_s, "},
        {timed, "margin", "Use one of: window.duration_s, "},
        {timed, "", "Use one of: window.duration_s, "},
    };
    for (const auto& c : cases) {
        Profile profile = read_profile(c.text, "p");
        const auto said = failure_of([&] { override_figure(profile, put(c.figure, 1.0)); });
        EXPECT_EQ(said.where, "attempt.yaml:9:3") << c.figure;
        EXPECT_TRUE(
            said.contains("the profile my-rule has no figure \"" + c.figure + "\". " + c.known))
            << said.problem << ". " << said.remedy;
        EXPECT_TRUE(profile.overrides.empty());
    }
}

TEST(OverrideFigure, OneOutOfRangeIsRefusedAndTheEndsAreAllowed) {
    const struct {
        std::string text, figure;
        double low, high;  ///< allowed
        std::string remedy;
    } ranges[] = {
        {timed, "window.duration_s", 0.1, 3600.0, "Give a figure from 0.1 to 3600"},
        {course, "window.distance_m", 1.0, 1e6, "Give a figure from 1 to 1e+06"},
        {timed, "margin.value", 0.0, 1e9, "Give a figure from 0 to 1e+09"},
        {timed, "accuracy.limit", 0.0, 1e9, "Give a figure from 0 to 1e+09"},
        {timed, "accuracy.coverage_factor", 1.0, 4.0, "Give a figure from 1 to 4"},
        {timed, "decision.probability", 0.51, 0.9999, "Give a figure from 0.51 to 0.9999"},
        {timed, "opposite_runs.within_s", 1.0, 1e6, "Give a figure from 1 to 1e+06"},
    };
    for (const auto& range : ranges) {
        SCOPED_TRACE(range.figure);
        Profile profile = read_profile(range.text, "p");
        EXPECT_NO_THROW(override_figure(profile, put(range.figure, range.low)));
        EXPECT_NO_THROW(override_figure(profile, put(range.figure, range.high)));
        EXPECT_EQ(profile.overrides.size(), 2U);
        const double step = 1e-6 * (range.high - range.low);
        for (const double beyond :
             {range.low - step, range.high + step, std::numeric_limits<double>::quiet_NaN(),
              std::numeric_limits<double>::infinity()}) {
            const auto said =
                failure_of([&] { override_figure(profile, put(range.figure, beyond)); });
            EXPECT_EQ(said.where, "attempt.yaml:9:3") << beyond;
            EXPECT_EQ(said.remedy, range.remedy) << beyond;
            EXPECT_TRUE(said.contains(range.figure + " cannot be ")) << said.problem;
        }
        EXPECT_EQ(profile.overrides.size(), 2U);
    }
}

TEST(WindowWords, SayOverWhatTheSpeedIs) {
    EXPECT_EQ(window_words(read_profile(timed, "p")), "10 s");
    EXPECT_EQ(window_words(read_profile(course, "p")), "a course of 500 m");
    const auto words = [](const char* name) {
        return window_words(read_profile(builtin_profile(name), name));
    };
    EXPECT_EQ(words("gps-speed-sailing-nautical-mile"), "1852 m");
    EXPECT_EQ(words("gps-speed-sailing-alpha-500"), "an alpha of 500 m");
    EXPECT_EQ(words("gps-speed-sailing-1h"), "3600 s");
}

TEST(RuleUnit, IsThatOfTheResultElseOfTheRoundingElseOfTheLimit) {
    EXPECT_EQ(rule_unit_name(read_profile(timed, "p")), "kn");
    EXPECT_EQ(rule_unit_name(read_profile(course, "p")), "km/h");
    const std::string rounded = replaced(
        timed, "clauses:\n", "rounding: {mode: nearest, unit: m/s, decimals: 2}\nclauses:\n");
    EXPECT_EQ(rule_unit_name(read_profile(rounded, "p")), "m/s");
    const std::string with_result = replaced(
        rounded, "clauses:\n", "result: {mode: nearest, unit: mph, decimals: 1}\nclauses:\n");
    EXPECT_EQ(rule_unit_name(read_profile(with_result, "p")), "mph");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
