#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// At most that many significant digits, never with an exponent.
std::string short_text(double value, int digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    return text.find("e+") == std::string::npos ? text : significant_text(value, digits);
}

/// From here on Student's t is the normal distribution.
constexpr double many_degrees_of_freedom = 10000.0;

/// Decimals for all contributions: three digits of the combined uncertainty, as far as files go.
int contribution_decimals(const CertifiableWindow& window, const SpeedUnit& unit) {
    return std::min(uncertainty_decimals(window.standard_uncertainty_m_s * unit.per_m_s) + 1, 5);
}

std::string contribution_text(double contribution_m_s, const CertifiableWindow& window,
                              const SpeedUnit& unit) {
    if (contribution_m_s == 0.0) return "0";
    return format_fixed(contribution_m_s * unit.per_m_s, contribution_decimals(window, unit));
}

std::string degrees_text(const std::optional<double>& degrees_of_freedom) {
    if (!degrees_of_freedom) return "∞";
    if (*degrees_of_freedom > many_degrees_of_freedom)
        return fmt::format("> {:.0f}", many_degrees_of_freedom);
    return format_fixed(std::floor(*degrees_of_freedom), 0);
}

/// A row's quantity is a speed: shown in the page's unit instead of m/s.
bool is_speed(const BudgetRow& row) {
    return row.unit == "m / s";
}

/// "s" for "s", "m/s" for "m / s", nothing for a pure number.
std::string written_unit(const std::string& unit) {
    if (unit == "1") return {};
    constexpr std::string_view per = " / ";
    const std::size_t at = unit.find(per);
    if (at == std::string::npos) return unit;
    return fmt::format("{}/{}", unit.substr(0, at), unit.substr(at + per.size()));
}

std::string with_unit(std::string figure, std::string_view unit) {
    if (!unit.empty()) figure += fmt::format(" {}", unit);
    return figure;
}

std::string sensitivity_text(const BudgetRow& row, const std::string& quantity_unit,
                             const SpeedUnit& unit) {
    if (is_speed(row)) return short_text(row.sensitivity, 3);
    return fmt::format("{} {}{}{}", significant_text(row.sensitivity * unit.per_m_s, 3), unit.name,
                       quantity_unit.empty() ? "" : " per ", quantity_unit);
}

double variance_of(const std::vector<BudgetRow>& rows) {
    double sum = 0.0;
    for (const BudgetRow& row : rows)
        sum += row.contribution_m_s * row.contribution_m_s;
    return sum;
}

void add_source(Block& block, const BudgetRow& row, const CertifiableWindow& window,
                const SpeedUnit& unit) {
    const double variance = variance_of(window.budget);
    const double share =
        variance > 0.0 ? row.contribution_m_s * row.contribution_m_s / variance : 0.0;
    const std::string quantity_unit =
        is_speed(row) ? std::string(unit.name) : written_unit(row.unit);
    const double factor = is_speed(row) ? unit.per_m_s : 1.0;
    TableRow& added = add_row(
        block,
        {row.symbol, row.source, with_unit(short_text(row.estimate * factor, 4), quantity_unit),
         with_unit(significant_text(row.standard_uncertainty * factor, 2), quantity_unit),
         fmt::format("{}, {}", row.type, row.distribution), degrees_text(row.degrees_of_freedom),
         sensitivity_text(row, quantity_unit, unit),
         contribution_text(row.contribution_m_s, window, unit),
         row.contribution_m_s == 0.0 ? std::string("0 %")
                                     : fmt::format("{} %", format_fixed(100.0 * share, 1))},
        "bar");
    added.share = static_cast<std::int64_t>(std::lround(100.0 * share));
    if (!row.note.empty()) added.further.push_back(row.note);
    added.further.push_back(fmt::format("Touches {}", words_of(row.touches)));
    if (!row.correlation.empty()) added.further.push_back("Correlation: " + row.correlation);
}

void add_totals(Block& block, const RuleView& rule) {
    const CertifiableWindow& window = *rule.best();
    const SpeedUnit& unit = rule.unit();
    add_row(block,
            {"u", "Combined standard uncertainty: root of the sum of squares", "", "", "",
             degrees_text(window.effective_degrees_of_freedom), "",
             contribution_text(window.standard_uncertainty_m_s, window, unit), ""},
            "total");
    const double k = rule.verdict.coverage_factor;
    std::string source = fmt::format("Expanded uncertainty, k = {}", coverage_text(k));
    if (window.bias_limit_m_s > 0.0)
        source += fmt::format(", and the limit of the bias of choosing, {}",
                              contribution_text(window.bias_limit_m_s, window, unit));
    add_row(block,
            {"U", source, "", "", "", "", "",
             uncertainty_rounded_up(expanded_uncertainty_m_s(window, k) * unit.per_m_s), ""},
            "total");
}

/// Both intervals of 95 %, in words that say which of them is on the safe side.
std::string interval_words(const MonteCarloCheck& check, const LinearisationJudgement& judged,
                           const SpeedUnit& unit) {
    const auto text = [&](double speed_m_s) {
        return speed_text(speed_m_s, check.standard_uncertainty_m_s, unit);
    };
    const std::string both = fmt::format("The budget's 95 % interval, {} to {} {}, ",
                                         text(judged.lower_m_s), text(judged.upper_m_s), unit.name);
    if (judged.interval_agrees) return both + "agrees within that tolerance.";
    return both + (judged.interval_holds ? "holds it and is wider: it is on the safe side."
                                         : "does not agree within that tolerance.");
}

