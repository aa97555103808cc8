#include "golden_files.h"

// Windows, verdict and day: what today's reader finds in their golden files.

namespace runcert::RUNCERT_FILE {
namespace {

using golden::text_of;

TEST(GoldenWindows, Best) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    ASSERT_EQ(windows.profiles.size(), 5U);
    const ProfileWindows& nalsa = windows.profiles[0];
    EXPECT_EQ(nalsa.candidates, 271);
    ASSERT_TRUE(nalsa.best && nalsa.indicated);
    EXPECT_EQ(nalsa.best->span.start.nanoseconds, 10'000'000'000);
    EXPECT_EQ(nalsa.best->span.duration.nanoseconds, 3'000'000'000);
    EXPECT_EQ(to_iso(*nalsa.best->span.start_gps), "2022-03-18T08:51:32.300");
    EXPECT_EQ(nalsa.best->speed_m_s, 56.375);
    EXPECT_EQ(speed_by(nalsa.best->definitions, SpeedDefinition::mean_n), 56.385);
    EXPECT_EQ(nalsa.best->methods.kalman_m_s, 56.4);
    EXPECT_EQ(nalsa.indicated->refusals.at(1), "A gap of 0.3 s lies inside.");
    EXPECT_FALSE(windows.profiles[1].best || windows.profiles[1].indicated);
}

TEST(GoldenWindows, SayWhereTheCraftStood) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    ASSERT_EQ(windows.stands.size(), 1U);
    const Stand& stand = windows.stands[0];
    EXPECT_EQ(stand.from_s, 3.25);
    EXPECT_EQ(stand.to_s, 41.5);
    EXPECT_EQ(stand.shown_by, StandSource::imu);
    EXPECT_EQ(stand.pairs, 352);
    EXPECT_EQ(stand.drift_m_s, 0.0015);
    EXPECT_EQ(stand.moved_m, 0.0075);
    EXPECT_EQ(stand.stated_m, 0.014142);
    EXPECT_EQ(windows.profiles[0].best->bound->standing_m, 0.0065);
}

TEST(GoldenWindows, Uncertainty) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.effective_degrees_of_freedom, 47.25);
    EXPECT_EQ(best.fitted->models, 7);
    EXPECT_EQ(best.bound->tau_max_s, 10.0);
    EXPECT_EQ(best.bound->floor_fix, FixType::fixed);
    EXPECT_EQ(best.bound->decided_by, BoundSource::floor);
    EXPECT_EQ(best.robust->difference_m_s, -0.002);
    EXPECT_TRUE(best.robust->agrees);
    EXPECT_EQ(best.selection->best_sd_m_s, 0.00925);
    EXPECT_EQ(best.selection->treatment, SelectionTreatment::covered);
    ASSERT_EQ(best.budget.size(), 2U);
    EXPECT_EQ(best.budget[0].unit, "m");
    EXPECT_EQ(best.budget[0].degrees_of_freedom, 47.25);
    EXPECT_EQ(best.budget[1].unit, "");
    EXPECT_FALSE(best.budget[1].degrees_of_freedom);
    EXPECT_EQ(best.budget[1].standard_uncertainty, 0.00057735);
    EXPECT_EQ(best.monte_carlo->tolerance_m_s, 6.25e-5);
    EXPECT_EQ(best.definitions.mean_n_m_s, 56.385);
}

TEST(GoldenWindows, Reliability) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.detection_power, 0.8);
    ASSERT_EQ(best.reliability.size(), 3U);
    EXPECT_EQ(best.reliability[0].hypothesis, Hypothesis::step);
    EXPECT_EQ(best.reliability[0].speed_m_s, 0.020125);
    EXPECT_EQ(best.reliability[1].epoch, 110);
    EXPECT_EQ(best.reliability[1].last_epoch, 131);
    EXPECT_EQ(best.reliability[1].size, 0.001250125);
    EXPECT_EQ(best.reliability[1].unit, "s");
    EXPECT_EQ(best.reliability[2].unit, "m / s");
}

TEST(GoldenWindows, WhatOtherEstimatesSay) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.own_standard_uncertainty_m_s, 0.01125);
    ASSERT_TRUE(best.estimates);
    EXPECT_EQ(best.estimates->chord_m_s, 56.3775);
    EXPECT_EQ(best.estimates->chord_difference_uncertainty_m_s, 0.00125);
    EXPECT_EQ(best.estimates->stiffer_m_s, 56.374);
    EXPECT_EQ(best.estimates->softer_m_s, 56.3765);
    EXPECT_EQ(best.estimates->whole_m_s, 56.3755);
    EXPECT_EQ(best.estimates->half_width_m_s, 0.0015);
    EXPECT_EQ(best.bound->along, 1.125);
    const ProfileWindows& course = windows.profiles.at(3);
    EXPECT_FALSE(course.best->estimates || course.best->own_standard_uncertainty_m_s);
}

