#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "stages/check/notes.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A georeferenced recording with heights and a date whose horizontal noise was fitted and fared
/// well.
struct Scene {
    Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    ReceiverFindings judged;

    Scene() {
        judged.receiver = "primary";
        judged.accuracy_source = "recording";
        judged.facts.first_epoch = GpsTime::from_week(2201, 463'000'000'000'000);
        judged.estimation.arcs = 1;
        judged.estimation.horizontal = AxesEstimation{};
        NoiseSummary& fit = noise();
        fit.status = NoiseBasis::fitted;
        fit.epochs = 451;
        fit.epochs_needed = 30;
        fit.stated_sigma_m = 0.010;
        fit.jerk_density.value = 0.612;
        fit.measurement_scale.value = 1.04;
        fit.converged = true;
        health().white = health().consistent = true;
    }
    NoiseSummary& noise() { return judged.estimation.horizontal.noise; }
    FilterHealth& health() { return judged.estimation.horizontal.health; }
    void tell_error(std::optional<double> tau_uncertainty) {
        noise().correlated_error_detected = true;
        noise().error_diffusion = NoiseParameter{0.008, 0.1, false};
        noise().error_tau_s = NoiseParameter{2.0, tau_uncertainty, false};
        noise().error_sigma_m = NoiseParameter{0.0081, std::nullopt, false};
    }
    /// How many of the statements hold all of these words.
    int count(const std::vector<std::string>& words) const {
        int found = 0;
        for (const std::string& statement :
             statements_of({.attempt = attempt, .profiles = profiles, .judged = judged})) {
            bool all = true;
            for (const std::string& word : words)
                all = all && statement.find(word) != std::string::npos;
            found += all ? 1 : 0;
        }
        return found;
    }
};

TEST(Statements, OfAGoodFitSayWhatWasLearntAndNothingIsAmiss) {
    const Scene scene;
    EXPECT_EQ(scene.count({"horizontal noise was estimated from 451 epochs", "1.04 times",
                           "root mean square 10.0 mm",
                           "jerk density 0.612 m s^-2.5 as one for "
                           "all of it",
                           "takes the larger of that and what the motion shows there"}),
              1);
    EXPECT_EQ(
        scene.count({"time-correlated error of the horizontal positions could not be separated",
                     "its bound decides"}),
        1);
    EXPECT_EQ(scene.count({"Stated standard deviations come from the recording."}), 1);
    for (const char* amiss : {"limit of its range", "before it converged", "stay correlated",
                              "changes along the recording", "were repaired", "Not georeferenced",
                              "Heights", "equal at all epochs", "vertical"})
        EXPECT_EQ(scene.count({amiss}), 0) << amiss;
    // Each statement is a sentence.
    for (const std::string& statement : statements_of(
             {.attempt = scene.attempt, .profiles = scene.profiles, .judged = scene.judged}))
        EXPECT_EQ(statement.back(), '.') << statement;
}

TEST(Statements, WhyNothingWasFittedAndWhatStandsInItsPlace) {
    Scene scene;
    scene.noise().status = NoiseBasis::too_few_epochs;
    scene.noise().epochs = 20;
    scene.noise().jerk_density.value = 0.6;
    EXPECT_EQ(scene.count({"could not be estimated", "20 usable epochs where 30 are required",
                           "stated standard deviations times 1.04", "0.6 m s^-2.5"}),
              1);
    scene.noise().status = NoiseBasis::constant_positions;
    EXPECT_EQ(scene.count({"could not be estimated", "positions are all the same"}), 1);
    scene.noise().status = NoiseBasis::stated;
    EXPECT_EQ(scene.count({"was not estimated from the recording, as the attempt asks"}), 1);
    EXPECT_EQ(scene.count({"could not be told"}), 0);
}

TEST(Statements, WhatIsKnownOfASlowError) {
    Scene scene;
    scene.tell_error(0.3);
    EXPECT_EQ(scene.count({"time-correlated error of 8.1 mm", "correlation time of 2.0 s"}), 1);
    EXPECT_EQ(scene.count({"its bound decides"}), 0);
    scene.tell_error(std::nullopt);
    EXPECT_EQ(scene.count({"wanders by 8.0 mm in the first second", "cannot be separated"}), 1);
}

