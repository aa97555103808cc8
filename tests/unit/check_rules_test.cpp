#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "check_rules_support.h"
#include "core/uncertainty.h"
#include "schemas/verdict/figures.h"

// Every computation that a clause may name, on both sides of its limit and where data are missing.

namespace runcert::RUNCERT_FILE {
namespace {

using test::clause_text, test::contains, test::profile_text, test::RuleScene, test::steady;

constexpr double degrees = 180.0 / std::numbers::pi;
constexpr double knot = 1852.0 / 3600.0;

/// A figure worked out by hand, its expanded uncertainty, and how the scene comes to have it.
struct Limited {
    const char* computation;
    const char* unit;
    bool at_most;
    double value;
    double expanded_uncertainty;  ///< 0 where the figure has none
    std::function<void(RuleScene&)> arrange;
};

void PrintTo(const Limited& limited, std::ostream* out) {
    *out << limited.computation;
}

class LimitedFigure : public testing::TestWithParam<Limited> {
  protected:
    static Requirement judged_against(double limit) {
        const Limited& given = GetParam();
        RuleScene scene(profile_text(clause_text(
            given.computation, fmt::format(", limit: {:.17g}, unit: \"{}\"", limit, given.unit))));
        given.arrange(scene);
        return scene.clause(given.computation);
    }
};

TEST_P(LimitedFigure, IsDecidedOnlyWhereItsWholeIntervalIsOnOneSide) {
    const Limited& given = GetParam();
    const double low = given.value - given.expanded_uncertainty;
    const double high = given.value + given.expanded_uncertainty;
    const double little = 1e-6 * given.value;
    const RequirementStatus below =
        given.at_most ? RequirementStatus::not_met : RequirementStatus::met;
    const RequirementStatus above =
        given.at_most ? RequirementStatus::met : RequirementStatus::not_met;
    const bool uncertain = given.expanded_uncertainty > 0.0;
    EXPECT_EQ(judged_against(low - little).status, below);
    EXPECT_EQ(judged_against(low + little).status, uncertain ? RequirementStatus::attest : above);
    EXPECT_EQ(judged_against(high - little).status, uncertain ? RequirementStatus::attest : below);
    EXPECT_EQ(judged_against(high + little).status, above);
    if (uncertain) {
        EXPECT_TRUE(
            contains(judged_against(given.value).evidence,
                     "the limit lies within the uncertainty, not decidable from the recording"));
    }
}

TEST_P(LimitedFigure, IsStatedWithItsUncertaintyInTheLimitsUnit) {
    const Limited& given = GetParam();
    const Requirement requirement = judged_against(2.0 * given.value);
    ASSERT_EQ(requirement.figures.size(), 1U);
    const Figure& figure = requirement.figures[0];
    EXPECT_NEAR(figure.value, given.value, 1e-7 * given.value);
    EXPECT_EQ(figure.unit, given.unit);
    EXPECT_EQ(figure.expanded_uncertainty.has_value(), given.expanded_uncertainty > 0.0);
    if (figure.expanded_uncertainty) {
        EXPECT_NEAR(*figure.expanded_uncertainty, given.expanded_uncertainty,
                    1e-7 * given.expanded_uncertainty);
    }
    EXPECT_TRUE(contains(requirement.evidence,
                         quantity_text(figure.value, figure.expanded_uncertainty, given.unit)))
        << requirement.evidence;
    EXPECT_EQ(to_text(requirement.decided_by), given.computation);
}

// The window: 180 m in 3 s towards north; sigmas of RuleScene.
const double of_two_heights = 2.0 * std::numbers::sqrt2 * RuleScene::sigma_up_m;
const double of_slope = 100.0 * 2.0 *
                        std::sqrt(2.0 * RuleScene::sigma_up_m * RuleScene::sigma_up_m +
                                  0.03 * 0.03 * 2.0 * RuleScene::sigma_m * RuleScene::sigma_m) /
                        180.0;

INSTANTIATE_TEST_SUITE_P(
    Every, LimitedFigure,
    testing::Values(
        Limited{"flatness", "m", true, 0.9, of_two_heights,
                [](RuleScene& s) { s.row(33.0).up_m = 0.9; }},
        // Downhill counts as uphill.
        Limited{"slope", "%", true, 3.0, of_slope,
                [](RuleScene& s) { s.row(28.0).up_m = -0.03 * 180.0; }},
        Limited{"straightness", "m", true, 0.5, 2.0 * std::sqrt(1.5) * RuleScene::sigma_m,
                [](RuleScene& s) { s.row(26.5).east_m = -0.5; }},
        Limited{"turning", "deg", true, 6.0,
                2.0 * std::numbers::sqrt2* RuleScene::sigma_velocity_m_s / 60.0 * degrees,
                [](RuleScene& s) {
                    s.row(28.0).velocity_east_m_s = -60.0 * std::sin(6.0 / degrees);
                    s.row(28.0).velocity_north_m_s = 60.0 * std::cos(6.0 / degrees);
                }},
        // From 5.2 s, where it has 0.8 m/s: 450 m - 0.08 m up to 20 s, 300 m up to 25 s.
        Limited{"run_up", "m", false, 749.92, 0.0, [](RuleScene&) {}},
        Limited{"wind_mean", "km/h", true, 18.0, 0.0,
                [](RuleScene& s) { s.wind = steady(5.0, 270.0, 0.0, 50.0); }},
        Limited{"wind_gust", "kn", true, 7.0 / knot, 0.0,
                [](RuleScene& s) {
                    s.wind = steady(5.0, 270.0, 0.0, 50.0);
                    s.wind->samples.insert(s.wind->samples.begin() + 3, {26.0, 7.0, 270.0});
                }},
        Limited{"current", "kn", true, 0.4 / knot, 0.1 / knot,
                [](RuleScene& s) { set_current(s, 0.4, 100.0, 0.1); }},
        // One epoch in the middle is late by 50 ms: 150 ms after the one before.
        Limited{"sampling_rate", "Hz", false, 1.0 / (0.15 - 1e-9), 0.0,
                [](RuleScene& s) { s.rows()[10].time.nanoseconds += 50'000'000; }},
        Limited{"sample_accuracy", "m/s", true, 2.0 * 0.01 / 3.0, 0.0, [](RuleScene&) {}}),
    [](const auto& instance) { return std::string(instance.param.computation); });

std::string with_limit(const char* computation, double limit, const char* unit) {
    return profile_text(
        clause_text(computation, fmt::format(", limit: {}, unit: \"{}\"", limit, unit)));
}

/// The scene's recording is of 2022-03-07.
Requirement calibrated(const std::string& calibration) {
    RuleScene scene(profile_text(clause_text("calibration")));
    scene.attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r" +
            calibration +
            "}]\nprofiles: [nalsa]\nrecord: {speed: 202.9, unit: km/h, source: published}\n",
        "attempt");
    return scene.clause("calibration");
}

TEST(CalibrationClause, HoldsACertificateOfADayBeforeTheRunForAPersonToAttest) {
    const Requirement requirement =
        calibrated(", calibration: {certificate: K-4711, laboratory: PTB, date: 2022-03-07}");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(requirement.evidence,
                         "calibrated on 2022-03-07; the recording is of 2022-03-07; it rests on "
                         "what nobody observed: receivers.primary.calibration.certificate: K-4711"))
        << requirement.evidence;
}