TEST(GoldenWindows, WhatMayRemainOfTheBiasOfChoosing) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    EXPECT_EQ(best.selection->fitted_bias_m_s, 0.001);
    EXPECT_EQ(best.selection->bounded_bias_m_s, 0.0015);
    EXPECT_EQ(best.selection->bias_m_s, 0.00125);
    EXPECT_EQ(best.selection->bias_half_range_m_s, 0.00025);
    EXPECT_EQ(best.bias_limit_m_s, 0.0015);
    EXPECT_EQ(figure_of(windows.profiles[0])->bias_limit_m_s, 0.0015);
    const ProfileWindows& mean = windows.profiles.at(2);
    EXPECT_EQ(mean.best->bias_limit_m_s, 0.0025);
    EXPECT_EQ(mean.best->expected_beside_velocities_m_s, 0.1875);
    EXPECT_EQ(mean.further.at(0).bias_limit_m_s, 0.005);
    EXPECT_EQ(figure_of(mean)->bias_limit_m_s, 0.00375);
}

TEST(GoldenWindows, EvidenceWhereEitherMayBeAtFault) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    const CertifiableWindow& best = windows.profiles.at(0).best.value();
    const SpeedEvidence& evidence = best.evidence.value();
    EXPECT_EQ(evidence.fault_probability, 0.002);
    EXPECT_EQ(evidence.chosen_fault_probability, 0.012);
    EXPECT_EQ(evidence.at_five_times_m_s, 0.5);
    EXPECT_EQ(evidence.difference_m_s, -0.0625);
    EXPECT_EQ(evidence.witnesses.at(0).difference_m_s, 0.125);
    EXPECT_EQ(evidence.witnesses.at(1).slow_standard_uncertainty_m_s, 0.03125);
    EXPECT_EQ(evidence.disagreement, 0.375);
    EXPECT_FALSE(best.witnesses.at(0).confirms);
    EXPECT_EQ(best.witnesses[0].fault_posterior, 0.000125);
    EXPECT_EQ(best.witnesses[0].chance_error, 0.25);
    // Written before either: by the normalised error.
    EXPECT_TRUE(best.witnesses.at(1).confirms);
    EXPECT_FALSE(best.witnesses[1].fault_posterior);
}

TEST(GoldenWindows, OfEveryKind) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    ASSERT_EQ(windows.profiles.size(), 5U);
    EXPECT_EQ(windows.profiles[0].rule,
              (WindowRule{.duration_s = 3.0, .definition = SpeedDefinition::displacement}));
    EXPECT_EQ(windows.profiles[0].best->length_m, 169.125);
    const ProfileWindows& mean = windows.profiles[2];
    EXPECT_EQ(mean.rule, (WindowRule{.duration_s = 2.0,
                                     .definition = SpeedDefinition::mean_n,
                                     .dimension = Dimension::space,
                                     .source = SpeedSource::velocity,
                                     .exact = true,
                                     .count = 2}));
    ASSERT_EQ(mean.further.size(), 1U);
    EXPECT_EQ(mean.further[0].span.first_epoch, 81);
    EXPECT_EQ(mean.further[0].span.start.nanoseconds, 8'000'000'000);
    EXPECT_EQ(to_iso(*mean.further[0].span.start_gps), "2022-03-18T08:51:30.300");
    EXPECT_EQ(mean.further[0].speed_m_s, 56.75);
    EXPECT_EQ(mean.further[0].standard_uncertainty_m_s, 0.046875);
    EXPECT_EQ(mean.further[0].robust->difference_m_s, -0.25);
    EXPECT_FALSE(mean.further[0].robust->agrees);
    EXPECT_EQ(figure_of(mean)->speed_m_s, 57.0);
    EXPECT_EQ(figure_of(mean)->standard_uncertainty_m_s, 0.0390625);
    EXPECT_EQ(mean.indicated->mean_m_s, 57.875);
    const ProfileWindows& course = windows.profiles[3];
    EXPECT_EQ(course.rule, (WindowRule{.kind = WindowKind::course,
                                       .distance_m = 500.0,
                                       .definition = SpeedDefinition::elapsed_time,
                                       .ends = WindowEnds::any}));
    EXPECT_EQ(course.best->span.start.nanoseconds, 13'962'500'125);
    EXPECT_EQ(course.best->length_m, 502.25);
    const ProfileWindows& pair = windows.profiles[4];
    EXPECT_TRUE(pair.rule.opposite_runs);
    EXPECT_EQ(pair.missing, "no two runs in opposite directions");
    EXPECT_FALSE(figure_of(pair));
}

TEST(GoldenVerdict, Outcomes) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    EXPECT_EQ(verdict.attempt, "urban-car");
    EXPECT_EQ(verdict.record->speed, 202.9);
    EXPECT_DOUBLE_EQ(verdict.record->speed_m_s, 202.9 / 3.6);
    const ProfileVerdict& nalsa = verdict.profiles.at(0);
    EXPECT_EQ(nalsa.outcome, Outcome::not_beaten);
    EXPECT_EQ(nalsa.speed_m_s, 56.375);
    EXPECT_EQ(nalsa.required_speed_m_s, 56.808151);
    EXPECT_EQ(nalsa.window->last_epoch, 131);
    EXPECT_EQ(nalsa.requirements.at(2).status, RequirementStatus::attest);
    EXPECT_EQ(nalsa.indicated->speed_m_s, 57.5);
    EXPECT_FALSE(verdict.profiles.at(1).speed_m_s);
}

