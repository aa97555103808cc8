#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>

#include "core/failure.h"
#include "reports/certificate/report_json.h"
#include "reports_page_support.h"
#include "reports_sample.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::ordered_json;

CertifiableWindow& best_of(sample::Run& run) {
    return *run.inputs.receivers[0].windows.profiles[0].best;
}

NoiseSummary& noise_of(sample::Run& run) {
    return run.inputs.receivers[0].trajectory.estimation.horizontal.noise;
}

Json uncertainty_of(const sample::Run& run) {
    return report_json(run.inputs)["predicate"]["profiles"][0]["window"]["uncertainty"];
}

std::string noise_cell(const sample::Run& run, const std::string& label, std::size_t axis) {
    const Json predicate = report_json(run.inputs)["predicate"];
    for (const Json& line : predicate["receivers"][0]["noise_table"]["lines"])
        if (line["label"] == label) return line["cells"][axis]["text"];
    return "no such line";
}

/// The section of a page from a heading to the next.
std::string section(const std::string& html, const std::string& heading) {
    const std::size_t begin = html.find(fmt::format("<h2>{}", heading));
    if (begin == std::string::npos) return {};
    return html.substr(begin, html.find("</section>", begin) - begin);
}

std::string page_of(const sample::Run& run) {
    return print_page(report_json(run.inputs));
}

TEST(Uncertainty, EveryRowOfTheBudgetStandsInReportAndPage) {
    sample::Run run = sample::make_run();
    const Json rows = uncertainty_of(run)["budget"];
    const std::string page = section(page_of(run), "Uncertainty: rule “nalsa”");
    const auto& budget = best_of(run).budget;
    ASSERT_EQ(rows.size(), budget.size());
    for (std::size_t i = 0; i < budget.size(); ++i) {
        EXPECT_EQ(rows[i]["symbol"], budget[i].symbol);
        EXPECT_EQ(rows[i]["estimate"], budget[i].estimate);
        EXPECT_EQ(rows[i]["standard_uncertainty"], budget[i].standard_uncertainty);
        EXPECT_EQ(rows[i]["sensitivity"], budget[i].sensitivity);
        EXPECT_EQ(rows[i]["contribution_m_s"], budget[i].contribution_m_s);
        EXPECT_EQ(rows[i].contains("degrees_of_freedom"), budget[i].degrees_of_freedom.has_value());
        EXPECT_EQ(rows[i]["note"], budget[i].note);
        EXPECT_EQ(rows[i]["correlation"], budget[i].correlation);
        // What follows the quantity's name, up to the next row.
        const std::string& name = budget[i].source;
        const std::size_t begin = page.find(fmt::format(">{}", name.substr(0, name.find('\''))));
        ASSERT_NE(begin, std::string::npos) << name;
        const std::string cells = page.substr(begin, page.find("</tbody>", begin) - begin);
        for (const char* shown :
             {"estimate_text", "uncertainty_text", "evaluation_text", "degrees_text",
              "sensitivity_text", "contribution_text", "share_text"})
            EXPECT_NE(cells.find(fmt::format(">{}<", rows[i][shown].get<std::string>())),
                      std::string::npos)
                << budget[i].symbol << " " << shown;
    }
}

// What a board does with a pocket calculator: standard uncertainty times sensitivity, as shown.
TEST(Uncertainty, TheShownFiguresMultiplyToTheShownContribution) {
    const Json uncertainty = uncertainty_of(sample::make_run());
    for (const Json& row : uncertainty["budget"]) {
        const double product = std::stod(row["uncertainty_text"].get<std::string>()) *
                               std::abs(std::stod(row["sensitivity_text"].get<std::string>()));
        const double contribution = std::stod(row["contribution_text"].get<std::string>());
        EXPECT_NEAR(product, contribution, 0.05 * contribution) << row["symbol"];
    }
}