TEST(CalibrationClause, IsNotMetByACalibrationAfterTheRun) {
    const Requirement requirement =
        calibrated(", calibration: {certificate: K-4711, laboratory: PTB, date: 2022-03-09}");
    EXPECT_EQ(requirement.status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(requirement.evidence,
                         "calibrated on 2022-03-09, after the recording of 2022-03-07"))
        << requirement.evidence;
}

TEST(CalibrationClause, IsLeftToAPersonWhereNoneIsStated) {
    const Requirement requirement = calibrated("");
    EXPECT_EQ(requirement.status, RequirementStatus::attest);
    EXPECT_EQ(requirement.evidence, "the attempt states no calibration of receiver \"primary\"");
}

TEST(CalibrationClause, IsTheProgramsOwnWhereTheRuleHasNone) {
    RuleScene scene(profile_text(clause_text("margin")));
    EXPECT_TRUE(scene.clause("calibration-as-stated").clause.empty());
    scene.attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\nreceivers:\n"
        "  - {id: primary, recording: r, calibration: {certificate: c, laboratory: l, date: "
        "2022-01-02}}\nprofiles: [nalsa]\n"
        "decision_rule_agreed: {date: 2022-03-01, by: the board}\n",
        "attempt");
    EXPECT_EQ(scene.clause("calibration-as-stated").status, RequirementStatus::attest);
    const Requirement agreed = scene.clause("decision-rule");
    EXPECT_EQ(agreed.status, RequirementStatus::attest);
    EXPECT_EQ(agreed.evidence,
              "decision_rule_agreed.date: 2022-03-01; decision_rule_agreed.by: “the board”");
    EXPECT_EQ(agreed.answered_by->role, "judge");
}

