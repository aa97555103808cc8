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

Json best_json(const sample::Run& run) {
    return members_json(*run.inputs.receivers[0].windows.profiles[0].best);
}

const Place of_nalsa{.section = "uncertainty", .rule = "nalsa"};
const Place budget_place{.section = "uncertainty", .title = "Budget", .rule = "nalsa"};

/// The rows of the budget as shown, the totals last.
Json budget_rows(const sample::Run& run) {
    return blocks_at(report_json(run.inputs), budget_place).at(0)["rows"];
}

std::string noise_cell(const sample::Run& run, const std::string& label, std::size_t axis) {
    const Place noise{"recording", "Noise estimated from the recording"};
    return row_at(report_json(run.inputs), noise, label)["cells"].at(axis + 1);
}

std::string page_of(const sample::Run& run) {
    return print_page(report_json(run.inputs));
}

TEST(Uncertainty, EveryRowOfTheBudgetStandsInReportAndPage) {
    sample::Run run = sample::make_run();
    const Json best = best_json(run);
    const Json rows = budget_rows(run);
    const std::string page = section_html(page_of(run), "uncertainty");
    const auto& budget = best_of(run).budget;
    ASSERT_EQ(best["budget"].size(), budget.size());
    ASSERT_EQ(rows.size(), budget.size() + 2);
    for (std::size_t i = 0; i < budget.size(); ++i) {
        const Json& row = best["budget"][i];
        EXPECT_EQ(row["symbol"], budget[i].symbol);
        EXPECT_EQ(row["estimate"], budget[i].estimate);
        EXPECT_EQ(row["standard_uncertainty"], budget[i].standard_uncertainty);
        EXPECT_EQ(row["sensitivity"], budget[i].sensitivity);
        EXPECT_EQ(row["contribution_m_s"], budget[i].contribution_m_s);
        EXPECT_EQ(row.contains("degrees_of_freedom"), budget[i].degrees_of_freedom.has_value());
        EXPECT_EQ(row["note"], budget[i].note);
        EXPECT_EQ(row["touches"], to_text(budget[i].touches));
        EXPECT_EQ(rows[i]["cells"][0], budget[i].symbol);
        EXPECT_EQ(rows[i]["cells"][1], budget[i].source);
        EXPECT_EQ(rows[i]["further"],
                  Json({budget[i].note, fmt::format("Touches {}", words_of(budget[i].touches))}));
        // What follows the quantity's name, up to the next row.
        const std::string& name = budget[i].source;
        const std::size_t begin = page.find(fmt::format(">{}", name.substr(0, name.find('\''))));
        ASSERT_NE(begin, std::string::npos) << name;
        const std::string cells = page.substr(begin, page.find("</tbody>", begin) - begin);
        for (std::size_t k = 2; k < rows[i]["cells"].size(); ++k)
            EXPECT_NE(
                cells.find(fmt::format("<bdi>{}</bdi>", rows[i]["cells"][k].get<std::string>())),
                std::string::npos)
                << budget[i].symbol << " " << k;
    }
}

// What a board does with a pocket calculator: standard uncertainty times sensitivity, as shown.
TEST(Uncertainty, TheShownFiguresMultiplyToTheShownContribution) {
    const Json rows = budget_rows(sample::make_run());
    for (const Json& row : rows) {
        if (row["mark"] == "total") continue;
        const auto figure = [&](std::size_t cell) {
            return std::stod(row["cells"][cell].get<std::string>());
        };
        const double product = figure(3) * std::abs(figure(6));
        EXPECT_NEAR(product, figure(7), 0.05 * figure(7)) << row["cells"][0];
    }
}

TEST(Uncertainty, SharesAndBarsSumToAllOfTheVariance) {
    const sample::Run run = sample::make_run();
    const Json rows = budget_rows(run);
    double shares = 0.0, variance = 0.0, bars = 0.0;
    for (const Json& row : rows)
        if (row["mark"] == "bar") {
            shares += std::stod(row["cells"][8].get<std::string>());
            bars += row["share"].get<double>();
        }
    const Json best = best_json(run);
    for (const Json& row : best["budget"])
        variance += std::pow(row["contribution_m_s"].get<double>(), 2);
    EXPECT_NEAR(shares, 100.0, 0.05 * 9.0);
    EXPECT_NEAR(bars, 100.0, 0.5 * 9.0);
    EXPECT_NEAR(std::sqrt(variance), 0.002551, 1e-6);
    const Json combined = row_at(report_json(run.inputs), budget_place, "u")["cells"];
    EXPECT_EQ(combined[7], "0.00918");
    EXPECT_EQ(combined[5], "4008");

    const std::string page = page_of(run);
    const std::size_t begin = page.find("<caption><bdi>Budget");
    const std::string table = page.substr(begin, page.find("</table>", begin) - begin);
    const std::regex bar("<span class=\"bar\"><i style=\"width: ([0-9]+)%\"");
    double drawn = 0.0;
    for (std::sregex_iterator at(table.begin(), table.end(), bar), end; at != end; ++at)
        drawn += std::stod((*at)[1]);
    EXPECT_EQ(drawn, bars);
}

TEST(Uncertainty, RowsThatContributeNothingStayWithTheirReason) {
    sample::Run run = sample::make_run();
    const std::string page = section_html(page_of(run), "uncertainty");
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
    for (const Json& row : budget_rows(run)) {
        if (row["mark"] == "total") continue;
        EXPECT_EQ(row["share"], 0);
        EXPECT_EQ(row["cells"][8], "0 %");
    }
}