TEST(Uncertainty, SharesAndBarsSumToAllOfTheVariance) {
    const sample::Run run = sample::make_run();
    const Json uncertainty = uncertainty_of(run);
    double shares = 0.0, variance = 0.0, bars = 0.0;
    for (const Json& row : uncertainty["budget"]) {
        shares += row["share_percent"].get<double>();
        variance += std::pow(row["contribution_m_s"].get<double>(), 2);
    }
    EXPECT_NEAR(shares, 100.0, 0.005 * 9.0);
    EXPECT_NEAR(std::sqrt(variance), 0.002551, 1e-6);
    EXPECT_EQ(uncertainty["budget_total"]["combined_text"], "0.00918");
    EXPECT_EQ(uncertainty["budget_total"]["effective_text"], "4008");

    const std::string page = section(page_of(run), "Uncertainty: rule “nalsa”");
    const std::regex bar("style=\"width: ([0-9.]+)%\"");
    for (std::sregex_iterator at(page.begin(), page.end(), bar), end; at != end; ++at)
        bars += std::stod((*at)[1]);
    EXPECT_NEAR(bars, 100.0, 0.005 * 9.0);
}

TEST(Uncertainty, RowsThatContributeNothingStayWithTheirReason) {
    sample::Run run = sample::make_run();
    const std::string page = section(page_of(run), "Uncertainty: rule “nalsa”");
    int zeros = 0;
    for (const BudgetRow& row : best_of(run).budget) {
        if (row.contribution_m_s != 0.0) continue;
        ++zeros;
        EXPECT_NE(page.find(row.note.substr(0, row.note.find('\''))), std::string::npos)
            << row.note;
    }
    EXPECT_EQ(zeros, 3);
    for (BudgetRow& row : best_of(run).budget)
        row.contribution_m_s = row.standard_uncertainty = 0.0;
    const Json uncertainty = uncertainty_of(run);
    for (const Json& row : uncertainty["budget"])
        EXPECT_EQ(row["share_percent"], 0.0);
}

TEST(Uncertainty, SaysCertifiedFittedAndRobustSpeed) {
    sample::Run run = sample::make_run();
    std::string page = section(page_of(run), "Uncertainty: rule “nalsa”");
    EXPECT_NE(page.find("216.00 km/h ± 0.019 km/h (k = 2)"), std::string::npos);
    EXPECT_NE(page.find("216.009 km/h ± 0.015 km/h (k = 2), by 11 noise models"),
              std::string::npos);
    EXPECT_NE(page.find("216.009 km/h: agrees"), std::string::npos);
    EXPECT_NE(page.find("the larger is added to the expanded uncertainty"), std::string::npos);
    EXPECT_NE(page.find("fastest of 421 windows was chosen; 118 could"), std::string::npos);

    best_of(run).robust->agrees = false;
    page = section(page_of(run), "Uncertainty: rule “nalsa”");
    EXPECT_NE(page.find("216.009 km/h: does not agree"), std::string::npos);
}

// 1.9601 and 2.0005: Student's t of 4008 degrees of freedom. 60.002417 -+ 1.96055 * 0.002551.
TEST(Uncertainty, TheMonteCarloCheckIsComparedWithTheBudget) {
    sample::Run run = sample::make_run();
    Json check = uncertainty_of(run)["monte_carlo"];
    EXPECT_NEAR(check["budget_lower_m_s"].get<double>(), 59.997416, 1.5e-6);
    EXPECT_NEAR(check["budget_upper_m_s"].get<double>(), 60.007418, 1.5e-6);
    EXPECT_TRUE(check["uncertainty_agrees"].get<bool>());
    EXPECT_TRUE(check["interval_agrees"].get<bool>());

    best_of(run).monte_carlo->lower_m_s = 59.9979;  // rectangular parts make it shorter
    best_of(run).monte_carlo->upper_m_s = 60.0069;
    check = uncertainty_of(run)["monte_carlo"];
    EXPECT_FALSE(check["interval_agrees"].get<bool>());
    EXPECT_NE(check["monte_carlo_words"].get<std::string>().find("safe side"), std::string::npos);

    best_of(run).monte_carlo->upper_m_s = 60.0085;
    best_of(run).monte_carlo->standard_uncertainty_m_s = 0.0027;
    best_of(run).monte_carlo->converged = false;
    check = uncertainty_of(run)["monte_carlo"];
    EXPECT_FALSE(check["uncertainty_agrees"].get<bool>());
    const std::string words = check["monte_carlo_words"];
    EXPECT_NE(words.find("not converged"), std::string::npos);
    EXPECT_NE(words.find("does not agree with the budget's"), std::string::npos);
    EXPECT_EQ(words.find("safe side"), std::string::npos);
}

