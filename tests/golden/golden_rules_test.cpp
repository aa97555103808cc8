#include "golden_files.h"

// What attempt/1.4, profile/1.3, windows/1.3 and verdict/1.1 added for rules of every kind.

namespace runcert {
namespace {

using golden::text_of;

TEST(GoldenRules, AttemptOnTheEarth) {
    const Attempt attempt = read_attempt(text_of("v1.4/attempt.yaml"), "f");
    EXPECT_EQ(attempt.record->expanded_uncertainty, 0.25);
    EXPECT_EQ(attempt.record_for("nalsa")->speed, 202.9);
    EXPECT_EQ(attempt.record_for("my-rule")->speed, 50.25);
    EXPECT_EQ(attempt.record_for("my-rule")->expanded_uncertainty, 0.125);
    ASSERT_EQ(attempt.rules.size(), 2U);
    EXPECT_EQ(attempt.rules[0].figure, "margin.value");
    EXPECT_EQ(attempt.rules[0].value, 1.5);
    EXPECT_EQ(attempt.rules[0].reason, "as agreed beforehand");
    EXPECT_EQ(attempt.rules[1].profile, "my-rule");
    EXPECT_EQ(attempt.rules[1].value, 25.0);
    ASSERT_TRUE(attempt.course && attempt.wind && attempt.current && attempt.secondary_method);
    EXPECT_EQ(attempt.course->length_m, 502.25);
    EXPECT_EQ(attempt.course->length_expanded_uncertainty_m, 0.0125);
    EXPECT_EQ(attempt.course->start.left.geodetic->latitude.degrees(), 35.134875);
    EXPECT_EQ(attempt.course->start.right.geodetic->longitude.degrees(), 136.9775);
    EXPECT_EQ(attempt.course->finish.left.geodetic->longitude.degrees(), 136.980375);
    EXPECT_EQ(attempt.course->finish.right.geodetic->latitude.degrees(), 35.1385);
    EXPECT_EQ(attempt.parameters.at("screen").at("noise_scale_min"), 0.25);
    EXPECT_EQ(attempt.wind->file, "weather/wind.csv");
    EXPECT_EQ(attempt.wind->source, "mast at the start");
    EXPECT_EQ(attempt.current->expanded_uncertainty_mps, 0.0625);
    EXPECT_EQ(attempt.secondary_method->method, "light gates");
    EXPECT_EQ(to_iso(attempt.secondary_method->times->start), "2022-03-18T08:51:36.250");
    EXPECT_EQ(to_iso(attempt.secondary_method->times->finish), "2022-03-18T08:51:45.125");
    EXPECT_EQ(attempt.secondary_method->times->expanded_uncertainty_s, 0.0025);
    EXPECT_FALSE(attempt.secondary_method->speed);
}

TEST(GoldenRules, AttemptInAPlane) {
    const Attempt attempt = read_attempt(text_of("v1.4/attempt.plane.yaml"), "f");
    EXPECT_EQ(attempt.profiles.size(), 7U);
    EXPECT_EQ(attempt.profiles.at(0), "gps-speed-sailing-2s");
    EXPECT_EQ(attempt.profiles.at(6), "gps-speed-sailing-alpha-500");
    EXPECT_EQ(*attempt.course->start.left.plane_m, Eigen::Vector2d(-10.5, 0.25));
    EXPECT_EQ(*attempt.course->start.right.plane_m, Eigen::Vector2d(10.5, -0.25));
    EXPECT_EQ(*attempt.course->finish.left.plane_m, Eigen::Vector2d(-12.5, 500.125));
    EXPECT_EQ(*attempt.course->finish.right.plane_m, Eigen::Vector2d(12.5, 499.875));
    EXPECT_DOUBLE_EQ(attempt.secondary_method->speed->speed_mps, 50.5 * 1852.0 / 3600.0);
    EXPECT_DOUBLE_EQ(attempt.secondary_method->speed->expanded_uncertainty_mps,
                     0.25 * 1852.0 / 3600.0);
    EXPECT_FALSE(attempt.secondary_method->times);
}

TEST(GoldenRules, EarlierAttemptsHaveNoneOfIt) {
    for (const char* file : {"v1.0/attempt.yaml", "v1.3/attempt.yaml"}) {
        const Attempt attempt = read_attempt(text_of(file), "f");
        EXPECT_EQ(attempt.record->expanded_uncertainty, 0.0);
        EXPECT_TRUE(attempt.records.empty() && attempt.rules.empty());
        EXPECT_FALSE(attempt.course || attempt.wind || attempt.current || attempt.secondary_method);
    }
}

TEST(GoldenRules, ProfileOfAStretch) {
    const Profile profile = read_profile(text_of("v1.3/profile.yaml"), "f");
    EXPECT_EQ(profile.window_kind, "time");
    EXPECT_EQ(profile.duration_s, 10.0);
    EXPECT_EQ(profile.dimension, "vertical");
    EXPECT_EQ(profile.speed_source, "position");
    EXPECT_TRUE(profile.exact_duration && profile.repaired_steps);
    EXPECT_FALSE(profile.ends_anywhere);
    EXPECT_EQ(profile.windows, 1);
    EXPECT_EQ(profile.proximity_m, 25.0);
    EXPECT_EQ(profile.turn_deg, 120.0);
    EXPECT_EQ(profile.runs.start_mps, 4.0);
    EXPECT_EQ(profile.runs.stop_mps, 0.5);
    EXPECT_EQ(profile.runs.stop_s, 2.5);
    EXPECT_EQ(profile.runs.turn_deg, 60.0);
    EXPECT_EQ(profile.opposite_runs_within_s, 1800.0);
    EXPECT_TRUE(profile.margin_above_upper_limit && !profile.subtract_current);
    EXPECT_EQ(profile.result->mode, "truncate");
    EXPECT_EQ(profile.result->unit, "mph");
    EXPECT_EQ(profile.result->decimals, 1);
    EXPECT_EQ(profile.decision_probability, 0.95);
    ASSERT_EQ(profile.clauses.size(), 18U);
    const struct {
        std::size_t clause;
        const char *computation, *unit;
        std::optional<double> limit;
    } expected[] = {{6, "flatness", "m", 1.0},
                    {7, "slope", "%", 2.0},
                    {8, "straightness", "m", 5.0},
                    {9, "turning", "deg", 10.0},
                    {10, "standing_start", "", std::nullopt},
                    {11, "run_up", "m", 300.0},
                    {12, "wind_mean", "kn", 20.0},
                    {13, "wind_gust", "km/h", 50.0},
                    {14, "current", "mph", 1.0},
                    {15, "sampling_rate", "Hz", 5.0},
                    {16, "sample_accuracy", "m/s", 3.0},
                    {17, "opposite_runs", "", std::nullopt}};
    for (const auto& each : expected) {
        EXPECT_EQ(profile.clauses[each.clause].decided_by, each.computation);
        EXPECT_EQ(profile.clauses[each.clause].unit, each.unit);
        EXPECT_EQ(profile.clauses[each.clause].limit, each.limit);
    }
}

TEST(GoldenRules, ProfileOfACourse) {
    const Profile profile = read_profile(text_of("v1.3/profile.course.yaml"), "f");
    EXPECT_EQ(profile.window_kind, "course");
    EXPECT_EQ(profile.distance_m, 500.0);
    EXPECT_EQ(profile.definition, "elapsed_time");
    EXPECT_TRUE(profile.ends_anywhere);
    EXPECT_EQ(profile.margin_kind, "elapsed_time");
    EXPECT_EQ(profile.margin, 0.0125);
    EXPECT_TRUE(profile.subtract_current);
    const Profile before = read_profile(text_of("v1.2/profile.yaml"), "f");
    EXPECT_EQ(before.window_kind, "time");
    EXPECT_EQ(before.windows, 1);
    EXPECT_EQ(before.decision_probability, 0.975);
}

TEST(GoldenRules, Windows) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    ASSERT_EQ(windows.profiles.size(), 5U);
    EXPECT_EQ(windows.profiles[0].rule,
              (WindowRule{.duration_s = 3.0, .definition = "displacement"}));
    EXPECT_EQ(windows.profiles[0].best->length_m, 169.125);
    const ProfileWindows& mean = windows.profiles[2];
    EXPECT_EQ(mean.rule, (WindowRule{.duration_s = 2.0,
                                     .definition = "mean_n",
                                     .dimension = "space",
                                     .source = "velocity",
                                     .exact = true,
                                     .count = 2}));
    ASSERT_EQ(mean.further.size(), 1U);
    EXPECT_EQ(mean.further[0].span.first_epoch, 81);
    EXPECT_EQ(mean.further[0].span.start.nanoseconds, 8'000'000'000);
    EXPECT_EQ(to_iso(*mean.further[0].span.start_gps), "2022-03-18T08:51:30.300");
    EXPECT_EQ(mean.further[0].speed_mps, 56.75);
    EXPECT_EQ(mean.further[0].standard_uncertainty_mps, 0.046875);
    EXPECT_EQ(mean.further[0].robust->difference_mps, -0.25);
    EXPECT_FALSE(mean.further[0].robust->agrees);
    EXPECT_EQ(figure_of(mean)->speed_mps, 57.0);
    EXPECT_EQ(figure_of(mean)->standard_uncertainty_mps, 0.0390625);
    EXPECT_EQ(mean.indicated->mean_mps, 57.875);
    const ProfileWindows& course = windows.profiles[3];
    EXPECT_EQ(
        course.rule,
        (WindowRule{
            .kind = "course", .distance_m = 500.0, .definition = "elapsed_time", .ends = "any"}));
    EXPECT_EQ(course.best->span.start.nanoseconds, 13'962'500'125);
    EXPECT_EQ(course.best->length_m, 502.25);
    const ProfileWindows& pair = windows.profiles[4];
    EXPECT_TRUE(pair.rule.opposite_runs);
    EXPECT_EQ(pair.missing, "no two runs in opposite directions");
    EXPECT_FALSE(figure_of(pair));
}

TEST(GoldenRules, RequirementsAndOutcome) {
    const ProfileVerdict nalsa = read_verdict(text_of("v1.0/6-verdict.yaml"), "f").profiles.at(0);
    ASSERT_EQ(nalsa.requirements.size(), 4U);
    EXPECT_EQ(nalsa.requirements[0].decided_by, "window_complete");
    EXPECT_TRUE(nalsa.requirements[0].figures.empty());
    ASSERT_EQ(nalsa.requirements[1].figures.size(), 3U);
    EXPECT_EQ(nalsa.requirements[1].figures[0].name, "speed");
    EXPECT_EQ(nalsa.requirements[1].figures[0].note, "best window");
    EXPECT_EQ(nalsa.requirements[1].figures[1].value, 204.509344);
    EXPECT_EQ(nalsa.requirements[1].figures[1].expanded_uncertainty, 0.125);
    EXPECT_EQ(nalsa.requirements[1].figures[2].unit, "");
    EXPECT_FALSE(nalsa.requirements[1].figures[2].expanded_uncertainty);
    EXPECT_EQ(nalsa.requirements[3].figures.at(0).unit, "m");
    EXPECT_EQ(nalsa.record->speed, 126.1);
    EXPECT_EQ(nalsa.record->expanded_uncertainty, 0.05);
    EXPECT_DOUBLE_EQ(nalsa.record->speed_mps, 202.9383 / 3.6);
    EXPECT_EQ(nalsa.decision->probability, 1.25e-7);
    EXPECT_EQ(nalsa.decision->level, 0.9875);
    EXPECT_EQ(nalsa.decision->target_standard_uncertainty_mps, 0.017361);
    EXPECT_EQ(nalsa.decision->acceptance_limit_mps, 56.850076);
    EXPECT_EQ(nalsa.shown->unit, "mph");
    EXPECT_EQ(nalsa.shown->speed, "126.10");
    EXPECT_EQ(nalsa.shown->expanded_uncertainty, "0.06");
    EXPECT_EQ(nalsa.shown->target, "127.08");
    EXPECT_EQ(nalsa.current_subtracted_mps, -0.03125);
}

TEST(GoldenRules, WhatMustBeReadWithTheVerdict) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    const ProfileVerdict& nalsa = verdict.profiles.at(0);
    EXPECT_EQ(nalsa.notes.at(0), "The window begins 1.2 s after a turn.");
    ASSERT_EQ(nalsa.overrides.size(), 2U);
    EXPECT_EQ(nalsa.overrides[0].figure, "margin.value");
    EXPECT_EQ(nalsa.overrides[0].rule, 1.0);
    EXPECT_EQ(nalsa.overrides[0].used, 0.5);
    EXPECT_EQ(nalsa.overrides[0].reason, "as agreed beforehand");
    EXPECT_EQ(nalsa.overrides[1].unit, "");
    ASSERT_EQ(nalsa.course.size(), 3U);
    EXPECT_EQ(nalsa.course[0].value, 45.125);
    EXPECT_EQ(nalsa.course[2].expanded_uncertainty, 0.000125);
    ASSERT_EQ(nalsa.runs.size(), 2U);
    EXPECT_EQ(nalsa.runs[0].span.last_epoch, 240);
    EXPECT_EQ(nalsa.runs[0].length_m, 812.625);
    EXPECT_EQ(nalsa.runs[0].top_speed_mps, 56.5);
    EXPECT_EQ(nalsa.runs[0].ended, "turn");
    EXPECT_EQ(nalsa.runs[1].heading_deg, 224.5);
    EXPECT_EQ(nalsa.runs[1].began, "gap");
    EXPECT_EQ(to_iso(*nalsa.runs[1].span.start_gps), "2022-03-18T08:51:46.300");
    const ProfileVerdict& fisly = verdict.profiles.at(1);
    EXPECT_FALSE(fisly.record || fisly.decision || fisly.shown || fisly.current_subtracted_mps);
    EXPECT_TRUE(fisly.notes.empty() && fisly.overrides.empty() && fisly.runs.empty());
}

}  // namespace
}  // namespace runcert