/// The Monte Carlo check beside what the law of propagation gives for the same interval, compared
/// as [GUM-S1] 8 asks: both within the numerical tolerance.
std::string monte_carlo_text(const CertifiableWindow& window, const SpeedUnit& unit) {
    const MonteCarloCheck& check = *window.monte_carlo;
    const LinearisationJudgement judged = judge_linearisation(window);
    const auto text = [&](double speed_m_s) {
        return speed_text(speed_m_s, check.standard_uncertainty_m_s, unit);
    };
    return fmt::format(
        "Check of linearisation, the same rows drawn {} times (Monte Carlo, seed {}): {} {}, u = "
        "{} {}, 95 % interval {} to {} {}; {}, numerical tolerance {} {}. Its u {} with the "
        "budget's. {}",
        check.trials, check.seed, text(check.mean_m_s), unit.name,
        contribution_text(check.standard_uncertainty_m_s, window, unit), unit.name,
        text(check.lower_m_s), text(check.upper_m_s), unit.name,
        check.converged ? "converged" : "not converged",
        significant_text(check.tolerance_m_s * unit.per_m_s, 2), unit.name,
        judged.uncertainty_agrees ? "agrees" : "does not agree",
        interval_words(check, judged, unit));
}

/// What a source contributes under a rule, in its unit; empty where its budget has no such row.
std::string contribution_of(const RuleView& rule, const std::string& source) {
    const auto& budget = rule.best()->budget;
    const auto row = std::ranges::find(budget, source, &BudgetRow::source);
    return row == budget.end()
               ? ""
               : contribution_text(row->contribution_m_s, *rule.best(), rule.unit());
}

}  // namespace

std::vector<Block> budget_blocks(const RuleView& rule) {
    const CertifiableWindow& window = *rule.best();
    std::vector<Block> blocks;
    if (!window.budget.empty()) {
        Block block =
            table({"|4", "Source|21", ">Estimate|10", ">Standard uncertainty|13",
                   "Type, distribution|12", ">Degrees of freedom|9", ">Sensitivity|10",
                   fmt::format(">Contribution, {}|13", rule.unit().name), ">Share of variance|8"},
                  "Budget", "small");
        for (const BudgetRow& row : window.budget)
            add_source(block, row, window, rule.unit());
        add_totals(block, rule);
        blocks.push_back(std::move(block));
    }
    if (window.monte_carlo)
        blocks.push_back(paragraph(monte_carlo_text(window, rule.unit()), "note"));
    return blocks;
}

std::vector<Block> budgets_of_all(const std::vector<RuleView>& rules) {
    std::vector<RuleView> certified;
    std::vector<std::string> sources;
    for (const RuleView& rule : rules) {
        if (rule.best() == nullptr) continue;
        certified.push_back(rule);
        for (const BudgetRow& row : rule.best()->budget)
            if (std::ranges::find(sources, row.source) == sources.end())
                sources.push_back(row.source);
    }
    if (certified.empty()) return {};
    constexpr std::size_t of_sources = 30;
    const std::size_t width = (100 - of_sources) / certified.size();
    std::vector<std::string> heads{
        fmt::format("Contribution to the standard uncertainty|{}", of_sources)};
    Block legend = facts({}, "Budgets", "narrow");
    for (std::size_t i = 0; i < certified.size(); ++i) {
        heads.push_back(fmt::format(">Rule {}, {}|{}", i + 1, certified[i].unit().name, width));
        add_fact(legend, fmt::format("Rule {}", i + 1),
                 fmt::format("{}: {}", certified[i].profile.id,
                             measured_speed_text(certified[i].shown(),
                                                 certified[i].verdict.coverage_factor)));
    }
    Block block = table(heads, {}, "small");
    const auto add_each = [&](const std::string& name, const auto& cell, const char* mark) {
        std::vector<std::string> cells{name};
        for (const RuleView& rule : certified)
            cells.push_back(cell(rule));
        add_row(block, std::move(cells), mark);
    };
    for (const std::string& source : sources)
        add_each(
            source, [&](const RuleView& rule) { return contribution_of(rule, source); }, "");
    add_each(
        "Combined standard uncertainty",
        [](const RuleView& rule) {
            return contribution_text(rule.best()->standard_uncertainty_m_s, *rule.best(),
                                     rule.unit());
        },
        "total");
    add_each(
        "Expanded uncertainty, with the limit of the bias of choosing",
        [](const RuleView& rule) {
            return uncertainty_rounded_up(
                expanded_uncertainty_m_s(*rule.best(), rule.verdict.coverage_factor) *
                rule.unit().per_m_s);
        },
        "total");
    return {std::move(legend), std::move(block),
            paragraph("Estimates, distributions, sensitivities and undetected errors of each rule: "
                      "runcert audit RUN_FOLDER.",
                      "note")};
}

}  // namespace runcert