TEST(Statements, EveryParameterThatAFitLeftAtALimitIsNamed) {
    Scene scene;
    scene.noise().jerk_density.at_bound = true;
    EXPECT_EQ(scene.count({"limit of its range for: jerk density."}), 1);
    scene.tell_error(std::nullopt);
    scene.noise().error_tau_s->at_bound = true;
    scene.noise().error_diffusion->at_bound = true;
    scene.noise().acceleration_time_s = NoiseParameter{1000.0, std::nullopt, true};
    EXPECT_EQ(scene.count({"limit of its range for: jerk density, correlation time of the "
                           "acceleration, size of the time-correlated error, correlation time of "
                           "the time-correlated error."}),
              1);
    EXPECT_EQ(scene.count({"correlation time of the acceleration 1e+03 s"}), 1);
}

TEST(Statements, ASearchThatDidNotConverge) {
    Scene scene;
    scene.noise().converged = false;
    EXPECT_EQ(scene.count({"horizontal", "stopped before it converged"}), 1);
}

TEST(Statements, HowTheFilterFared) {
    Scene scene;
    scene.health().white = false;
    scene.health().autocorrelation = 0.43;
    scene.health().autocorrelation_stated = 0.71;
    EXPECT_EQ(scene.count({"horizontal innovations stay correlated", "lag 1: +0.43",
                           "as stated +0.71", "device had filtered them"}),
              1);
    scene.health().consistent = false;
    scene.health().spans = 40;
    scene.health().spans_outside = 12;
    scene.health().spans_allowed = 4;
    EXPECT_EQ(scene.count({"size of the horizontal innovations changes", "12 of 40 spans",
                           "chance allows 4"}),
              1);
}

TEST(Statements, OfBothAxesEachForItself) {
    Scene scene;
    scene.judged.estimation.vertical = scene.judged.estimation.horizontal;
    scene.judged.estimation.vertical->noise.status = NoiseBasis::constant_positions;
    scene.judged.estimation.vertical->health.white = false;
    EXPECT_EQ(scene.count({"horizontal noise was estimated"}), 1);
    EXPECT_EQ(scene.count({"vertical noise could not be estimated", "all the same"}), 1);
    EXPECT_EQ(scene.count({"vertical innovations stay correlated"}), 1);
    EXPECT_EQ(scene.count({"horizontal innovations"}), 0);
}

TEST(Statements, WithoutAnArcThereIsNoFitToSpeakOf) {
    Scene scene;
    scene.judged.estimation.arcs = 0;
    scene.noise().status = NoiseBasis::too_few_epochs;
    EXPECT_EQ(scene.count({"noise"}), 0);
}

TEST(Statements, WhatIsStatedOfTheAccuracy) {
    Scene scene;
    scene.noise().stated_all_equal = true;
    EXPECT_EQ(scene.count({"equal at all epochs (10.0 mm)"}), 1);
    scene.judged.accuracy_source = "none";
    EXPECT_EQ(scene.count({"nothing can be certified"}), 1);
    EXPECT_EQ(scene.count({"equal at all epochs"}), 0);
}

TEST(Statements, WhatTheRecordingDoesNotSay) {
    Scene scene;
    scene.judged.facts.georeferenced = false;
    scene.judged.facts.vertical_measured = false;
    scene.judged.facts.first_epoch.reset();
    EXPECT_EQ(scene.count({"Not georeferenced"}), 1);
    EXPECT_EQ(scene.count({"Heights were not measured"}), 1);
    EXPECT_EQ(scene.count({"time is relative"}), 1);
}

