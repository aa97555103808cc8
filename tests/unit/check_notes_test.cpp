#include <gtest/gtest.h>

#include <algorithm>

#include "check_rules_support.h"
#include "stages/check/notes.h"

// What must be read with a verdict, and figures as people are to read them.

namespace runcert::RUNCERT_FILE {
namespace {

using test::clause_text, test::contains, test::profile_text, test::RuleScene;

constexpr double kmh = 1.0 / 3.6;

std::string note_with(const ProfileVerdict& verdict, const std::string& part) {
    for (const std::string& note : verdict.notes)
        if (contains(note, part)) return note;
    return {};
}

std::string margin_profile(
    const std::string& more = {},
    const std::string& window = "{duration_s: 3, definition: displacement}") {
    return profile_text(clause_text("margin"), more, "{kind: absolute, value: 1, unit: km/h}",
                        window);
}

void set_definitions(RuleScene& scene, const SpeedDefinitions& definitions) {
    scene.best().definitions = definitions;
    scene.best().speed_m_s = speed_by(definitions, scene.profiles[0].definition);
}

const SpeedDefinitions straddling{.displacement_m_s = 203.89 * kmh,
                                  .path_length_m_s = 203.95 * kmh,
                                  .mean_n_plus_1_m_s = 203.88 * kmh,
                                  .mean_n_m_s = 203.91 * kmh};

TEST(Straddle, IsSaidWithEveryDefinitionOnItsSide) {
    RuleScene scene(margin_profile());  // 203.9 km/h to reach
    set_definitions(scene, straddling);
    EXPECT_EQ(
        note_with(scene.verdict(), "definition of speed"),
        "The definition of speed matters here: path length over time (203.950 km/h), the mean "
        "without the first speed (203.910 km/h) would reach the required 203.900 km/h, "
        "displacement over time (203.890 km/h), the mean of all speeds (203.880 km/h) would "
        "not. The rule counts displacement over time.");
    scene.use(margin_profile({}, "{duration_s: 3, definition: mean_n}"));
    set_definitions(scene, straddling);
    EXPECT_TRUE(contains(note_with(scene.verdict(), "definition of speed"),
                         "The rule counts the mean without the first speed"));
}

TEST(Straddle, IsNotSaidWhereAllAreOnOneSideOrNoneIsTheRules) {
    RuleScene scene(margin_profile());
    EXPECT_EQ(note_with(scene.verdict(), "definition of speed"), "");
    SpeedDefinitions above = straddling;
    above.displacement_m_s = above.mean_n_plus_1_m_s = 203.9000001 * kmh;
    set_definitions(scene, above);
    EXPECT_EQ(note_with(scene.verdict(), "definition of speed"), "");
    set_definitions(scene, straddling);
    scene.attempt.record.reset();
    EXPECT_EQ(note_with(scene.verdict(), "definition of speed"), "");
    RuleScene velocities(
        margin_profile({}, "{duration_s: 3, definition: mean_n, source: velocity}"));
    set_definitions(velocities, straddling);
    EXPECT_EQ(note_with(velocities.verdict(), "definition of speed"), "");
    RuleScene course(
        margin_profile({}, "{kind: course, distance_m: 500, definition: elapsed_time}"));
    course.best().definitions = straddling;
    EXPECT_EQ(note_with(course.verdict(), "definition of speed"), "");
}

TEST(MeanOfSamples, NamesTheMeasurandWhereItIsNotTheMeanOverTime) {
    RuleScene scene(margin_profile({}, "{duration_s: 3, definition: mean_n}"));
    SpeedDefinitions definitions{.displacement_m_s = 204.0 * kmh,
                                 .path_length_m_s = 204.0 * kmh,
                                 .mean_n_plus_1_m_s = 204.0 * kmh,
                                 .mean_n_m_s = 204.4 * kmh};
    set_definitions(scene, definitions);
    EXPECT_EQ(note_with(scene.verdict(), "not the mean over time"),
              "The rule counts the mean of the 30 speeds at its epochs, not the mean over time. "
              "The smoothed track gives 204.400 km/h by such samples and 204.000 km/h over time "
              "(-0.400 km/h).");
    scene.use(margin_profile({}, "{duration_s: 3, definition: mean_n, source: velocity}"));
    set_definitions(scene, definitions);
    EXPECT_TRUE(contains(note_with(scene.verdict(), "not the mean over time"),
                         "the mean of the 30 recorded speeds"));
    // Below a tenth of U, 0.036 km/h.
    definitions.mean_n_m_s = 204.003 * kmh;
    set_definitions(scene, definitions);
    EXPECT_EQ(note_with(scene.verdict(), "not the mean over time"), "");
    scene.use(margin_profile());
    definitions.mean_n_m_s = 204.4 * kmh;
    set_definitions(scene, definitions);
    EXPECT_EQ(note_with(scene.verdict(), "not the mean over time"), "");
}

TEST(Overrides, ArePrintedWithTheRulesOwnFigureAndTheReason) {
    RuleScene scene(
        profile_text(clause_text("flatness", ", limit: 1, unit: m") + clause_text("margin"),
                     "accuracy: {limit: 0.8, unit: km/h, coverage_factor: 2}\n"));
    Profile& profile = scene.profiles[0];
    override_figure(profile, {.profile = "rule",
                              .figure = "clauses.flatness.limit",
                              .rule = 0.0,
                              .used = 0.5,
                              .unit = {},
                              .reason = "a stricter board",
                              .place = "attempt:9:3"});
    override_figure(profile, {.profile = "rule",
                              .figure = "margin.value",
                              .rule = 0.0,
                              .used = 2.5,
                              .unit = {},
                              .reason = {},
                              .place = "attempt:10:3"});
    override_figure(profile, {.profile = "rule",
                              .figure = "decision.probability",
                              .rule = 0.0,
                              .used = 0.99,
                              .unit = {},
                              .reason = "x",
                              .place = "attempt:11:3"});
    scene.row(33.0).up_m = 0.7;  // within the rule's own limit, not within the other
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_NEAR(*verdict.required_speed_m_s, (202.9 + 2.5) * kmh, 1e-12);
    EXPECT_EQ(verdict.decision->level, 0.99);
    EXPECT_EQ(note_with(verdict, "flatness"),
              "The attempt replaces a figure of the rule: clauses.flatness.limit is 0.5 m, not 1 m "
              "(a stricter board).");
    EXPECT_EQ(note_with(verdict, "margin.value"),
              "The attempt replaces a figure of the rule: margin.value is 2.5 km/h, not 1 km/h (no "
              "reason is given).");
    EXPECT_EQ(note_with(verdict, "decision.probability"),
              "The attempt replaces a figure of the rule: decision.probability is 0.99, not 0.975 "
              "(x).");
    ASSERT_EQ(verdict.overrides.size(), 3U);
    EXPECT_EQ(verdict.overrides[1].unit, "km/h");
    EXPECT_NEAR(verdict.overrides[1].rule, 1.0, 1e-12);
    EXPECT_NEAR(verdict.overrides[1].used, 2.5, 1e-12);
}

TEST(Unconfirmed, ClausesAreNamed) {
    const RuleScene scene(profile_text(clause_text("margin") +
                                       "  - {id: rounding, text: Nobody knows., source: not found, "
                                       "certainty: unconfirmed, decided_by: attest}\n"));
    EXPECT_EQ(note_with(scene.verdict(), "Not confirmed"),
              "Not confirmed: rounding: Nobody knows.");
    EXPECT_EQ(scene.clause("rounding").status, RequirementStatus::attest);
    EXPECT_EQ(scene.verdict().outcome, Outcome::beaten);
}

/// Two windows more, and the rule takes the mean of three.
RuleScene three_windows() {
    RuleScene scene(profile_text(clause_text("window_complete") + clause_text("margin"), {},
                                 "{kind: absolute, value: 1, unit: km/h}",
                                 "{duration_s: 3, definition: mean_n, count: 3}"));
    for (const auto& [speed, u] : {std::pair{58.0, 0.020}, {56.0, 0.011}})
        scene.windows().further.push_back({.span = scene.best().span,
                                           .arc = 1,
                                           .speed_m_s = speed,
                                           .standard_uncertainty_m_s = u});
    return scene;
}

TEST(SeveralWindows, HaveTheirMeanAndAreNoSurerThanOne) {
    RuleScene scene = three_windows();
    scene.windows().indicated =
        IndicatedWindow{.span = {}, .speed_m_s = 60.0, .mean_m_s = 58.5, .refusals = {}};
    const std::optional<RuleFigure> figure = figure_of(scene.windows());
    ASSERT_TRUE(figure.has_value());
    EXPECT_NEAR(figure->speed_m_s, 58.0, 1e-12);
    // Fully correlated: the mean of 5, 20 and 11 mm/s.
    EXPECT_NEAR(figure->standard_uncertainty_m_s, 0.012, 1e-12);
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_NEAR(*verdict.speed_m_s, 58.0, 1e-12);
    EXPECT_NEAR(*verdict.expanded_uncertainty_m_s, 0.024, 1e-12);
    EXPECT_EQ(
        note_with(verdict, "mean of 3"),
        "The speed is the mean of 3 windows (216.000 km/h, 208.800 km/h, 201.600 km/h); their "
        "errors are taken as equal, so averaging does not reduce the uncertainty.");
    EXPECT_TRUE(contains(note_with(verdict, "unscreened"), "a mean of 210.600 km/h"));
    EXPECT_TRUE(contains(scene.clause("window_complete").evidence, "with 2 more the mean"));
}

TEST(SeveralWindows, OfWhichTooFewAreCertifiableAreNone) {
    RuleScene scene = three_windows();
    scene.windows().further.pop_back();
    EXPECT_FALSE(figure_of(scene.windows()).has_value());
    const ProfileVerdict verdict = scene.verdict();
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(verdict.speed_m_s || verdict.shown);
    EXPECT_TRUE(contains(scene.clause("window_complete").evidence,
                         "of 3 windows of 3 s that the rule takes the mean of, 2 are certifiable"))
        << scene.clause("window_complete").evidence;
}

TEST(Shown, FiguresAreRoundedToTheSafeSideInTheRulesUnit) {
    const char* const to_hundredths = "result: {mode: nearest, unit: km/h, decimals: 2}\n";
    RuleScene scene(margin_profile(to_hundredths));
    scene.best().speed_m_s = 222.8799 * kmh;
    scene.best().standard_uncertainty_m_s = 0.0051 * kmh;
    scene.attempt.record->speed = 221.8701;
    const ShownFigures shown = *scene.verdict().shown;
    EXPECT_EQ(shown.unit, "km/h");
    EXPECT_EQ(shown.speed, "222.87");
    EXPECT_EQ(shown.expanded_uncertainty, "0.02");
    EXPECT_EQ(shown.required_speed, "222.88");
    // An uncertainty of 0.34 km/h justifies two decimals, one of 3.4 km/h one.
    scene.best().standard_uncertainty_m_s = 1.7 * kmh;
    EXPECT_EQ(scene.verdict().shown->speed, "222.8");
    EXPECT_EQ(scene.verdict().shown->expanded_uncertainty, "3.4");
    EXPECT_EQ(scene.verdict().shown->required_speed, "222.9");
    scene.attempt.record.reset();
    EXPECT_EQ(scene.verdict().shown->required_speed, "");
}

TEST(Shown, UnitIsThatOfTheResultElseOfTheRoundingElseOfTheAccuracyLimit) {
    const auto unit = [](const std::string& more) {
        return RuleScene(margin_profile(more)).verdict().shown->unit;
    };
    EXPECT_EQ(unit("result: {mode: nearest, unit: kn, decimals: 2}\n"
                   "rounding: {mode: nearest, unit: mph, decimals: 2}\n"),
              "kn");
    EXPECT_EQ(unit("rounding: {mode: nearest, unit: mph, decimals: 2}\n"), "mph");
    EXPECT_EQ(unit("accuracy: {limit: 1, unit: m/s, coverage_factor: 2}\n"), "m/s");
    EXPECT_EQ(unit(""), "km/h");
    // In knots: 60 m/s is 116.630669 kn.
    const RuleScene scene(margin_profile("result: {mode: nearest, unit: kn, decimals: 2}\n"));
    EXPECT_EQ(scene.verdict().shown->speed, "116.63");
}

TEST(ComparedRules, SetTheSpeedsBesideOneAnother) {
    RuleScene scene(margin_profile());
    EXPECT_FALSE(std::ranges::any_of(scene.all().statements, [](const std::string& one) {
        return contains(one, "The rules do not measure the same");
    }));
    Profile other = scene.profiles[0];
    other.id = "other";
    other.duration_s = 2.0;
    other.windows = 5;
    other.definition = SpeedDefinition::mean_n;
    other.speed_source = SpeedSource::velocity;
    Profile third = scene.profiles[0];
    third.id = "third";
    third.dimension = Dimension::vertical;
    third.definition = SpeedDefinition::path_length;
    scene.profiles = {scene.profiles[0], other, third};
    const auto verdict = [](double speed_m_s) {
        ProfileVerdict result;
        result.speed_m_s = speed_m_s;
        return result;
    };
    const std::vector<ProfileVerdict> verdicts{verdict(60.0), verdict(61.0), verdict(20.0)};
    EXPECT_EQ(compared_rules(scene.profiles, verdicts),
              "The rules do not measure the same: rule 216.00 km/h (3 s, displacement over time); "
              "other 219.60 km/h (5 x 2 s, recorded velocities); third 72.00 km/h (3 s, vertical, "
              "path length over time).");
    // A profile without a speed is not among them; of one alone there is nothing to say.
    std::vector<ProfileVerdict> one = verdicts;
    one[1].speed_m_s.reset();
    EXPECT_FALSE(contains(compared_rules(scene.profiles, one), "other"));
    one[2].speed_m_s.reset();
    EXPECT_EQ(compared_rules(scene.profiles, one), "");
}

TEST(CourseFigures, OfCourseAndWindAreInTheVerdict) {
    RuleScene scene(margin_profile());
    scene.wind = test::steady(5.0, 90.0, 0.0, 50.0);
    const ProfileVerdict verdict = scene.verdict();
    const auto value = [&](const std::string& name) {
        for (const Figure& figure : verdict.course)
            if (figure.name == name) return figure.value;
        return std::nan("");
    };
    EXPECT_NEAR(value("heading"), 0.0, 1e-9);
    EXPECT_NEAR(value("time of the run-up"), 19.8, 1e-9);
    EXPECT_NEAR(value("mean wind"), 5.0, 1e-12);
    EXPECT_NEAR(value("wind direction, where it comes from"), 90.0, 1e-9);
    EXPECT_NEAR(value("wind along the heading"), 0.0, 1e-9);
    // From the right, so that it moves to the left.
    EXPECT_NEAR(value("wind across the heading, to the right"), -5.0, 1e-9);
    ASSERT_EQ(verdict.runs.size(), 1U);
    EXPECT_EQ(verdict.runs[0].began, RunEdge::standing);
    EXPECT_EQ(verdict.runs[0].ended, RunEdge::recording);
    EXPECT_NEAR(verdict.runs[0].length_m, 450.0 - 0.08 + 1200.0, 1e-9);
    EXPECT_NEAR(verdict.runs[0].top_speed_m_s, 60.0, 1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
