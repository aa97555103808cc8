#include "golden_files.h"

// What attempt/1.6, observations/1.3, enu/1.3, screened/1.4, trajectory/1.3, windows/1.4,
// verdict/1.3 and day_results/1.1 added: where times and kinds of solution come from, how the
// motion was modelled, and what else bears on a speed.

namespace runcert {
namespace {

using golden::text_of;

TEST(GoldenEvidence, Attempt) {
    const Attempt attempt = read_attempt(text_of("v1.6/attempt.yaml"), "f");
    EXPECT_EQ(attempt.attempts_made, 3);
    EXPECT_EQ(attempt.receivers.at(0).solution, "float");
    EXPECT_EQ(attempt.receivers.at(0).time_source, "satellites");
    EXPECT_EQ(attempt.receivers.at(1).solution, "");
    EXPECT_EQ(attempt.receivers.at(1).time_source, "");
    EXPECT_EQ(attempt.parameters.at("window").at("clock_rate_bound"), 0.0025);
    EXPECT_EQ(read_attempt(text_of("v1.6/attempt.plane.yaml"), "f").attempts_made, 1);
}

TEST(GoldenEvidence, WhoseClockMadeTheTimeStampsStandsInEveryTable) {
    for (const RecordingFacts& facts :
         {read_observations(text_of("v1.0/1-observations.ecsv"), "f").facts,
          read_enu(text_of("v1.0/2-enu.ecsv"), "f").facts,
          read_screened(text_of("v1.0/3-screened.ecsv"), "f").facts,
          read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").facts})
        EXPECT_EQ(facts.time_source, "satellites");
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(table.time_origin, "GPS time of the receiver's measurements, as RTKLIB solved it");
    EXPECT_EQ(table.solution_source, "recording");
}

TEST(GoldenEvidence, SignsOfTheDeviceAndManoeuvres) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    ASSERT_TRUE(table.evidence && table.evidence->device);
    EXPECT_EQ(table.evidence->device->moving, 15);
    EXPECT_EQ(table.evidence->device->held, 2);
    EXPECT_EQ(table.evidence->device->interpolated, 3);
    EXPECT_EQ(table.evidence->device->by_chance, 0.25);
    ASSERT_EQ(table.rows.size(), 17U);
    EXPECT_FALSE(table.rows[0].manoeuvre_mps2 || table.rows[0].manoeuvre_up_mps2);
    EXPECT_EQ(table.rows[1].manoeuvre_mps2, 6.125);
    EXPECT_FALSE(table.rows[1].manoeuvre_up_mps2);
    EXPECT_FALSE(table.rows[5].manoeuvre_mps2);
    EXPECT_EQ(table.rows[5].manoeuvre_up_mps2, 0.875);
    EXPECT_EQ(table.rows[11].manoeuvre_mps2, 2.25);
    EXPECT_EQ(table.rows[11].manoeuvre_up_mps2, 0.375);
}

TEST(GoldenEvidence, JerkDensityOfEachEpoch) {
    const auto rows = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").rows;
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[0].jerk_density, 0.6125);
    EXPECT_EQ(rows[0].jerk_density_up, 0.6);
    EXPECT_EQ(rows[2].jerk_density, 1.9375);
    EXPECT_EQ(rows[3].jerk_density, 6.125);
    EXPECT_EQ(rows[3].jerk_density_up, 0.75);
    EXPECT_FALSE(rows[4].jerk_density || rows[4].jerk_density_up);  // outside arcs
}

TEST(GoldenEvidence, WhatOtherEstimatesSayOfAWindow) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.own_standard_uncertainty_mps, 0.01125);
    ASSERT_TRUE(best.estimates);
    EXPECT_EQ(best.estimates->chord_mps, 56.3775);
    EXPECT_EQ(best.estimates->chord_difference_uncertainty_mps, 0.00125);
    EXPECT_EQ(best.estimates->stiffer_mps, 56.374);
    EXPECT_EQ(best.estimates->softer_mps, 56.3765);
    EXPECT_EQ(best.estimates->whole_mps, 56.3755);
    EXPECT_EQ(best.estimates->half_width_mps, 0.0015);
    EXPECT_EQ(best.bound->along, 1.125);
    const ProfileWindows& course = windows.profiles.at(3);
    EXPECT_FALSE(course.best->estimates || course.best->own_standard_uncertainty_mps);
}

