#include "golden_files.h"

// What revision 1.2 added, as today's reader finds it in the files of 1.2.

namespace runcert {
namespace {

using golden::text_of;

TEST(Golden12, DecisionsOfScreening) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    ASSERT_EQ(table.rows.size(), 17U);
    const struct {
        std::size_t row;
        Reason reason;
        std::optional<ArcBreak> break_before;
        Hypothesis hypothesis;
        TestedAxes axes;
    } expected[] = {
        {1, Reason::none, std::nullopt, Hypothesis::outlier, TestedAxes::vertical},
        {3, Reason::outlier, std::nullopt, Hypothesis::outlier, TestedAxes::horizontal},
        {5, Reason::none, ArcBreak::step, Hypothesis::step, TestedAxes::vertical},
        {6, Reason::none, ArcBreak::bridged, Hypothesis::step, TestedAxes::horizontal},
        {7, Reason::burst, std::nullopt, Hypothesis::burst, TestedAxes::horizontal},
        {8, Reason::model, std::nullopt, Hypothesis::model, TestedAxes::horizontal},
        {9, Reason::none, ArcBreak::ramp, Hypothesis::ramp, TestedAxes::horizontal},
        {11, Reason::none, ArcBreak::time_shift, Hypothesis::time_shift, TestedAxes::horizontal},
        {12, Reason::velocity, std::nullopt, Hypothesis::velocity, TestedAxes::horizontal},
        {13, Reason::physical_limit, std::nullopt, Hypothesis::acceleration,
         TestedAxes::horizontal},
        {14, Reason::physical_limit, std::nullopt, Hypothesis::jerk, TestedAxes::horizontal},
        {15, Reason::physical_limit, std::nullopt, Hypothesis::vertical_rate, TestedAxes::vertical},
        {16, Reason::baseline, std::nullopt, Hypothesis::baseline, TestedAxes::horizontal}};
    for (const auto& each : expected) {
        const ScreenedEpoch& row = table.rows[each.row];
        EXPECT_EQ(row.reason, each.reason) << each.row;
        EXPECT_EQ(row.break_before, each.break_before) << each.row;
        EXPECT_EQ(row.hypothesis, each.hypothesis) << each.row;
        EXPECT_EQ(row.tested_axes, each.axes) << each.row;
    }
    EXPECT_FALSE(table.rows[0].hypothesis || table.rows[0].tested_axes);
}

TEST(Golden12, EstimatedErrors) {
    const auto rows = read_screened(text_of("v1.0/3-screened.ecsv"), "f").rows;
    const EstimatedError& outlier = rows.at(3).estimated;
    EXPECT_EQ(outlier.east_m, 0.25);
    EXPECT_EQ(outlier.north_m, -0.125);
    EXPECT_EQ(outlier.sigma_east_m, 0.0175);
    EXPECT_EQ(outlier.sigma_north_m, 0.02);
    EXPECT_EQ(outlier.correlation_east_north, -0.375);
    EXPECT_FALSE(outlier.up_m || outlier.sigma_up_m || outlier.rate_east_mps || outlier.time_s);
    EXPECT_EQ(rows.at(5).estimated.up_m, -0.5);
    EXPECT_EQ(rows.at(5).estimated.sigma_up_m, 0.03125);
    EXPECT_FALSE(rows.at(5).estimated.east_m);
    EXPECT_EQ(rows.at(9).estimated.rate_east_mps, 0.375);
    EXPECT_EQ(rows.at(9).estimated.rate_north_mps, -0.1875);
    EXPECT_EQ(rows.at(10).estimated.rate_up_mps, -0.9375);
    EXPECT_EQ(rows.at(11).estimated.time_s, 0.012500125);
}

TEST(Golden12, DetectableErrors) {
    const auto rows = read_screened(text_of("v1.0/3-screened.ecsv"), "f").rows;
    const DetectableError& detectable = rows.at(0).detectable;
    EXPECT_EQ(detectable.outlier_m, 0.045);
    EXPECT_EQ(detectable.step_m, 0.0625);
    EXPECT_EQ(detectable.ramp_mps, 0.75);
    EXPECT_EQ(detectable.time_s, 0.00125);
    EXPECT_EQ(detectable.outlier_up_m, 0.125);
    EXPECT_EQ(detectable.step_up_m, 0.1875);
    EXPECT_FALSE(rows.at(2).detectable.outlier_m || rows.at(2).detectable.step_up_m);
    EXPECT_EQ(rows.at(0).local_variance_factor, 1.0);
    EXPECT_EQ(rows.at(1).local_variance_factor, 1.375);
    EXPECT_FALSE(rows.at(2).local_variance_factor);
}

TEST(Golden12, WhatTheTestsRestedOn) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    ASSERT_TRUE(table.evidence);
    const ScreeningEvidence& evidence = *table.evidence;
    EXPECT_EQ(evidence.family_false_alarm_rate, 0.001);
    EXPECT_EQ(evidence.tests, 4'000'000);
    EXPECT_EQ(evidence.test_size, 2.5e-10);
    EXPECT_EQ(evidence.power, 0.8);
    EXPECT_EQ(evidence.burst_epochs_max, 12);
    EXPECT_EQ(evidence.passes, 3);
    ASSERT_EQ(evidence.models.size(), 2U);
    EXPECT_EQ(evidence.models[0].axes, TestedAxes::horizontal);
    EXPECT_EQ(evidence.models[0].error_sigma_m, 0.0125);
    EXPECT_EQ(evidence.models[0].error_tau_s, 2.5);
    EXPECT_EQ(evidence.models[1].axes, TestedAxes::vertical);
    EXPECT_EQ(evidence.models[1].noise, "too_few_epochs");
    EXPECT_EQ(evidence.models[1].jerk_density, 0.6);
    EXPECT_EQ(evidence.models[1].measurement_scale, 1.5);
    EXPECT_EQ(evidence.models[1].white_scale, 1.75);
    ASSERT_EQ(evidence.fix_kinds.size(), 2U);
    EXPECT_EQ(evidence.fix_kinds[1].fix, FixKind::float_ambiguities);
    EXPECT_EQ(evidence.fix_kinds[1].axes, TestedAxes::vertical);
    EXPECT_EQ(evidence.fix_kinds[1].epochs, 1);
    EXPECT_EQ(evidence.fix_kinds[1].variance_factor, 4.5);
    EXPECT_EQ(evidence.fix_kinds[1].judgement, "too_good");
}

