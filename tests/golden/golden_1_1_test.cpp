#include "golden_files.h"

// What revision 1.1 added, as today's reader finds it in the files of 1.1; and that what came later
// is not told there.

namespace runcert {
namespace {

using golden::text_of;

TEST(Golden11, TheFactsOfARecordingStandInEveryTable) {
    const RecordingFacts facts[] = {
        read_observations(text_of("v1.0/1-observations.ecsv"), "f").facts,
        read_enu(text_of("v1.0/2-enu.ecsv"), "f").facts,
        read_screened(text_of("v1.0/3-screened.ecsv"), "f").facts,
        read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f").facts};
    for (const RecordingFacts& each : facts) {
        EXPECT_EQ(each.position_resolution_m, 0.0001);
        EXPECT_EQ(each.time_resolution_s, 0.001);
    }
}

TEST(Golden11, Trajectory) {
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    EXPECT_EQ(table.rows.at(1).robust_east_m, -0.181875);
    EXPECT_EQ(table.rows.at(1).robust_north_m, 2.10775);
    EXPECT_EQ(table.rows.at(2).robust_weight, 0.125);
    EXPECT_FALSE(table.rows.at(3).robust_weight);
    EXPECT_FALSE(table.rows.at(4).robust_east_m);
    EXPECT_EQ(table.estimation.batch_stretches, 2);
    EXPECT_EQ(table.estimation.robust_downweighted, 1);
    ASSERT_TRUE(table.estimation.horizontal && table.estimation.vertical);
    const NoiseSummary& noise = table.estimation.horizontal->noise;
    EXPECT_EQ(noise.status, "fitted");
    EXPECT_EQ(noise.jerk_density.value, 0.6125);
    EXPECT_EQ(noise.jerk_density.relative_uncertainty, 0.0875);
    EXPECT_EQ(noise.acceleration_time_s->value, 4.5);
    EXPECT_TRUE(noise.error_tau_s->at_bound);
    EXPECT_EQ(noise.error_tau_s->relative_uncertainty, 1.75);
    ASSERT_EQ(noise.posterior.size(), 2U);
    EXPECT_EQ(noise.posterior[0].acceleration_time_s, 4.5);
    EXPECT_FALSE(noise.posterior[1].acceleration_time_s);
    EXPECT_EQ(noise.posterior[1].weight, 0.25);
    EXPECT_EQ(table.estimation.horizontal->health.largest_asymmetry, 1.25e-16);
    EXPECT_EQ(table.estimation.horizontal->health.spans_outside, 1);
    EXPECT_EQ(table.estimation.vertical->noise.status, "constant_positions");
    EXPECT_EQ(table.estimation.vertical->health.repaired, 3);
    EXPECT_FALSE(table.estimation.vertical->health.consistent);
}

TEST(Golden11, Windows) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.effective_degrees_of_freedom, 47.25);
    EXPECT_EQ(best.fitted->models, 7);
    EXPECT_EQ(best.bound->tau_max_s, 10.0);
    EXPECT_EQ(best.bound->floor_fix, "fixed");
    EXPECT_EQ(best.bound->decided_by, "floor");
    EXPECT_EQ(best.robust->difference_mps, -0.002);
    EXPECT_TRUE(best.robust->agrees);
    EXPECT_EQ(best.selection->best_sd_mps, 0.00925);
    EXPECT_EQ(best.selection->treatment, "covered");
    ASSERT_EQ(best.budget.size(), 2U);
    EXPECT_EQ(best.budget[0].unit, "m");
    EXPECT_EQ(best.budget[0].degrees_of_freedom, 47.25);
    EXPECT_EQ(best.budget[1].unit, "");
    EXPECT_FALSE(best.budget[1].degrees_of_freedom);
    EXPECT_EQ(best.budget[1].standard_uncertainty, 0.00057735);
    EXPECT_EQ(best.monte_carlo->tolerance_mps, 6.25e-5);
    EXPECT_EQ(best.definitions.mean_n_mps, 56.385);
}

TEST(Golden11, AttemptFile) {
    const Attempt attempt = read_attempt(text_of("v1.1/attempt.yaml"), "f");
    EXPECT_EQ(attempt.receivers.at(0).rotation_bound_deg, 7.5);
    EXPECT_FALSE(attempt.receivers.at(1).rotation_bound_deg);
    EXPECT_EQ(attempt.parameters.at("smooth").at("motion_model"), "singer");
    EXPECT_EQ(attempt.parameters.at("smooth").at("error_time_max_s"), 20);
    EXPECT_EQ(attempt.parameters.at("window").at("plane_scale_bound"), 0.0004);
    EXPECT_EQ(attempt.overrides.size(), 20U);
    EXPECT_EQ(attempt.parameters.at("screen").at("family_false_alarm_rate"), 0.001);
}

TEST(Golden11, ProfileFile) {
    const Profile profile = read_profile(text_of("v1.1/profile.yaml"), "f");
    EXPECT_EQ(profile.uncertainty.tau_min_s, 1.0);
    EXPECT_EQ(profile.uncertainty.tau_max_s, 30.0);
    EXPECT_TRUE(profile.uncertainty.subtract_selection_bias);
    EXPECT_EQ(profile.uncertainty.error_floor_m,
              (std::map<std::string, double>{{"fixed", 0.015},
                                             {"float", 0.25},
                                             {"ppp", 0.125},
                                             {"dgps", 0.75},
                                             {"sbas", 0.625},
                                             {"single", 1.5},
                                             {"dead_reckoning", 2.0},
                                             {"unknown", 0.03125}}));
}

}  // namespace
}  // namespace runcert