TEST(Heights, ThatAreMissingLeaveFlatnessAndSlopeToAPerson) {
    RuleScene scene(with_limit("flatness", 1.0, "m"));
    ASSERT_EQ(scene.clause("flatness").status, RequirementStatus::met);
    scene.row(35.0).up_m.reset();
    EXPECT_EQ(scene.clause("flatness").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("flatness").evidence, "not every epoch of the run"));
    scene.use(with_limit("slope", 3.0, "%"));
    EXPECT_EQ(scene.clause("slope").status, RequirementStatus::met);
    scene.row(28.0).up_m.reset();
    EXPECT_EQ(scene.clause("slope").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("slope").evidence, "the window's ends have no heights"));
}

/// Constant, typed and computed heights met both clauses.
TEST(Heights, ThatDoNotScatterAsStatedLeaveFlatnessAndSlopeToAPerson) {
    for (const auto& [computation, limit, unit] :
         {std::tuple{"flatness", 1.0, "m"}, {"slope", 3.0, "%"}}) {
        RuleScene scene(with_limit(computation, limit, unit));
        ScreeningModel& model = scene.judged.tests.models.emplace_back();
        model = {.axes = TestedAxes::vertical, .noise = NoiseBasis::fitted, .white_scale = 0.31};
        EXPECT_EQ(scene.clause(computation).status, RequirementStatus::met);
        model.white_scale = 0.29;
        const Requirement smooth = scene.clause(computation);
        EXPECT_EQ(smooth.status, RequirementStatus::attest);
        EXPECT_TRUE(contains(smooth.evidence, "fitted, 0.29 times")) << smooth.evidence;
        model.noise = NoiseBasis::constant_positions;
        EXPECT_TRUE(contains(scene.clause(computation).evidence, "constant_positions"));
        model.noise = NoiseBasis::too_few_epochs;
        EXPECT_EQ(scene.clause(computation).status, RequirementStatus::attest);
        // What is too steep by such heights is so all the same.
        scene.row(25.0).up_m = 30.0;
        EXPECT_EQ(scene.clause(computation).status, RequirementStatus::not_met);
    }
}

/// A slope of `slope` towards north under the whole scene, its vertices good to 1 cm.
CourseGround ground_under_the_scene(double slope, double until_m = 3000.0) {
    SurfaceMesh mesh;
    for (const double north_m : {-100.0, until_m})
        for (const double east_m : {-50.0, 50.0})
            mesh.vertices.emplace_back(east_m, north_m, 7.0 + slope * north_m);
    mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
    return {.surface = Triangulation(std::move(mesh)), .vertical_sd_m = 0.01};
}