TEST(GoldenVerdict, RequirementsAndOutcome) {
    const ProfileVerdict nalsa = read_verdict(text_of("v1.0/6-verdict.yaml"), "f").profiles.at(0);
    ASSERT_EQ(nalsa.requirements.size(), 4U);
    EXPECT_EQ(nalsa.requirements[0].decided_by, Computation::window_complete);
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
    EXPECT_DOUBLE_EQ(nalsa.record->speed_m_s, 202.9383 / 3.6);
    EXPECT_EQ(nalsa.decision->probability, 1.25e-7);
    EXPECT_EQ(nalsa.decision->level, 0.9875);
    EXPECT_EQ(nalsa.decision->required_speed_standard_uncertainty_m_s, 0.017361);
    EXPECT_EQ(nalsa.decision->acceptance_limit_m_s, 56.850076);
    EXPECT_EQ(nalsa.shown->unit, "mph");
    EXPECT_EQ(nalsa.shown->speed, "126.10");
    EXPECT_EQ(nalsa.shown->expanded_uncertainty, "0.06");
    EXPECT_EQ(nalsa.shown->required_speed, "127.08");
    EXPECT_EQ(nalsa.shown->acceptance_limit, "127.13");
    EXPECT_EQ(nalsa.current_subtracted_m_s, -0.03125);
}

TEST(GoldenVerdict, WhatMustBeReadWithTheVerdict) {
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
    EXPECT_EQ(nalsa.runs[0].top_speed_m_s, 56.5);
    EXPECT_EQ(nalsa.runs[0].ended, RunEdge::turn);
    EXPECT_EQ(nalsa.runs[1].heading_deg, 224.5);
    EXPECT_EQ(nalsa.runs[1].began, RunEdge::gap);
    EXPECT_EQ(to_iso(*nalsa.runs[1].span.start_gps), "2022-03-18T08:51:46.300");
    const ProfileVerdict& fisly = verdict.profiles.at(1);
    EXPECT_FALSE(fisly.record || fisly.decision || fisly.shown || fisly.current_subtracted_m_s);
    EXPECT_TRUE(fisly.notes.empty() && fisly.overrides.empty() && fisly.runs.empty());
}

TEST(GoldenVerdict, DecisionAndWitnesses) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    ASSERT_EQ(verdict.profiles.size(), 3U);
    const ProfileVerdict& nalsa = verdict.profiles[0];
    EXPECT_EQ(nalsa.decision->attempts_made, 2);
    EXPECT_EQ(nalsa.decision->level, 0.9875);
    EXPECT_EQ(nalsa.decision->bias_limit_m_s, 0.0015);
    EXPECT_FALSE(nalsa.decision->drift_survived_m);
    EXPECT_EQ(nalsa.decision->drift_found_m_s, 0.75);
    EXPECT_EQ(nalsa.decision->by_uncertainty, 1.5e-7);
    EXPECT_EQ(nalsa.decision->by_faults, 1.25e-7);
    EXPECT_EQ(nalsa.decision->tail_risk, 1e-4);
    EXPECT_EQ(nalsa.decision->tail_speed_m_s, 55.125);
    EXPECT_EQ(nalsa.witnesses,
              (std::vector<std::string>{"the recorded velocities agree within 0.25 km/h",
                                        "the second receiver gives 202.875 km/h"}));
    const ProfileVerdict& beaten = verdict.profiles[2];
    EXPECT_EQ(beaten.decision->attempts_made, 1);
    EXPECT_EQ(beaten.decision->drift_survived_m, 1.270278);
    EXPECT_EQ(beaten.decision->drift_found_m_s, 0.5);
    EXPECT_TRUE(beaten.witnesses.empty());
}

TEST(GoldenVerdict, RiskOfTheDecision) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
    ASSERT_TRUE(verdict.profiles.at(0).decision);
    EXPECT_EQ(verdict.profiles[0].decision->risk, 1.25e-7);
}

TEST(GoldenDayResults, Best) {
    const DayResults day = read_day_results(text_of("v1.0/day_results.yaml"), "f");
    const DayResult& result = *result_by(day.attempts.at(0), "nalsa");
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

}  // namespace
}  // namespace runcert::RUNCERT_FILE
