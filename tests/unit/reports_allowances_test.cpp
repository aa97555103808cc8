#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports/results/results.h"
#include "reports_page_support.h"
#include "reports_sample.h"

// What the report holds of windows, verdict, screening and recording: the limit of
// the selection bias, other models of the motion, attempts made, drift, witnesses, whose clock and
// whose fix type.

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

CertifiableWindow& best_of(sample::Run& run) {
    return *run.inputs.receivers[0].windows.profiles[0].best;
}

ProfileVerdict& verdict_of(sample::Run& run) {
    return run.inputs.verdict.profiles[0];
}

Json profile_of(const sample::Run& run) {
    return report_json(run.inputs)["predicate"]["verdict"]["profiles"][0];
}

Json best_json(const sample::Run& run) {
    return members_json(*run.inputs.receivers[0].windows.profiles[0].best);
}

std::string page_of(const sample::Run& run) {
    return print_page(report_json(run.inputs));
}

const Place uncertainty_of_nalsa{.section = "uncertainty", .rule = "nalsa"};

void expect_in(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\nin " << text.substr(0, 2000);
}

/// A run whose windows have all that they may say.
sample::Run made(const sample::Options& options = {}) {
    sample::Run run = sample::make_run(options);
    CertifiableWindow& best = best_of(run);
    best.own_standard_uncertainty_m_s = 0.001234;
    best.bias_limit_m_s = 0.0004;
    best.bound->along = 1.25;
    best.estimates = OtherEstimates{.chord_m_s = 60.004321,
                                    .chord_difference_uncertainty_m_s = 0.004714,
                                    .stiffer_m_s = 60.001111,
                                    .softer_m_s = 60.003333,
                                    .whole_m_s = 59.998877,
                                    .half_width_m_s = 0.0013};
    SelectionBias& selection = *best.selection;
    selection.treatment = SelectionTreatment::subtracted;
    selection.fitted_bias_m_s = 0.0005;
    selection.bounded_bias_m_s = 0.0013;
    selection.bias_m_s = 0.0009;
    selection.bias_half_range_m_s = 0.0004;
    return run;
}

TEST(Allowances, OfTheWindowAreInTheReportAsInTheWindowsFile) {
    const sample::Run run = made();
    const Json best = best_json(run);
    EXPECT_EQ(best["own_standard_uncertainty_m_s"], 0.001234);
    EXPECT_EQ(best["bias_limit_m_s"], 0.0004);
    EXPECT_EQ(best["bound"]["along"], 1.25);
    const Json& estimates = best["estimates"];
    EXPECT_EQ(estimates["chord_m_s"], 60.004321);
    EXPECT_EQ(estimates["chord_difference_uncertainty_m_s"], 0.004714);
    EXPECT_EQ(estimates["stiffer_m_s"], 60.001111);
    EXPECT_EQ(estimates["softer_m_s"], 60.003333);
    EXPECT_EQ(estimates["whole_m_s"], 59.998877);
    EXPECT_EQ(estimates["half_width_m_s"], 0.0013);
    const Json& selection = best["selection"];
    EXPECT_EQ(selection["fitted_bias_m_s"], 0.0005);
    EXPECT_EQ(selection["bounded_bias_m_s"], 0.0013);
    EXPECT_EQ(selection["bias_m_s"], 0.0009);
    EXPECT_EQ(selection["bias_half_range_m_s"], 0.0004);
    EXPECT_EQ(selection["treatment"], "subtracted");
}

TEST(Allowances, OfTheWindowAreShownInTheRulesUnit) {
    const sample::Run run = made();
    const Json report = report_json(run.inputs);
    // In km/h: 60.001111, 60.003333, 59.998877 and 60.004321 m/s, and 0.0013 m/s.
    expect_in(
        fact_at(report, uncertainty_of_nalsa, "Other models of the motion"),
        "a third of the jerk density gives 216.0040, three times as much 216.0120, the one "
        "density fitted to the whole recording 215.9960, the measured positions at both ends "
        "alone 216.0156 km/h; the choice of the model is taken to change at most 0.0047 km/h");
    // 0.0009, 0.0004, 0.0005 and 0.0013 m/s.
    expect_in(sentences_at(report, {"uncertainty", "Choice of the fastest window", "nalsa"}),
              "higher by 0.0018 km/h with the errors as fitted, by 0.0047 km/h with "
              "time-correlated errors as "
              "large as allowed for; the middle, +0.0032 km/h, is subtracted from the speed, and "
              "half the difference, 0.0014 km/h, added to the expanded uncertainty.");
    expect_in(fact_at(report, uncertainty_of_nalsa, "Time-correlated position errors"),
              "fitted 0 m (1.25 times that of both axes, along the track)");
    const std::string page = section_html(page_of(run), "uncertainty");
    expect_in(page, "Other models of the motion");
    expect_in(page, "216.0156 km/h");
}