TEST(Heights, OfTheGroundAreThoseOfTheSurfaceWhereThereIsOne) {
    RuleScene scene(with_limit("slope", 1.0, "%"));
    ASSERT_EQ(scene.clause("slope").status, RequirementStatus::met);
    scene.judged.ground = ground_under_the_scene(0.02);
    Requirement slope = scene.clause("slope");
    EXPECT_EQ(slope.status, RequirementStatus::not_met);
    EXPECT_NEAR(slope.figures.at(0).value, 2.0, 1e-9);
    // Two heights of 1 cm over the window's 180 m.
    EXPECT_NEAR(*slope.figures.at(0).expanded_uncertainty,
                100.0 * 2.0 * std::numbers::sqrt2 * 0.01 / 180.0, 1e-9);
    EXPECT_TRUE(contains(slope.evidence, "0.00 % by the heights of the track")) << slope.evidence;
    scene.use(with_limit("flatness", 10.0, "m"));
    const double run_m = scene.row(40.0).north_m.value() - scene.row(5.2).north_m.value();
    EXPECT_NEAR(scene.clause("flatness").figures.at(0).value, 0.02 * run_m, 1e-6);
    // Where it does not lie under the whole run, the track's own heights decide.
    scene.judged.ground = ground_under_the_scene(0.02, 500.0);
    EXPECT_EQ(scene.clause("flatness").status, RequirementStatus::met);
    scene.use(with_limit("slope", 1.0, "%"));
    slope = scene.clause("slope");
    EXPECT_EQ(slope.status, RequirementStatus::met);
    EXPECT_FALSE(contains(slope.evidence, "by the surface"));
}

TEST(Heights, OfASurfaceThatNobodyHasAnsweredForOnlyShowThatACourseIsTooSteep) {
    RuleScene scene(with_limit("slope", 1.0, "%"));
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        row.up_m.reset();
    scene.attempt.inputs.push_back({.name = "receivers.primary.surface.file",
                                    .profile = {},
                                    .origin = {.origin = "handed_in",
                                               .changes = {"requirements"},
                                               .decides = {},
                                               .clause = "surface-as-surveyed"},
                                    .value = "course.xml"});
    scene.judged.ground = ground_under_the_scene(0.0);
    const Verdict flat = scene.all();
    EXPECT_EQ(scene.clause("slope").status, RequirementStatus::attest);
    ASSERT_EQ(flat.with_files.size(), 1U);
    const auto slope = std::ranges::find(flat.with_files[0].requirements, "slope",
                                         [](const Requirement& one) { return one.clause; });
    EXPECT_EQ(slope->status, RequirementStatus::met);
    scene.judged.ground = ground_under_the_scene(0.02);
    EXPECT_EQ(scene.clause("slope").status, RequirementStatus::not_met);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
}

TEST(Heights, ASurfaceThatSomeContradictDecidesNothing) {
    RuleScene scene(with_limit("slope", 3.0, "%"));
    scene.judged.ground = ground_under_the_scene(0.02);
    ASSERT_EQ(scene.clause("slope").status, RequirementStatus::met);
    scene.judged.tests.surface = SurfaceComparison{.compared = 400, .rejected = 12};
    const Requirement slope = scene.clause("slope");
    EXPECT_EQ(slope.status, RequirementStatus::attest);
    EXPECT_TRUE(contains(slope.evidence, "12 of 400 heights of the recording contradict the"))
        << slope.evidence;
    scene.use(with_limit("flatness", 100.0, "m"));
    EXPECT_EQ(scene.clause("flatness").status, RequirementStatus::attest);
    // What is not met is not met.
    scene.use(with_limit("slope", 1.0, "%"));
    EXPECT_EQ(scene.clause("slope").status, RequirementStatus::not_met);
}

TEST(Heights, HaveTheSlowErrorThatTheirNoiseOrItsBoundTells) {
    RuleScene scene(with_limit("flatness", 1.0, "m"));
    scene.best().bound.emplace().sigma_m = 0.1;
    // 2 sqrt(2 (0.02^2 + 0.1^2)) = 0.288
    EXPECT_NEAR(*scene.clause("flatness").figures.at(0).expanded_uncertainty,
                2.0 * std::sqrt(2.0 * (0.0004 + 0.01)), 1e-12);
    // Heights that state 0.3 m, and have twice of it.
    scene.judged.estimation.vertical = AxesEstimation{};
    scene.judged.estimation.vertical->noise.stated_sigma_m = 0.3;
    scene.judged.estimation.vertical->noise.white_scale = 2.0;
    EXPECT_NEAR(*scene.clause("flatness").figures.at(0).expanded_uncertainty,
                2.0 * std::sqrt(2.0 * (0.0004 + 0.36)), 1e-12);
    EXPECT_EQ(scene.clause("flatness").status, RequirementStatus::attest);
}