TEST(Uncertainty, SaysMeasuredFittedAndRobustSpeed) {
    sample::Run run = sample::make_run();
    const Json report = report_json(run.inputs);
    EXPECT_NE(
        sentences_at(report, of_nalsa).find("Measured speed: 216.00 km/h ± 0.019 km/h (k = 2)"),
        std::string::npos);
    EXPECT_TRUE(fact_at(report, of_nalsa, "With the fitted noise alone")
                    .starts_with("216.009 km/h ± 0.015 km/h (k = 2), by 11 noise models"))
        << fact_at(report, of_nalsa, "With the fitted noise alone");
    EXPECT_TRUE(
        fact_at(report, of_nalsa, "Robust estimate").starts_with("216.009 km/h: agrees with"))
        << fact_at(report, of_nalsa, "Robust estimate");
    const std::string choice =
        sentences_at(report, {"uncertainty", "Choice of the fastest window", "nalsa"});
    EXPECT_NE(choice.find("the larger is added to the expanded uncertainty"), std::string::npos);
    EXPECT_NE(choice.find("fastest of 421 windows was chosen; 118 could"), std::string::npos);
    const std::string page = section_html(page_of(run), "uncertainty");
    for (const char* shown :
         {"216.00 km/h ± 0.019 km/h (k = 2)", "216.009 km/h ± 0.015 km/h (k = 2), by",
          "216.009 km/h: agrees", "fastest of 421 windows was chosen"})
        EXPECT_NE(page.find(shown), std::string::npos) << shown;

    best_of(run).robust->agrees = false;
    EXPECT_TRUE(fact_at(report_json(run.inputs), of_nalsa, "Robust estimate")
                    .starts_with("216.009 km/h: does not agree"));
}

// 1.9601 and 2.0005: Student's t of 4008 degrees of freedom. 60.002417 -+ 1.96055 * 0.002551.
TEST(Uncertainty, TheMonteCarloCheckIsComparedWithTheBudget) {
    sample::Run run = sample::make_run();
    const auto words = [&] {
        for (const Json& block : blocks_at(report_json(run.inputs), of_nalsa))
            if (const std::string text = block.value("text", "");
                text.starts_with("Check of linearisation"))
                return text;
        return std::string("no check");
    };
    const auto says = [&](const char* part) { return words().find(part) != std::string::npos; };
    EXPECT_TRUE(says("(Monte Carlo, seed 1)")) << words();
    // 59.997416 and 60.007418 m/s.
    EXPECT_TRUE(says("The budget's 95 % interval, 215.9907 to 216.0267 km/h, agrees within"))
        << words();
    EXPECT_TRUE(says("converged, numerical tolerance")) << words();
    EXPECT_TRUE(says("Its u agrees with the budget's.")) << words();

    best_of(run).monte_carlo->lower_m_s = 59.9979;  // rectangular parts make it shorter
    best_of(run).monte_carlo->upper_m_s = 60.0069;
    EXPECT_TRUE(says("holds it and is wider: it is on the safe side.")) << words();

    best_of(run).monte_carlo->upper_m_s = 60.0085;
    best_of(run).monte_carlo->standard_uncertainty_m_s = 0.0027;
    best_of(run).monte_carlo->converged = false;
    EXPECT_TRUE(says("not converged")) << words();
    EXPECT_TRUE(says("Its u does not agree with the budget's.")) << words();
    EXPECT_TRUE(says("does not agree within that tolerance.")) << words();
    EXPECT_FALSE(says("safe side")) << words();
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
    struct Part {
        const char* name;   ///< of the windows file
        const char* shown;  ///< what of it is read in the section of the rule
        std::function<void(CertifiableWindow&)> remove;
    };
    const std::vector<Part> parts{
        {"fitted", "With the fitted noise alone",
         [](CertifiableWindow& best) { best.fitted.reset(); }},
        {"robust", "Robust estimate", [](CertifiableWindow& best) { best.robust.reset(); }},
        {"bound", "Time-correlated position errors",
         [](CertifiableWindow& best) { best.bound.reset(); }},
        {"selection", "Choice of the fastest window",
         [](CertifiableWindow& best) { best.selection.reset(); }},
        {"monte_carlo", "Check of linearisation",
         [](CertifiableWindow& best) { best.monte_carlo.reset(); }},
        {"budget", "Combined standard uncertainty",
         [](CertifiableWindow& best) { best.budget.clear(); }},
        {"effective_degrees_of_freedom", "4008",
         [](CertifiableWindow& best) { best.effective_degrees_of_freedom.reset(); }}};
    for (const auto& [name, shown, remove] : parts) {
        sample::Run run = sample::with_one_rule(sample::make_run());
        const auto is_shown = [&] {
            return section_html(page_of(run), "uncertainty").find(shown) != std::string::npos;
        };
        EXPECT_FALSE(best_json(run).value(name, Json()).empty()) << name;
        EXPECT_TRUE(is_shown()) << name;
        remove(best_of(run));
        EXPECT_TRUE(best_json(run).value(name, Json()).empty()) << name;
        EXPECT_FALSE(is_shown()) << name;
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

}  // namespace
}  // namespace runcert::RUNCERT_FILE