TEST(Allowances, OfTheBiasAreInEveryExpandedUncertainty) {
    sample::Run run = made({.second_receiver = true});
    const Place budget{"uncertainty", "Budget", "nalsa"};
    const auto total = [&] { return row_at(report_json(run.inputs), budget, "U")["cells"]; };
    const auto by_receiver = [&](const char* receiver) {
        return fact_at(report_json(run.inputs), {"window", "By each receiver", "nalsa"}, receiver);
    };
    // 2 x 0.002551 + 0.0004 = 0.005502 m/s = 0.01981 km/h; without it 0.01837 km/h.
    expect_in(total()[1], "and the limit of the bias of choosing, 0.00144");
    EXPECT_EQ(total()[7], "0.020");
    expect_in(section_html(page_of(run), "uncertainty"),
              "and the limit of the bias of choosing, 0.00144");
    best_of(run).effective_degrees_of_freedom.reset();
    expect_in(by_receiver("primary"), "216.008 km/h ± 0.020 km/h");
    best_of(run).bias_limit_m_s = 0.0;
    EXPECT_EQ(total()[1], "Expanded uncertainty, k = 2");
    EXPECT_EQ(total()[7], "0.019");
    expect_in(by_receiver("primary"), "216.008 km/h ± 0.019 km/h");
}

TEST(Allowances, ThatTheWindowsFileLacksAreNotMadeUp) {
    const sample::Run plain = sample::make_run();
    for (const char* absent : {"estimates", "own_standard_uncertainty_m_s"})
        EXPECT_FALSE(best_json(plain).contains(absent)) << absent;
    EXPECT_FALSE(
        has_fact(report_json(plain.inputs), uncertainty_of_nalsa, "Other models of the motion"));
    EXPECT_EQ(best_json(plain)["bias_limit_m_s"], 0.0);
    sample::Run run = made();
    best_of(run).estimates->chord_m_s.reset();
    best_of(run).estimates->chord_difference_uncertainty_m_s.reset();
    best_of(run).bound->along = 1.0;
    EXPECT_FALSE(best_json(run)["estimates"].contains("chord_m_s"));
    const Json report = report_json(run.inputs);
    const std::string estimates =
        fact_at(report, uncertainty_of_nalsa, "Other models of the motion");
    expect_in(estimates, "a third of the jerk density");
    EXPECT_EQ(estimates.find("both ends alone"), std::string::npos);
    const std::string bound =
        fact_at(report, uncertainty_of_nalsa, "Time-correlated position errors");
    expect_in(bound, "fitted 0 m");
    EXPECT_EQ(bound.find("along the track"), std::string::npos);
}

TEST(DecisionMembers, AreThoseOfTheVerdict) {
    sample::Run run = made();
    Decision& decision = *verdict_of(run).decision;
    decision.attempts_made = 7;
    decision.level = 1.0 - 0.025 / 7.0;
    decision.bias_limit_m_s = 0.0004;
    decision.drift_survived_m = 0.420001;
    decision.drift_found_m_s = 0.0712;
    const Json json = profile_of(run)["decision"];
    EXPECT_EQ(json["attempts_made"], 7);
    EXPECT_NEAR(json["level"].get<double>(), 1.0 - 0.025 / 7.0, 1e-9);
    EXPECT_EQ(json["bias_limit_m_s"], 0.0004);
    EXPECT_EQ(json["drift_survived_m"], 0.420001);
    EXPECT_EQ(json["drift_found_m_s"], 0.0712);
    const Place requirements{.section = "requirements", .rule = "nalsa"};
    expect_in(fact_at(report_json(run.inputs), requirements, "Decision rule"),
              "As the best of 7 attempts it may take one share of the risk. At least 99.6429 %");
    decision = {.probability = 0.2, .level = 0.975, .acceptance_limit_m_s = 61.0};
    const Json alone = profile_of(run)["decision"];
    EXPECT_EQ(alone["attempts_made"], 1);
    EXPECT_FALSE(alone.contains("drift_survived_m"));
    EXPECT_FALSE(alone.contains("drift_found_m_s"));
    EXPECT_EQ(sentences_at(report_json(run.inputs), requirements).find("the best of"),
              std::string::npos);
}