TEST(Course, OfAWindowOutsideOfEveryRunIsForAPerson) {
    RuleScene scene(with_limit("straightness", 1.0, "m"));
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        row.velocity_north_m_s = 0.5;
    EXPECT_EQ(scene.clause("straightness").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("straightness").evidence, "not within one run"));
    scene.judged.trajectory.resize(270);
    EXPECT_TRUE(contains(scene.clause("straightness").evidence, "does not hold the window"));
    scene.windows().best.reset();
    EXPECT_TRUE(contains(scene.clause("straightness").evidence, "no certifiable window"));
}

TEST(StandingStart, IsMetNotMetOrNotSeen) {
    RuleScene scene(profile_text(clause_text("standing_start")));
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::met);
    EXPECT_TRUE(contains(scene.clause("standing_start").evidence, "0.00 m/s ± 0.10 m/s"));
    // Speeds of ± 1.02 m/s met it, though the craft may have rolled.
    RuleScene coarse = scene;
    for (TrajectoryEpoch& row : coarse.judged.trajectory)
        row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = 0.51;
    EXPECT_EQ(coarse.clause("standing_start").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(coarse.clause("standing_start").evidence, "too uncertain to tell"));
    // Never slower than 0.6 m/s, which 0.05 m/s tells from zero: rolling.
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        row.velocity_north_m_s = std::max(0.6, *row.velocity_north_m_s);
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(scene.clause("standing_start").evidence, "moving when the run began"));
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    // With 0.4 m/s of uncertainty (0.6 / 0.4 = 1.5, squared 2.25, at most 5.99) it may have stood,
    // and may have rolled at 1.4 m/s.
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        row.sigma_velocity_east_m_s = row.sigma_velocity_north_m_s = 0.4;
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::attest);
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        if (*row.velocity_north_m_s < 0.7) row.velocity_north_m_s = 0.19;
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::met);
}

TEST(StandingStart, OfTheCraftIsForAPersonWhereTheAntennaSwings) {
    RuleScene scene(profile_text(clause_text("standing_start"), "speed_of: reference_point\n"));
    for (TrajectoryEpoch& row : scene.judged.trajectory)
        row.velocity_north_m_s = std::max(0.6, *row.velocity_north_m_s);
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::attest);
    EXPECT_TRUE(
        contains(scene.clause("standing_start").evidence, "of the antenna, which may swing"));
}

TEST(StandingStart, ThatTheRecordingDoesNotHoldIsForAPerson) {
    RuleScene scene(profile_text(clause_text("standing_start")));
    auto& rows = scene.judged.trajectory;
    rows.erase(rows.begin(), rows.begin() + 150);
    EXPECT_EQ(scene.clause("standing_start").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("standing_start").evidence,
                         "the recording begins with the craft moving, so the start was not seen"));
    // An interruption of 8 s while moving ends the run and begins the next.
    RuleScene broken(profile_text(clause_text("standing_start")));
    for (double time_s = 14.0; time_s < 22.05; time_s += 0.1)
        broken.row(time_s).arc.reset();
    EXPECT_EQ(broken.clause("standing_start").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(broken.clause("standing_start").evidence, "after a gap"));
}

TEST(SeriesOfTheWind, ThatIsNotGivenOrDoesNotCoverTheWindow) {
    RuleScene scene(with_limit("wind_mean", 10.0, "m/s"));
    EXPECT_EQ(scene.clause("wind_mean").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("wind_mean").evidence, "no series of the wind"));
    scene.wind = steady(5.0, 270.0, 0.0, 20.0);
    EXPECT_EQ(scene.clause("wind_mean").status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(scene.clause("wind_mean").evidence,
                         "series.csv covers 0.0 s to 20.0 s from the recording's first epoch; the "
                         "window is 25.0 s to 28.0 s"))
        << scene.clause("wind_mean").evidence;
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(scene.verdict().notes.at(0), "The series of the wind gives no figure"));
}

