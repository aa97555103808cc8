#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "motion_test_support.h"
#include "stages/window/position_speed.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Ten usable epochs of a fix type, the stated standard deviation 8 mm east, 6 mm north.
ScreenedTable table_of(FixType fix) {
    ScreenedTable table;
    for (std::int64_t k = 0; k < 10; ++k) {
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = row.north_m = 0.0;
        row.sigma_east_m = 0.008;
        row.sigma_north_m = 0.006;
        row.fix = fix;
        row.usable = true;
        row.arc = 1;
    }
    return table;
}

const double stated_m = std::sqrt(0.5 * (0.008 * 0.008 + 0.006 * 0.006));

UncertaintyRule rule() {
    return {.tau_min_s = 0.5,
            .tau_max_s = 10.0,
            .selection_bias = SelectionTreatment::covered,
            .error_floor_m = {{"fixed", 0.020}, {"float", 0.200}}};
}

NoiseSummary noise_with(double white_scale, std::optional<double> diffusion) {
    NoiseSummary noise;
    noise.white_scale = white_scale;
    noise.correlated_error_detected = diffusion.has_value();
    if (diffusion) noise.error_diffusion = test::parameter_of(*diffusion);
    return noise;
}

TEST(ErrorBound, TheFloorDecidesWhereItIsLargest) {
    const ErrorBound bound =
        error_bound<2>(table_of(FixType::fixed), 0, 9, noise_with(1.5, 0.02), rule());
    EXPECT_EQ(bound.decided_by, BoundSource::floor);
    EXPECT_EQ(bound.floor_fix, FixType::fixed);
    EXPECT_EQ(bound.sigma_m, 0.020);
    EXPECT_EQ(bound.floor_m, 0.020);
    EXPECT_NEAR(bound.stated_m, 1.5 * stated_m, 1e-15);
    EXPECT_NEAR(bound.fitted_m, 0.02 * std::sqrt(0.25), 1e-15);
    EXPECT_EQ(bound.tau_min_s, 0.5);
    EXPECT_EQ(bound.tau_max_s, 10.0);
}

TEST(ErrorBound, TheStatedAccuracyTimesItsScaleDecidesWhereThatIsLargest) {
    const ErrorBound bound =
        error_bound<2>(table_of(FixType::fixed), 0, 9, noise_with(4.0, 0.02), rule());
    EXPECT_EQ(bound.decided_by, BoundSource::stated);
    EXPECT_NEAR(bound.sigma_m, 4.0 * stated_m, 1e-15);
}

TEST(ErrorBound, TheFittedErrorDecidesWhereThatIsLargest) {
    // It wanders by 0.1 m s^-0.5; with tau 0.5 s that is 0.1 sqrt(0.25) = 50 mm.
    const ErrorBound bound =
        error_bound<2>(table_of(FixType::fixed), 0, 9, noise_with(4.0, 0.1), rule());
    EXPECT_EQ(bound.decided_by, BoundSource::fitted);
    EXPECT_NEAR(bound.sigma_m, 0.050, 1e-15);
    EXPECT_EQ(error_bound<2>(table_of(FixType::fixed), 0, 9, noise_with(4.0, std::nullopt), rule())
                  .fitted_m,
              0.0);
}

TEST(ErrorBound, TheWorstKindOfSolutionInTheWindowSetsTheFloor) {
    ScreenedTable table = table_of(FixType::fixed);
    table.rows[4].fix = FixType::float_ambiguities;
    const NoiseSummary noise = noise_with(1.0, std::nullopt);
    EXPECT_EQ(error_bound<2>(table, 0, 9, noise, rule()).floor_fix, FixType::float_ambiguities);
    EXPECT_EQ(error_bound<2>(table, 0, 9, noise, rule()).sigma_m, 0.200);
    EXPECT_EQ(error_bound<2>(table, 5, 9, noise, rule()).floor_fix,
              FixType::fixed);  // not in the window
    table.rows[4].usable = false;
    EXPECT_EQ(error_bound<2>(table, 0, 9, noise, rule()).floor_fix, FixType::fixed);
}

TEST(ErrorBound, OnlyUsableEpochsOfTheWindowCount) {
    ScreenedTable table = table_of(FixType::fixed);
    table.rows[0].sigma_east_m = 5.0;  // outside the window
    table.rows[4].sigma_east_m = 5.0;
    table.rows[4].usable = false;
    EXPECT_NEAR(error_bound<2>(table, 1, 9, noise_with(1.0, std::nullopt), rule()).stated_m,
                stated_m, 1e-15);
}