TEST(Uncertainty, WhatTheFilesSayStaysText) {
    sample::Run run = sample::make_run();
    BudgetRow& row = best_of(run).budget.front();
    row.symbol = "<i>w</i>";
    row.source = "a & b <script>";
    row.note = "\"quoted\" </td>";
    const std::string html = page_of(run);
    EXPECT_EQ(html.find("<script"), std::string::npos);
    EXPECT_EQ(html.find("<i>w"), std::string::npos);
    EXPECT_NE(html.find("a &amp; b &lt;script&gt;"), std::string::npos);
    EXPECT_NE(html.find("&quot;quoted&quot; &lt;/td&gt;"), std::string::npos);
}

TEST(Uncertainty, EachPartMayBeMissing) {
    const std::vector<std::pair<const char*, std::function<void(CertifiableWindow&)>>> parts{
        {"fitted", [](CertifiableWindow& best) { best.fitted.reset(); }},
        {"robust", [](CertifiableWindow& best) { best.robust.reset(); }},
        {"bound", [](CertifiableWindow& best) { best.bound.reset(); }},
        {"selection", [](CertifiableWindow& best) { best.selection.reset(); }},
        {"monte_carlo", [](CertifiableWindow& best) { best.monte_carlo.reset(); }},
        {"budget_total", [](CertifiableWindow& best) { best.budget.clear(); }},
        {"effective_degrees_of_freedom",
         [](CertifiableWindow& best) { best.effective_degrees_of_freedom.reset(); }}};
    for (const auto& [name, remove] : parts) {
        sample::Run run = sample::make_run();
        EXPECT_TRUE(uncertainty_of(run).contains(name));
        remove(best_of(run));
        EXPECT_FALSE(uncertainty_of(run).contains(name));
        EXPECT_EQ(page_of(run).find("{{"), std::string::npos) << name;
    }
}

TEST(Uncertainty, NoiseIsGivenWithItsUncertaintyOrSaidNotToBeDetermined) {
    sample::Run run = sample::make_run();
    EXPECT_EQ(noise_cell(run, "Jerk density of the motion", 0), "0.430 m s^-2.5 ± 0.025 m s^-2.5");
    const char* size = "Time-correlated position error, standard deviation";
    EXPECT_EQ(noise_cell(run, size, 0), "not determined by the data");
    EXPECT_EQ(noise_cell(run, size, 1), "0.0271 m, × or ÷ 3.32");  // exp(1.2)
    EXPECT_EQ(noise_cell(run, "its correlation time", 1),
              "10.0 s, uncertainty not determined by the data; at the limit of its range");
    EXPECT_EQ(noise_cell(run, "Autocorrelation of the innovations, lag 1", 0),
              "-0.114 with noise as stated, -0.029 with the noise used: white");

    noise_of(run).status = NoiseBasis::too_few_epochs;
    noise_of(run).epochs = 12;
    EXPECT_EQ(noise_cell(run, "Noise", 0),
              "not estimated: 12 usable epochs, at least 30 required; the stated noise is used");
    EXPECT_EQ(noise_cell(run, "Jerk density of the motion", 0), "0.430 m s^-2.5");
    EXPECT_EQ(noise_cell(run, size, 0), "not looked for");
}

TEST(Uncertainty, TheReportHoldsNoiseAndHealthInFigures) {
    const Json predicate = report_json(sample::make_run().inputs)["predicate"];
    const Json& estimation = predicate["receivers"][0]["estimation"];
    EXPECT_EQ(estimation["horizontal"]["noise"]["jerk_density"]["relative_uncertainty"], 0.0579);
    EXPECT_FALSE(estimation["horizontal"]["noise"].contains("error_sigma_m"));
    EXPECT_EQ(estimation["vertical"]["noise"]["error_tau_s"]["at_bound"], true);
    EXPECT_EQ(estimation["vertical"]["health"]["autocorrelation_stated"], -0.1138);
    EXPECT_EQ(estimation["robust_downweighted"], 12);
    EXPECT_FALSE(
        report_json(
            sample::make_run({.vertical = false}).inputs)["predicate"]["receivers"][0]["estimation"]
            .contains("vertical"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