TEST(DecisionMembers, HoldTheWitnessesAndSayThereAreNone) {
    sample::Run run = made();
    EXPECT_EQ(profile_of(run)["witnesses"], Json::array());
    verdict_of(run).witnesses = {"the recorded velocities give 216.008 km/h", "a <radar>"};
    EXPECT_EQ(profile_of(run)["witnesses"],
              Json({"the recorded velocities give 216.008 km/h", "a <radar>"}));
}

// Float and fixed in turn, or a recording of 5 s: "Stoi" was all that was said of exp(1000).
TEST(EstimatedNoise, AParameterThatTheDataDoNotDetermineSaysSo) {
    EstimationSummary estimation;
    NoiseSummary& noise = estimation.horizontal.noise;
    noise.status = NoiseBasis::fitted;
    const auto density_given = [&](double relative_uncertainty) {
        noise.jerk_density = {.value = 0.25, .relative_uncertainty = relative_uncertainty};
        return estimation_blocks(estimation).at(1).rows.at(1).cells.at(1);
    };
    for (const double relative : {5.0, 40.0, 700.0, 1000.0, 1e300})
        EXPECT_EQ(density_given(relative), "0.250 m s^-2.5, uncertainty not determined by the data")
            << relative;
    EXPECT_EQ(density_given(4.5), "0.250 m s^-2.5, × or ÷ 90.0");
}

TEST(Origins, OfTimesAndSolutionsAreThoseOfTheObservations) {
    sample::Run run = made();
    Observations& observations = run.inputs.receivers[0].observations;
    observations.time_origin = "UTC of the receiver's position sentences";
    observations.facts.time_source = "satellites";
    observations.solution_source = SolutionSource::attempt;
    EXPECT_EQ(fact_at(report_json(run.inputs), {"recording"}, "Time stamps"),
              "UTC of the receiver's position sentences: the satellites' time, as the format says");
    expect_in(page_of(run), "as the attempt states it; the recording states none");

    observations.time_origin.clear();
    observations.facts.time_source = "unknown";
    EXPECT_EQ(fact_at(report_json(run.inputs), {"recording"}, "Time stamps"),
              "whose clock made them is not known");
}

TEST(Origins, OfEverySolutionHaveWordsOfTheirOwn) {
    sample::Run run = made();
    std::set<std::string> words;
    for (const SolutionSource source : {SolutionSource::recording, SolutionSource::attempt,
                                        SolutionSource::partly, SolutionSource::unknown}) {
        run.inputs.receivers[0].observations.solution_source = source;
        words.insert(fact_at(report_json(run.inputs), {"recording"}, "Fix type"));
    }
    EXPECT_EQ(words.size(), 4U);
    EXPECT_TRUE(words.contains("not stated; taken as that of one receiver alone (single)"));
}

TEST(DeviceSigns, AreInFiguresAndWords) {
    sample::Run run = made();
    ScreeningBasis& basis = run.inputs.receivers[0].screened.basis;
    const auto words = [&] {
        return fact_at(report_json(run.inputs), {"screening"},
                       "Signs of positions that were not measured");
    };
    EXPECT_TRUE(words().starts_with("no fact")) << words();
    basis.device = DeviceSigns{.moving = 1350, .held = 12, .interpolated = 675, .by_chance = 3.46};
    EXPECT_EQ(words(),
              "12 of 1,350 positions recorded in motion repeat the one before, 675 lie on a "
              "line or curve through others to the last digit; chance makes 3.5");
    basis.device = DeviceSigns{.moving = 1350};
    EXPECT_EQ(words(), "none in 1,350 positions recorded in motion");
    basis.device = DeviceSigns{};
    EXPECT_EQ(words(), "none looked for: the craft hardly moved");
}

TEST(Report, IsReadBack) {
    sample::Run run = made();
    verdict_of(run).witnesses = {"a witness"};
    const Json report = report_json(run.inputs);
    EXPECT_EQ(parse_report(report_text_of(report), "report.json"), report);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