TEST(ErrorBound, TheProfilesOwnFloorsAreThoseOfItsSchema) {
    const Profile nalsa = read_profile(builtin_profile("nalsa"), "nalsa");
    const NoiseSummary noise = noise_with(1.0, std::nullopt);
    EXPECT_EQ(error_bound<2>(table_of(FixType::fixed), 0, 9, noise, nalsa.uncertainty).sigma_m,
              0.020);
    EXPECT_EQ(error_bound<2>(table_of(FixType::single), 0, 9, noise, nalsa.uncertainty).sigma_m,
              0.5);
    EXPECT_EQ(error_bound<2>(table_of(FixType::unknown), 0, 9, noise, nalsa.uncertainty).floor_fix,
              FixType::unknown);
}

TEST(ErrorBound, AFittedErrorThatWandersAsFastIsLargerWithALongerCorrelationTime) {
    // An error that wanders by 0.03 m in the first second may have any correlation time.
    const NoiseSummary noise = noise_with(1.0, 0.03);
    const ErrorBound bound = error_bound<2>(table_of(FixType::fixed), 0, 9, noise, rule());
    ASSERT_EQ(bound.sigma_m, 0.02);
    EXPECT_EQ(sigma_at(bound, 0.5), 0.02);
    EXPECT_NEAR(sigma_at(bound, 10.0), 0.03 * std::sqrt(0.5 * 10.0), 1e-12);
    // Along the track it may be larger.
    const ErrorBound along =
        error_bound<2>(table_of(FixType::fixed), 0, 9, noise, rule(), std::numbers::sqrt2);
    EXPECT_NEAR(sigma_at(along, 10.0), 0.03 * std::sqrt(10.0), 1e-12);
    const ErrorBound unseen =
        error_bound<2>(table_of(FixType::fixed), 0, 9, noise_with(1.0, std::nullopt), rule());
    EXPECT_EQ(sigma_at(unseen, 10.0), unseen.sigma_m);
}

/// A stretch of random motion, and two models of its noise that give it different speeds.
struct Scene {
    EstimationModel white{.motion = {.jerk_density = 0.6}};
    EstimationModel slow{.motion = {.jerk_density = 0.2},
                         .measurement_scale = 0.7,
                         .error = GaussMarkovError::steady(0.02, 3.0)};
    WindowStretch<2> stretch;

    Scene() {
        RandomGenerator random(8);
        stretch.epochs = test::simulate_arc<2>(slow, 61, 0.1, 0.01, random).arc;
        stretch.window = {15, 45};
        stretch.duration_s = 3.0;
    }
    SpeedEstimate by(const EstimationModel& model) const {
        return smoothed_speed(Chain<2>(stretch.epochs, model), {15, 45}, 3.0, {});
    }
};

TEST(FittedSpeed, OfOneModelIsThatModelsOwn) {
    const Scene scene;
    const FittedSpeed fitted =
        fitted_speed(scene.stretch, {{scene.slow, 0.3}}, {SpeedDefinition::displacement});
    const SpeedEstimate alone = scene.by(scene.slow);
    EXPECT_EQ(fitted.models, 1);
    EXPECT_NEAR(fitted.speed_m_s, alone.speed_m_s, 1e-12);
    EXPECT_NEAR(fitted.standard_uncertainty_m_s, alone.standard_uncertainty_m_s, 1e-12);
}

TEST(FittedSpeed, OfTwoModelsHoldsTheirDifference) {
    const Scene scene;
    const SpeedEstimate a = scene.by(scene.white);
    const SpeedEstimate b = scene.by(scene.slow);
    ASSERT_GT(std::abs(a.speed_m_s - b.speed_m_s), 1e-4);
    const FittedSpeed fitted = fitted_speed(
        scene.stretch, {{scene.white, 0.75}, {scene.slow, 0.25}}, {SpeedDefinition::displacement});
    EXPECT_EQ(fitted.models, 2);
    EXPECT_NEAR(fitted.speed_m_s, 0.75 * a.speed_m_s + 0.25 * b.speed_m_s, 1e-10);
    const double variance = 0.75 * std::pow(a.standard_uncertainty_m_s, 2) +
                            0.25 * std::pow(b.standard_uncertainty_m_s, 2) +
                            0.75 * 0.25 * std::pow(a.speed_m_s - b.speed_m_s, 2);
    EXPECT_NEAR(fitted.standard_uncertainty_m_s, std::sqrt(variance), 1e-10);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