TEST(GoldenEvidence, WhatMayRemainOfTheBiasOfChoosing) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.selection->fitted_bias_mps, 0.001);
    EXPECT_EQ(best.selection->bounded_bias_mps, 0.0015);
    EXPECT_EQ(best.selection->bias_mps, 0.00125);
    EXPECT_EQ(best.selection->bias_half_range_mps, 0.00025);
    EXPECT_EQ(best.bias_limit_mps, 0.0015);
    EXPECT_EQ(figure_of(windows.profiles[0])->bias_limit_mps, 0.0015);
    const ProfileWindows& mean = windows.profiles.at(2);
    EXPECT_EQ(mean.best->bias_limit_mps, 0.0025);
    EXPECT_EQ(mean.further.at(0).bias_limit_mps, 0.005);
    EXPECT_EQ(figure_of(mean)->bias_limit_mps, 0.00375);
}

TEST(GoldenEvidence, DecisionAndWitnesses) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    ASSERT_EQ(verdict.profiles.size(), 3U);
    const ProfileVerdict& nalsa = verdict.profiles[0];
    EXPECT_EQ(nalsa.decision->attempts_made, 2);
    EXPECT_EQ(nalsa.decision->level, 0.9875);
    EXPECT_EQ(nalsa.decision->bias_limit_mps, 0.0015);
    EXPECT_FALSE(nalsa.decision->drift_survived_m);
    EXPECT_EQ(nalsa.decision->drift_found_mps, 0.75);
    EXPECT_EQ(nalsa.witnesses,
              (std::vector<std::string>{"the recorded velocities agree within 0.25 km/h",
                                        "the second receiver gives 202.875 km/h"}));
    const ProfileVerdict& beaten = verdict.profiles[2];
    EXPECT_EQ(beaten.decision->attempts_made, 1);
    EXPECT_EQ(beaten.decision->drift_survived_m, 1.270278);
    EXPECT_EQ(beaten.decision->drift_found_mps, 0.5);
    EXPECT_TRUE(beaten.witnesses.empty());
}

TEST(GoldenEvidence, BestOfADay) {
    const DayResults day = read_day_results(text_of("v1.1/day_results.yaml"), "f");
    const DayResult& result = *day.attempts.at(0).by("nalsa");
    EXPECT_EQ(result.probability, 0.999999875);
    EXPECT_EQ(result.level, 0.9875);
    EXPECT_EQ(result.attempts_made, 2);
    ASSERT_TRUE(day.profiles.at(0).best);
    EXPECT_EQ(day.profiles[0].best->id, "sail-1");
    EXPECT_EQ(day.profiles[0].best->attempts, 3);
    EXPECT_EQ(day.profiles[0].best->probability, 0.999999875);
    EXPECT_EQ(day.profiles[0].best->level, 0.991666667);
    EXPECT_TRUE(day.profiles[0].best->beaten);
}

TEST(GoldenEvidence, EarlierInputsHaveNoneOfIt) {
    const Attempt attempt = read_attempt(text_of("v1.5/attempt.yaml"), "f");
    EXPECT_EQ(attempt.attempts_made, 1);
    EXPECT_EQ(attempt.receivers.at(0).solution, "");
    EXPECT_EQ(attempt.receivers.at(0).time_source, "");
    EXPECT_EQ(attempt.parameters.at("window").at("clock_rate_bound"), 0.0001);
    const DayResults day = read_day_results(text_of("v1.0/day_results.yaml"), "f");
    EXPECT_FALSE(day.attempts.at(0).results.at(0).probability || day.profiles.at(0).best);
    EXPECT_EQ(day.attempts.at(0).results.at(0).attempts_made, 1);
}

/// No revision of its own: what a rule leaves out has the default of today's program.
TEST(GoldenEvidence, ARuleThatSaysNothingOfUncertaintyHasTodaysDefaults) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_TRUE(profile.uncertainty.subtract_selection_bias);
    EXPECT_EQ(profile.uncertainty.error_floor_m.at("unknown"), 0.5);
}

}  // namespace
}  // namespace runcert