TEST(Statements, WhereMonteCarloDoesNotAgreeOrConverge) {
    Scene scene;
    ProfileWindows windows;
    windows.profile = "nalsa";
    windows.best = CertifiableWindow{};
    windows.best->standard_uncertainty_m_s = 0.010;
    windows.best->monte_carlo = MonteCarloCheck{
        .standard_uncertainty_m_s = 0.0104, .tolerance_m_s = 0.0005, .converged = true};
    scene.judged.windows.profiles = {windows};
    EXPECT_EQ(scene.count({"Monte Carlo"}), 0);
    windows.best->monte_carlo->standard_uncertainty_m_s = 0.0106;
    scene.judged.windows.profiles = {windows};
    EXPECT_EQ(
        scene.count({"Under nalsa the check of linearisation gives", "0.0106 m/s", "0.0100 m/s"}),
        1);
    // An interval that the budget's does not hold; the budget's is +- 1.96 x 0.010 m/s.
    windows.best->monte_carlo->standard_uncertainty_m_s = 0.010;
    windows.best->monte_carlo->lower_m_s = -0.0250;
    scene.judged.windows.profiles = {windows};
    EXPECT_EQ(scene.count({"Under nalsa the check of linearisation gives a 95 % coverage interval",
                           "-0.0250 m/s to 0.0000 m/s", "-0.0196 m/s to 0.0196 m/s"}),
              1);
    windows.best->monte_carlo->converged = false;
    windows.best->monte_carlo->trials = 1'000'000;
    scene.judged.windows.profiles = {windows};
    EXPECT_EQ(scene.count({"nalsa did not converge in 1000000 trials"}), 1);
}

/// A scene whose tests were made.
Scene tested_scene() {
    Scene scene;
    ScreeningBasis& tests = scene.judged.tests;
    tests.tests = 30'000;
    tests.family_false_alarm_rate = 0.001;
    tests.models = {{.axes = TestedAxes::horizontal, .noise = NoiseBasis::fitted}};
    return scene;
}

TEST(Statements, OnTheTestsSayHowManyAndHowOftenTheyErr) {
    const Scene scene = tested_scene();
    EXPECT_EQ(scene.count({"30000 tests", "probability of at most 0.001",
                           "shifts of its time stamp and sudden changes of acceleration"}),
              1);
    EXPECT_EQ(scene.count({"not on noise estimated"}), 0);
    EXPECT_EQ(scene.count({"sessions"}), 0);
}

TEST(Statements, OnTheWitnessesSayWhatIsAmiss) {
    Scene scene = tested_scene();
    ScreeningBasis& tests = scene.judged.tests;
    tests.models[0].noise = NoiseBasis::too_few_epochs;
    tests.models[0].measurement_scale = 1.7;
    tests.fix_types = {
        {.fix = FixType::fixed, .variance_factor = 4.0, .judgement = AccuracyJudgement::optimistic},
        {.fix = FixType::single,
         .variance_factor = 1.0,
         .judgement = AccuracyJudgement::as_stated}};
    tests.time.sessions = 3;
    tests.time.rate_deviation = 5e-4;
    tests.time.faults = {{.epoch = 77, .kind = TimeFaultKind::whole_second_shift, .size_s = 18.0},
                         {.epoch = 90, .kind = TimeFaultKind::gap, .size_s = 3.0}};
    tests.velocity = VelocityComparison{.compared = 500,
                                        .delay_s = 0.123,
                                        .sigma_delay_s = 0.002,
                                        .scale_m_s = 0.031,
                                        .rejected = 4};
    tests.baseline = BaselineComparison{
        .receiver = "mast", .compared = 400, .length_m = 2.0, .sd_m = 1.95, .rejected = 0};
    EXPECT_EQ(scene.count({"rest on the stated standard deviations times 1.70"}), 1);
    EXPECT_EQ(scene.count({"for fixed solutions are optimistic", "2.00 times as large"}), 1);
    EXPECT_EQ(scene.count({"single"}), 0);
    EXPECT_EQ(scene.count({"3 sessions"}), 1);
    EXPECT_EQ(scene.count({"+5.0e-04 of their nominal rate"}), 1);
    EXPECT_EQ(scene.count({"epoch 77", "jumped by +18 s"}), 1);
    EXPECT_EQ(scene.count({"jumped"}), 1);
    EXPECT_EQ(scene.count({"delay of 0.123 s", "0.031 m/s", "4 epochs contradicted"}), 1);
    EXPECT_EQ(scene.count({"\"mast\" was 2.000 m away", "may be off"}), 1);
    tests.baseline->sd_m = 0.01;
    EXPECT_EQ(scene.count({"\"mast\" was 2.000 m away", "may be off"}), 0);
}