TEST(Golden12, WhatOtherChecksFound) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    const ScreeningEvidence& evidence = table.evidence.value();
    EXPECT_EQ(evidence.velocity->compared, 12);
    EXPECT_EQ(evidence.velocity->delay_s, 0.2125);
    EXPECT_EQ(evidence.velocity->sigma_delay_s, 0.00375);
    EXPECT_EQ(evidence.velocity->scale_mps, 0.0475);
    EXPECT_EQ(evidence.velocity->rejected, 1);
    EXPECT_EQ(evidence.time.sessions, 2);
    EXPECT_EQ(evidence.time.longest_gap_s, 75.100000001);
    EXPECT_EQ(evidence.time.rate_deviation, -2.5e-8);
    EXPECT_EQ(evidence.time.jitter_s, 0.000015625);
    ASSERT_EQ(evidence.time.faults.size(), 2U);
    EXPECT_EQ(evidence.time.faults[1].epoch, 2);
    EXPECT_EQ(evidence.time.faults[1].kind, "whole_second_shift");
    EXPECT_EQ(evidence.time.faults[1].size_s, -1.0);
    EXPECT_EQ(evidence.limits.jerk_max_mps3, 200.0);
    EXPECT_EQ(evidence.limits.acceleration_mps2, 8.75);
    EXPECT_EQ(evidence.limits.vertical_rate_mps, 0.375);
    EXPECT_EQ(evidence.limits.rejected, 3);
    EXPECT_EQ(evidence.baseline->receiver, "secondary");
    EXPECT_EQ(evidence.baseline->length_m, 1.25);
    EXPECT_EQ(evidence.baseline->sd_m, 0.0125);
}

TEST(Golden12, Trajectory) {
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    ASSERT_EQ(table.rows.size(), 5U);
    EXPECT_EQ(table.estimation.robust_unsolved, 2);
    EXPECT_EQ(table.rows[0].step_before, false);
    EXPECT_EQ(table.rows[3].step_before, true);
    EXPECT_TRUE(begins_after_step(table.rows[3]));
    EXPECT_FALSE(table.rows[4].step_before);  // outside arcs
    EXPECT_FALSE(begins_after_step(table.rows[4]));
}

TEST(Golden12, Windows) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.repaired_steps, 1);
    EXPECT_EQ(best.detection_power, 0.8);
    ASSERT_EQ(best.reliability.size(), 3U);
    EXPECT_EQ(best.reliability[0].hypothesis, "step");
    EXPECT_EQ(best.reliability[0].speed_mps, 0.020125);
    EXPECT_EQ(best.reliability[1].epoch, 110);
    EXPECT_EQ(best.reliability[1].last_epoch, 131);
    EXPECT_EQ(best.reliability[1].size, 0.001250125);
    EXPECT_EQ(best.reliability[1].unit, "s");
    EXPECT_EQ(best.reliability[2].unit, "m / s");
}

TEST(Golden12, AttemptFile) {
    const Attempt attempt = read_attempt(text_of("v1.2/attempt.yaml"), "f");
    const nlohmann::ordered_json& screen = attempt.parameters.at("screen");
    EXPECT_EQ(screen.at("family_false_alarm_rate"), 1e-4);
    EXPECT_EQ(screen.at("power"), 0.95);
    EXPECT_EQ(screen.at("burst_epochs_max"), 12);
    EXPECT_EQ(screen.at("noise"), "stated");
    EXPECT_EQ(screen.at("steps"), "bridge");
    EXPECT_EQ(screen.at("acceleration_max_mps2"), 12.5);
    EXPECT_EQ(screen.at("jerk_max_mps3"), 125);
    EXPECT_EQ(screen.at("vertical_rate_max_mps"), 2.5);
    EXPECT_EQ(screen.at("velocity_delay_max_s"), 0.5);
    EXPECT_EQ(screen.at("satellites_min"), 6);
    EXPECT_EQ(screen.at("ratio_min"), 2.5);
    EXPECT_EQ(screen.at("correction_age_max_s"), 12.5);
    EXPECT_EQ(screen.at("session_gap_s"), 120);
    EXPECT_EQ(attempt.overrides.size(), 33U);
}

TEST(Golden12, ProfileFile) {
    EXPECT_TRUE(read_profile(text_of("v1.2/profile.yaml"), "f").repaired_steps);
}

}  // namespace
}  // namespace runcert