TEST(SeriesOfTheCurrent, ThatIsNotGivenOrDoesNotCoverTheWindow) {
    RuleScene scene(with_limit("current", 1.0, "kn"));
    EXPECT_EQ(scene.clause("current").status, RequirementStatus::attest);
    set_current(scene, 0.1, 0.0, 0.02);
    EXPECT_EQ(scene.clause("current").status, RequirementStatus::met);
    scene.current = steady(0.1, 0.0, 27.0, 60.0);
    EXPECT_EQ(scene.clause("current").status, RequirementStatus::not_met);
}

TEST(SamplingRate, OfFiveAndOfFourHertzAndOfOneLateEpoch) {
    const auto at_interval = [](std::int64_t ms) {
        RuleScene scene(with_limit("sampling_rate", 5.0, "Hz"));
        auto& rows = scene.rows();
        rows.resize(11);
        for (std::size_t i = 0; i < rows.size(); ++i)
            rows[i].time = {25'000'000'000 + static_cast<std::int64_t>(i) * ms * 1'000'000};
        return scene;
    };
    EXPECT_EQ(at_interval(200).clause("sampling_rate").status, RequirementStatus::met);
    EXPECT_EQ(at_interval(250).clause("sampling_rate").status, RequirementStatus::not_met);
    RuleScene late = at_interval(200);
    late.rows()[5].time.nanoseconds += 1'000'000;
    EXPECT_EQ(late.clause("sampling_rate").status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(late.clause("sampling_rate").evidence, "4.97512 Hz"))
        << late.clause("sampling_rate").evidence;
    late.rows().resize(1);
    EXPECT_EQ(late.clause("sampling_rate").status, RequirementStatus::attest);
}

std::string accuracy_profile(double limit, const char* dimension) {
    return profile_text(
        clause_text("sample_accuracy", fmt::format(", limit: {}, unit: m/s", limit)), {},
        "{kind: absolute, value: 1, unit: km/h}",
        fmt::format("{{duration_s: 3, definition: displacement, dimension: {}}}", dimension));
}

TEST(SampleAccuracy, IsThatOfTheWorstSampleByPositionsOrByVelocities) {
    RuleScene scene(accuracy_profile(3.0, "vertical"));
    // sqrt(2) sigma / 3 s: 3 m/s is a height of 6.364 m.
    scene.rows()[7].sigma_up_m = 6.3639;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::met);
    scene.rows()[7].sigma_up_m = 6.3640;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::not_met);
    scene.rows()[7].sigma_up_m = 1.0;
    // Horizontal accuracies have no part in it.
    scene.rows()[7].sigma_east_m = 100.0;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::met);
    for (ScreenedEpoch& row : scene.rows())
        row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s =
            row.sigma_recorded_velocity_up_m_s = 0.1;
    EXPECT_TRUE(contains(scene.clause("sample_accuracy").evidence, "velocity 0.173 m/s"))
        << scene.clause("sample_accuracy").evidence;
    // sqrt(2^2 + 2^2 + 1^2) = 3; a little more is too much.
    scene.rows()[3].sigma_recorded_velocity_east_m_s = 2.0;
    scene.rows()[3].sigma_recorded_velocity_north_m_s = 2.0;
    scene.rows()[3].sigma_recorded_velocity_up_m_s = 1.0;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::met);
    scene.rows()[3].sigma_recorded_velocity_up_m_s = 1.01;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::not_met);
}