/// A window whose undetected error is up to so much, beside 0.01 m/s of everything else.
Scene undetected_scene(double error_m_s) {
    Scene scene = tested_scene();
    ProfileWindows windows;
    windows.profile = "nalsa";
    CertifiableWindow& best = windows.best.emplace();
    best.standard_uncertainty_m_s = std::hypot(0.01, error_m_s / std::sqrt(3.0));
    BudgetRow& row = best.budget.emplace_back();
    row.symbol = "d";
    row.contribution_m_s = error_m_s / std::sqrt(3.0);
    scene.judged.windows.profiles = {windows};
    return scene;
}

TEST(Statements, OnUndetectedErrorsSayWhatTheIntervalHoldsThen) {
    Scene scene = undetected_scene(0.02);
    CertifiableWindow& best = *scene.judged.windows.profiles[0].best;
    // U = 2 x 0.0152753 = 0.0305505; Phi(1.05505) - Phi(-5.05505) = 0.8543.
    EXPECT_EQ(
        scene.count({"Under nalsa, an undetected error changes the speed", "by at most 0.0200 m/s",
                     "an average over runs", "with a probability of 85 %"}),
        1);
    // With 0.01 m/s of a bias beside it Phi(2.05505) = 0.98006.
    best.bias_limit_m_s = 0.01;
    EXPECT_EQ(scene.count({"with a probability of 98 %"}), 1);
    // For two degrees of freedom k is 4.53 ([GUM] table G.2), Phi(4.92) = 0.9999996: no certainty.
    best.bias_limit_m_s = 0.0;
    best.effective_degrees_of_freedom = 2.0;
    EXPECT_EQ(scene.count({"with a probability of 99 %"}), 1);
    best.budget[0].contribution_m_s = 0.0;
    EXPECT_EQ(scene.count({"an undetected error changes the speed"}), 0);
    best.budget.clear();
    EXPECT_EQ(scene.count({"an undetected error changes the speed"}), 0);
}

TEST(Statements, OnWhatScreeningCouldHaveMissedAgreeWithDraws) {
    constexpr int runs = 20000;  // tell a share to 0.4 %
    for (const double error_m_s : {0.005, 0.01, 0.02, 0.05}) {
        const Scene scene = undetected_scene(error_m_s);
        const double expanded_m_s =
            2.0 * scene.judged.windows.profiles[0].best->standard_uncertainty_m_s;
        RandomGenerator random(114);
        int held = 0;
        for (int i = 0; i < runs; ++i)
            held += std::abs(error_m_s + 0.01 * random.normal()) <= expanded_m_s ? 1 : 0;
        int said = 0;
        for (int percent = 0; percent <= 100; ++percent)
            if (scene.count({fmt::format("with a probability of {} %", percent)}) == 1)
                said = percent;
        EXPECT_NEAR(100.0 * held / runs, said + 0.5, 1.3) << error_m_s;
    }
}

TEST(Statements, OnDriftsSayWhatStandsAgainstASlowOne) {
    Scene scene = tested_scene();
    ProfileWindows windows;
    windows.profile = "nalsa";
    windows.best.emplace();
    windows.best->reliability = {
        {.hypothesis = Hypothesis::ramp, .size = 0.853, .unit = "m / s", .speed_m_s = 0.8}};
    scene.judged.windows.profiles = {windows};
    EXPECT_EQ(scene.count({"only from 0.85 m/s on",
                           "No velocities were recorded to check for slower ones"}),
              1);
    scene.judged.tests.velocity = VelocityComparison{.compared = 500,
                                                     .delay_s = std::nullopt,
                                                     .sigma_delay_s = std::nullopt,
                                                     .scale_m_s = 0.031,
                                                     .rejected = 0};
    EXPECT_EQ(scene.count({"only from 0.85 m/s on", "velocities, which agree to 0.031 m/s",
                           "check for slower ones"}),
              1);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
