#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "store_test_support.h"

// Trajectory and windows, written and read again.

namespace runcert::RUNCERT_FILE {
namespace {

using test::failure_of;

Header header(const std::string& stage) {
    Header header;
    header.stage = stage;
    header.program_version = "1.0.0";
    header.source_revision = "0";
    return header;
}

NoiseSummary fitted_noise() {
    NoiseSummary noise;
    noise.status = NoiseBasis::fitted;
    noise.epochs = 451;
    noise.epochs_needed = 60;
    noise.stated_sigma_m = 0.0101;
    noise.stated_all_equal = true;
    noise.tau_min_s = 0.5;
    noise.tau_max_s = 10.0;
    noise.jerk_density = {0.6125, 0.25, false};
    noise.measurement_scale = {1.0625, std::nullopt, true};
    noise.acceleration_time_s = NoiseParameter{4.5, 0.5, true};
    noise.singer_gain = -1.25;
    noise.correlated_error_detected = true;
    noise.error_gain = 7.5;
    noise.error_diffusion = NoiseParameter{0.0125, 0.125, false};
    noise.error_tau_s = NoiseParameter{2.25, std::nullopt, false};
    noise.error_sigma_m = NoiseParameter{0.008, 0.0625, true};
    noise.white_scale = 2.5;
    noise.passes = 32.1;
    noise.converged = true;
    noise.posterior = {{0.625, 0.5, 4.5, 1.25, 0.007, 2.0}, {0.375, 0.75, std::nullopt, 1.5, 0, 1}};
    return noise;
}

void expect_equal(const std::optional<NoiseParameter>& a, const std::optional<NoiseParameter>& b) {
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) return;
    EXPECT_EQ(a->value, b->value);
    EXPECT_EQ(a->relative_uncertainty, b->relative_uncertainty);
    EXPECT_EQ(a->at_bound, b->at_bound);
}

void expect_equal(const NoiseSummary& a, const NoiseSummary& b) {
    EXPECT_EQ(a.status, b.status);
    EXPECT_EQ(a.epochs, b.epochs);
    EXPECT_EQ(a.epochs_needed, b.epochs_needed);
    EXPECT_EQ(a.stated_sigma_m, b.stated_sigma_m);
    EXPECT_EQ(a.stated_all_equal, b.stated_all_equal);
    EXPECT_EQ(a.tau_min_s, b.tau_min_s);
    EXPECT_EQ(a.tau_max_s, b.tau_max_s);
    expect_equal(a.jerk_density, b.jerk_density);
    expect_equal(a.measurement_scale, b.measurement_scale);
    expect_equal(a.acceleration_time_s, b.acceleration_time_s);
    EXPECT_EQ(a.singer_gain, b.singer_gain);
    EXPECT_EQ(a.correlated_error_detected, b.correlated_error_detected);
    EXPECT_EQ(a.error_gain, b.error_gain);
    expect_equal(a.error_diffusion, b.error_diffusion);
    expect_equal(a.error_tau_s, b.error_tau_s);
    expect_equal(a.error_sigma_m, b.error_sigma_m);
    EXPECT_EQ(a.white_scale, b.white_scale);
    EXPECT_EQ(a.passes, b.passes);
    EXPECT_EQ(a.converged, b.converged);
    ASSERT_EQ(a.posterior.size(), b.posterior.size());
    for (std::size_t i = 0; i < a.posterior.size(); ++i) {
        EXPECT_EQ(a.posterior[i].weight, b.posterior[i].weight);
        EXPECT_EQ(a.posterior[i].jerk_density, b.posterior[i].jerk_density);
        EXPECT_EQ(a.posterior[i].acceleration_time_s, b.posterior[i].acceleration_time_s);
        EXPECT_EQ(a.posterior[i].measurement_scale, b.posterior[i].measurement_scale);
        EXPECT_EQ(a.posterior[i].error_sigma_m, b.posterior[i].error_sigma_m);
        EXPECT_EQ(a.posterior[i].error_tau_s, b.posterior[i].error_tau_s);
    }
}

TrajectoryTable trajectory() {
    TrajectoryTable table;
    table.header = header("smooth");
    table.facts.receiver = "primary";
    table.facts.position_resolution_m = 0.001;
    table.facts.time_resolution_s = 1e-9;
    table.estimation.batch_stretches = 4;
    table.estimation.robust_downweighted = 3;
    table.estimation.robust_unsolved = 1;
    table.estimation.horizontal = AxesEstimation{
        fitted_noise(), {900, 1.0125, 0.9, 1.1, 9, 2, 3, true, 0.5, -0.0125, true, 153.5, 2e-16}};
    TrajectoryEpoch epoch;
    epoch.epoch = 1;
    epoch.robust_east_m = 1.000001;
    epoch.robust_north_m = -2.5;
    epoch.robust_weight = 0.0625;
    epoch.jerk_density = 1.9375;
    epoch.jerk_density_up = 0.6125;
    table.rows = {epoch, TrajectoryEpoch{}};
    return table;
}

TEST(TrajectoryEstimation, RoundTrips) {
    const TrajectoryTable table = trajectory();
    const TrajectoryTable back = read_trajectory(write_trajectory(table), "f");
    EXPECT_EQ(back.facts.position_resolution_m, 0.001);
    EXPECT_EQ(back.facts.time_resolution_s, 1e-9);
    EXPECT_EQ(back.estimation.batch_stretches, 4);
    EXPECT_EQ(back.estimation.robust_downweighted, 3);
    EXPECT_EQ(back.estimation.robust_unsolved, 1);
    EXPECT_EQ(back.rows.at(0).robust_east_m, 1.000001);
    EXPECT_EQ(back.rows.at(0).robust_north_m, -2.5);
    EXPECT_EQ(back.rows.at(0).robust_weight, 0.0625);
    EXPECT_EQ(back.rows.at(0).jerk_density, 1.9375);
    EXPECT_EQ(back.rows.at(0).jerk_density_up, 0.6125);
    EXPECT_FALSE(back.rows.at(1).jerk_density || back.rows.at(1).jerk_density_up);
    EXPECT_FALSE(back.estimation.vertical);
    expect_equal(back.estimation.horizontal.noise, table.estimation.horizontal.noise);
    const FilterHealth& a = back.estimation.horizontal.health;
    const FilterHealth& b = table.estimation.horizontal.health;
    EXPECT_EQ(a.innovations, b.innovations);
    EXPECT_EQ(a.mean_statistic, b.mean_statistic);
    EXPECT_EQ(a.lower, b.lower);
    EXPECT_EQ(a.upper, b.upper);
    EXPECT_EQ(a.spans, b.spans);
    EXPECT_EQ(a.spans_outside, b.spans_outside);
    EXPECT_EQ(a.spans_allowed, b.spans_allowed);
    EXPECT_EQ(a.consistent, b.consistent);
    EXPECT_EQ(a.autocorrelation_stated, b.autocorrelation_stated);
    EXPECT_EQ(a.autocorrelation, b.autocorrelation);
    EXPECT_EQ(a.white, b.white);
    EXPECT_EQ(a.largest_condition, b.largest_condition);
    EXPECT_EQ(a.largest_asymmetry, b.largest_asymmetry);
}

TEST(TrajectoryEstimation, WhatTheDataDoNotTellIsAbsent) {
    TrajectoryTable table = trajectory();
    NoiseSummary& noise = table.estimation.horizontal.noise;
    noise.status = NoiseBasis::too_few_epochs;
    noise.acceleration_time_s = noise.error_diffusion = noise.error_tau_s = noise.error_sigma_m =
        std::nullopt;
    noise.jerk_density.relative_uncertainty = std::numeric_limits<double>::infinity();
    noise.posterior.clear();
    const TrajectoryTable back = read_trajectory(write_trajectory(table), "f");
    noise.jerk_density.relative_uncertainty.reset();
    expect_equal(back.estimation.horizontal.noise, noise);
}

TEST(TrajectoryEstimation, IsRoundedToTheFieldTable) {
    TrajectoryTable table = trajectory();
    table.estimation.horizontal.noise.jerk_density.value = 0.61234567;
    table.estimation.horizontal.noise.error_gain = 7.456;
    table.estimation.horizontal.health.largest_condition = 1234.56;
    const TrajectoryTable back = read_trajectory(write_trajectory(table), "f");
    EXPECT_EQ(back.estimation.horizontal.noise.jerk_density.value, 0.612346);
    EXPECT_EQ(back.estimation.horizontal.noise.error_gain, 7.46);
    EXPECT_EQ(back.estimation.horizontal.health.largest_condition, 1234.6);
}

TEST(TrajectoryEstimation, JerkDensitiesAreWrittenToTheirDecimals) {
    TrajectoryTable table = trajectory();
    table.rows[0].jerk_density = 1.0 / 3.0;
    table.rows[0].jerk_density_up = 2.0 / 3.0;
    const std::string text = write_trajectory(table);
    const TrajectoryEpoch back = read_trajectory(text, "f").rows.at(0);
    EXPECT_EQ(back.jerk_density, 0.333333);
    EXPECT_EQ(back.jerk_density_up, 0.666667);
    table.rows[0].jerk_density = std::numeric_limits<double>::infinity();
    EXPECT_EQ(failure_of([&] { write_trajectory(table); }).where, "column jerk_density");
}

CertifiableWindow window() {
    CertifiableWindow window;
    window.span.duration.nanoseconds = 3'000'000'000;
    window.speed_m_s = 60.0025;
    window.standard_uncertainty_m_s = 0.0125;
    window.effective_degrees_of_freedom = 12.75;
    window.fitted = FittedSpeed{60.0035, 0.0025, 9};
    window.own_standard_uncertainty_m_s = 0.0105;
    window.bias_limit_m_s = 0.0015;
    window.estimates = OtherEstimates{60.0045, 0.0035, 60.0015, 60.0055, 60.0005, 0.0035};
    window.bound = ErrorBound{0.25,
                              20.0,
                              0.02,
                              0.0075,
                              1.25,
                              0.005,
                              0.0065,
                              0.0125,
                              FixType::float_ambiguities,
                              BoundSource::fitted,
                              0.0095};
    window.robust = RobustSpeed{60.001, -0.0025, 0.0245, true, 2};
    window.selection = SelectionBias{17,
                                     60.0,
                                     0.0115,
                                     60.0005,
                                     0.011,
                                     0.001,
                                     0.004,
                                     0.0025,
                                     0.0015,
                                     0.0005,
                                     SelectionTreatment::subtracted,
                                     5000,
                                     42};
    window.budget = {{"d", "displacement", 180.0075, "m", 0.0375, "A", "normal", 12.75, 0.333333,
                      0.0125, RowScope::slow, "with b", "fit"},
                     {"b", "scale", 1.0, "", 0.00057735, "B", "rectangular", std::nullopt, 60.0,
                      0.034641, RowScope::window, "", ""}};
    window.monte_carlo =
        MonteCarloCheck{7, 200'000, 60.0024, 0.0126, 59.9775, 60.0275, 0.00005, true};
    window.detection_power = 0.8;
    window.reliability = {{Hypothesis::step, 12, 31, 0.0625, "m", 0.0205},
                          {Hypothesis::ramp, 14, 30, 0.75, "m / s", 0.0125},
                          {Hypothesis::time_shift, 9, 31, 0.001250125, "s", 0.0075}};
    return window;
}

Windows windows(const CertifiableWindow& best) {
    Windows windows;
    windows.header = header("window");
    windows.receiver = "primary";
    windows.profiles = {{.profile = "nalsa",
                         .rule = {.duration_s = 3.0, .definition = SpeedDefinition::displacement},
                         .candidates = 1,
                         .best = best,
                         .indicated = std::nullopt}};
    return windows;
}

CertifiableWindow written_and_read(const CertifiableWindow& best) {
    return read_windows(write_windows(windows(best)), "f").profiles.at(0).best.value();
}

TEST(WindowUncertainty, SpeedsRoundTrip) {
    const CertifiableWindow back = written_and_read(window());
    EXPECT_EQ(back.effective_degrees_of_freedom, 12.75);
    EXPECT_EQ(back.fitted->speed_m_s, 60.0035);
    EXPECT_EQ(back.fitted->standard_uncertainty_m_s, 0.0025);
    EXPECT_EQ(back.fitted->models, 9);
    EXPECT_EQ(back.bound->tau_min_s, 0.25);
    EXPECT_EQ(back.bound->tau_max_s, 20.0);
    EXPECT_EQ(back.bound->sigma_m, 0.02);
    EXPECT_EQ(back.bound->fitted_m, 0.0075);
    EXPECT_EQ(back.bound->along, 1.25);
    EXPECT_EQ(back.bound->stated_m, 0.005);
    EXPECT_EQ(back.bound->floor_m, 0.0125);
    EXPECT_EQ(back.bound->floor_fix, FixType::float_ambiguities);
    EXPECT_EQ(back.bound->decided_by, BoundSource::fitted);
    EXPECT_EQ(back.bound->standard_uncertainty_m_s, 0.0095);
    EXPECT_EQ(back.robust->speed_m_s, 60.001);
    EXPECT_EQ(back.robust->difference_m_s, -0.0025);
    EXPECT_EQ(back.robust->limit_m_s, 0.0245);
    EXPECT_TRUE(back.robust->agrees);
    EXPECT_EQ(back.robust->downweighted, 2);
    EXPECT_EQ(back.own_standard_uncertainty_m_s, 0.0105);
    EXPECT_EQ(back.bias_limit_m_s, 0.0015);
    EXPECT_EQ(back.estimates->chord_m_s, 60.0045);
    EXPECT_EQ(back.estimates->chord_difference_uncertainty_m_s, 0.0035);
    EXPECT_EQ(back.estimates->stiffer_m_s, 60.0015);
    EXPECT_EQ(back.estimates->softer_m_s, 60.0055);
    EXPECT_EQ(back.estimates->whole_m_s, 60.0005);
    EXPECT_EQ(back.estimates->half_width_m_s, 0.0035);
}

TEST(WindowUncertainty, SelectionAndMonteCarloRoundTrip) {
    const CertifiableWindow back = written_and_read(window());
    EXPECT_EQ(back.selection->candidates, 17);
    EXPECT_EQ(back.selection->chosen_mean_m_s, 60.0);
    EXPECT_EQ(back.selection->chosen_sd_m_s, 0.0115);
    EXPECT_EQ(back.selection->best_mean_m_s, 60.0005);
    EXPECT_EQ(back.selection->best_sd_m_s, 0.011);
    EXPECT_EQ(back.selection->fitted_bias_m_s, 0.001);
    EXPECT_EQ(back.selection->bounded_bias_m_s, 0.004);
    EXPECT_EQ(back.selection->bias_m_s, 0.0025);
    EXPECT_EQ(back.selection->bias_half_range_m_s, 0.0015);
    EXPECT_EQ(back.selection->bias_uncertainty_m_s, 0.0005);
    EXPECT_EQ(back.selection->treatment, SelectionTreatment::subtracted);
    EXPECT_EQ(back.selection->samples, 5000);
    EXPECT_EQ(back.selection->seed, 42);
    EXPECT_EQ(back.monte_carlo->seed, 7);
    EXPECT_EQ(back.monte_carlo->trials, 200'000);
    EXPECT_EQ(back.monte_carlo->mean_m_s, 60.0024);
    EXPECT_EQ(back.monte_carlo->standard_uncertainty_m_s, 0.0126);
    EXPECT_EQ(back.monte_carlo->lower_m_s, 59.9775);
    EXPECT_EQ(back.monte_carlo->upper_m_s, 60.0275);
    EXPECT_EQ(back.monte_carlo->tolerance_m_s, 0.00005);
    EXPECT_TRUE(back.monte_carlo->converged);
}

TEST(WindowUncertainty, TheBudgetRoundTrips) {
    const CertifiableWindow before = window();
    const CertifiableWindow back = written_and_read(before);
    ASSERT_EQ(back.budget.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        const BudgetRow& a = back.budget[i];
        const BudgetRow& b = before.budget[i];
        EXPECT_EQ(a.symbol, b.symbol);
        EXPECT_EQ(a.source, b.source);
        EXPECT_EQ(a.estimate, b.estimate);
        EXPECT_EQ(a.unit, b.unit);
        EXPECT_EQ(a.standard_uncertainty, b.standard_uncertainty);
        EXPECT_EQ(a.type, b.type);
        EXPECT_EQ(a.distribution, b.distribution);
        EXPECT_EQ(a.degrees_of_freedom, b.degrees_of_freedom);
        EXPECT_EQ(a.sensitivity, b.sensitivity);
        EXPECT_EQ(a.contribution_m_s, b.contribution_m_s);
        EXPECT_EQ(a.correlation, b.correlation);
        EXPECT_EQ(a.note, b.note);
    }
}

TEST(WindowReliability, RoundTrips) {
    const CertifiableWindow before = window();
    const CertifiableWindow back = written_and_read(before);
    EXPECT_EQ(back.detection_power, 0.8);
    ASSERT_EQ(back.reliability.size(), 3U);
    for (std::size_t i = 0; i < 3; ++i) {
        const UndetectedError& a = back.reliability[i];
        const UndetectedError& b = before.reliability[i];
        EXPECT_EQ(a.hypothesis, b.hypothesis);
        EXPECT_EQ(a.epoch, b.epoch);
        EXPECT_EQ(a.last_epoch, b.last_epoch);
        EXPECT_EQ(a.size, b.size);
        EXPECT_EQ(a.unit, b.unit);
        EXPECT_EQ(a.speed_m_s, b.speed_m_s);
    }
}

TEST(WindowReliability, HasOnlyKnownWords) {
    CertifiableWindow wrong = window();
    wrong.reliability[0].unit = "km";
    EXPECT_TRUE(
        failure_of([&] { write_windows(windows(wrong)); }).contains("is not one of m, m / s"));
}

TEST(WindowUncertainty, WhatRevision4AddedIsNowhereNegative) {
    const auto refused = [](auto change) {
        CertifiableWindow wrong = window();
        change(wrong);
        return failure_of([&] { write_windows(windows(wrong)); }).contains("-0.5 is below 0");
    };
    using Window = CertifiableWindow;
    EXPECT_TRUE(refused([](Window& it) { it.own_standard_uncertainty_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.bias_limit_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.estimates->chord_difference_uncertainty_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.estimates->half_width_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.bound->along = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.selection->fitted_bias_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.selection->bounded_bias_m_s = -0.5; }));
    EXPECT_TRUE(refused([](Window& it) { it.selection->bias_half_range_m_s = -0.5; }));
}

TEST(WindowUncertainty, OfOtherEstimatesOnlyTheChordMayBeAbsent) {
    CertifiableWindow without = window();
    without.estimates->chord_m_s = without.estimates->chord_difference_uncertainty_m_s =
        std::nullopt;
    const CertifiableWindow back = written_and_read(without);
    EXPECT_FALSE(back.estimates->chord_m_s || back.estimates->chord_difference_uncertainty_m_s);
    EXPECT_EQ(back.estimates->softer_m_s, 60.0055);
    const std::string text = write_windows(windows(without));
    for (const auto& [key, line] : {std::pair{"stiffer_m_s", "        stiffer_m_s: 60.0015\n"},
                                    {"softer_m_s", "        softer_m_s: 60.0055\n"},
                                    {"whole_m_s", "        whole_m_s: 60.0005\n"},
                                    {"half_width_m_s", "        half_width_m_s: 0.0035\n"}})
        EXPECT_TRUE(failure_of([&, line = line] {
                        read_windows(test::replaced(text, line, ""), "f");
                    }).contains(std::string("the key \"") + key + "\" is missing"))
            << key;
}

TEST(WindowUncertainty, WhatWasNotComputedIsAbsentButTheBudgetIsListed) {
    CertifiableWindow bare;
    bare.effective_degrees_of_freedom = std::numeric_limits<double>::infinity();
    const std::string text = write_windows(windows(bare));
    const CertifiableWindow back = read_windows(text, "f").profiles.at(0).best.value();
    EXPECT_FALSE(back.effective_degrees_of_freedom || back.fitted || back.bound || back.robust ||
                 back.selection || back.monte_carlo || back.detection_power ||
                 back.own_standard_uncertainty_m_s || back.estimates);
    EXPECT_EQ(back.bias_limit_m_s, 0.0);
    EXPECT_TRUE(back.reliability.empty());
    const std::string without = test::replaced(text, "      budget: []\n", "");
    EXPECT_TRUE(
        failure_of([&] { read_windows(without, "f"); }).contains("the key \"budget\" is missing"));
    bare.fitted = FittedSpeed{60.0, std::numeric_limits<double>::quiet_NaN(), 1};
    EXPECT_TRUE(failure_of([&] { write_windows(windows(bare)); }).contains("finite"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