TEST(SampleAccuracy, ThatIsNotStatedThroughout) {
    RuleScene scene(accuracy_profile(3.0, "vertical"));
    for (ScreenedEpoch& row : scene.rows())
        row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s =
            row.sigma_recorded_velocity_up_m_s = 50.0;
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::not_met);
    scene.rows()[4].sigma_recorded_velocity_up_m_s = OptionalReal{};
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::met);
    EXPECT_TRUE(contains(scene.clause("sample_accuracy").evidence, "not stated throughout"));
    scene.rows()[4].sigma_up_m = {};
    EXPECT_EQ(scene.clause("sample_accuracy").status, RequirementStatus::attest);
    EXPECT_TRUE(contains(scene.clause("sample_accuracy").evidence, "accuracy is not stated"));
}

TEST(FastestCertifiable, IsNotMetWhereAFasterWindowCannotBeCertified) {
    RuleScene scene(profile_text(clause_text("fastest_certifiable")));
    EXPECT_EQ(scene.clause("fastest_certifiable").status, RequirementStatus::met);
    // 60 m/s and twice 0.005 m/s: up to 60.01 m/s it is no faster.
    scene.windows().indicated = IndicatedWindow{
        .span = {}, .speed_m_s = 60.0099, .refusals = {"an epoch without a position"}};
    EXPECT_EQ(scene.clause("fastest_certifiable").status, RequirementStatus::met);
    scene.windows().indicated->speed_m_s = 60.0101;
    EXPECT_EQ(scene.clause("fastest_certifiable").status, RequirementStatus::not_met);
    EXPECT_TRUE(contains(scene.clause("fastest_certifiable").evidence, "216.036 km/h"));
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(scene.verdict().reason, "an epoch without a position"));
    scene.windows().indicated->refusals.clear();
    EXPECT_EQ(scene.clause("fastest_certifiable").status, RequirementStatus::met);
    scene.windows().best.reset();
    EXPECT_EQ(scene.clause("fastest_certifiable").status, RequirementStatus::not_met);
}

TEST(OppositeRuns, HoldBothWindows) {
    RuleScene scene(
        profile_text(clause_text("opposite_runs"), "opposite_runs: {within_s: 3600}\n"));
    EXPECT_EQ(scene.clause("opposite_runs").status, RequirementStatus::not_met);
    EXPECT_EQ(scene.verdict().outcome, Outcome::not_certifiable);
    scene.windows().missing = "no two runs in opposite directions lie within 3600 s";
    EXPECT_TRUE(contains(scene.clause("opposite_runs").evidence, "lie within 3600 s"));
    FurtherWindow other{
        .span = scene.best().span, .arc = 1, .speed_m_s = 58.0, .standard_uncertainty_m_s = 0.007};
    other.span.start.nanoseconds += 100'000'000'000;
    scene.windows().further = {other};
    scene.windows().missing.clear();
    const Requirement met = scene.clause("opposite_runs");
    EXPECT_EQ(met.status, RequirementStatus::met);
    // From the one's beginning to the other's end.
    EXPECT_NEAR(met.figures.at(2).value, 103.0, 1e-9);
    EXPECT_NEAR(*scene.verdict().speed_m_s, 59.0, 1e-12);
}

/// Without the current, what a rule takes off is not known.
TEST(OwnArithmetic, GivesNoSpeedWithoutTheCurrentThatItTakesOff) {
    const std::string arithmetic =
        "arithmetic: {text: Length over time., source: position, definition: displacement, "
        "rounding: {mode: nearest, unit: km/h, decimals: 2}}\n";
    const auto own_of = [](RuleScene& scene) {
        scene.windows().score = RuleScore{.span = scene.best().span, .speed_m_s = 60.1};
        return scene.verdict().own_arithmetic;
    };
    RuleScene plain(profile_text(clause_text("window_complete"), arithmetic));
    EXPECT_EQ(own_of(plain).shown, "216.36 km/h");
    EXPECT_TRUE(own_of(plain).text.find("0.36 km/h lower") != std::string::npos)
        << own_of(plain).text;
    RuleScene drifting(
        profile_text(clause_text("window_complete"), "current: subtracted\n" + arithmetic));
    EXPECT_EQ(own_of(drifting).shown, "");
    EXPECT_FALSE(own_of(drifting).speed_m_s);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
