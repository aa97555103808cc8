#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "core/text.h"
#include "reports/results/results.h"

namespace runcert {
namespace {

/// At most that many significant digits, never with an exponent.
std::string short_text(double value, int digits) {
    std::string text = fmt::format("{:.{}g}", value, digits);
    return text.find("e+") == std::string::npos ? text : significant_text(value, digits);
}

/// With three digits of the combined uncertainty, as far as files go.
std::string contribution_text(const RuleView& rule, double contribution_m_s) {
    if (contribution_m_s == 0.0) return "0";
    const double factor = rule.unit().per_m_s;
    const int decimals = uncertainty_decimals(rule.best()->standard_uncertainty_m_s * factor) + 1;
    return format_fixed(contribution_m_s * factor, std::min(decimals, 5));
}

std::string expanded_text(const RuleView& rule) {
    return uncertainty_rounded_up(
        expanded_uncertainty_m_s(*rule.best(), rule.verdict.coverage_factor) * rule.unit().per_m_s);
}

std::string degrees_text(const std::optional<double>& degrees_of_freedom) {
    constexpr double many = 10000.0;  // from here on Student's t is the normal distribution
    if (!degrees_of_freedom) return "∞";
    if (*degrees_of_freedom > many) return fmt::format("> {:.0f}", many);
    return format_fixed(std::floor(*degrees_of_freedom), 0);
}

/// A speed is shown in the page's unit instead of m/s.
void add_source(Block& block, const BudgetRow& row, double variance, const RuleView& rule) {
    const SpeedUnit& unit = rule.unit();
    const double share =
        variance > 0.0 ? row.contribution_m_s * row.contribution_m_s / variance : 0.0;
    const bool is_speed = row.unit == "m / s";
    const double factor = is_speed ? unit.per_m_s : 1.0;
    const std::string of(is_speed ? unit.name : row.unit == "1" ? "" : row.unit);
    const auto with_unit = [&](const std::string& figure) {
        return of.empty() ? figure : fmt::format("{} {}", figure, of);
    };
    TableRow& added = add_row(
        block,
        {row.symbol, row.source, with_unit(short_text(row.estimate * factor, 4)),
         with_unit(significant_text(row.standard_uncertainty * factor, 2)),
         fmt::format("{}, {}", row.type, row.distribution), degrees_text(row.degrees_of_freedom),
         is_speed ? short_text(row.sensitivity, 3)
                  : fmt::format("{} {}{}{}", significant_text(row.sensitivity * unit.per_m_s, 3),
                                unit.name, of.empty() ? "" : " per ", of),
         contribution_text(rule, row.contribution_m_s),
         row.contribution_m_s == 0.0 ? "0 %" : format_fixed(100.0 * share, 1) + " %"},
        "bar");
    added.share = static_cast<std::int64_t>(std::lround(100.0 * share));
    if (!row.note.empty()) added.further.push_back(row.note);
    added.further.push_back(fmt::format("Touches {}", words_of(row.touches)));
    if (!row.correlation.empty()) added.further.push_back("Correlation: " + row.correlation);
}

Block budget_table(const RuleView& rule) {
    const CertifiableWindow& window = *rule.best();
    Block block =
        table({"|4", "Source|16", ">Estimate|10", ">Standard uncertainty|12",
               "Type, distribution|12", ">Degrees of freedom|9", ">Sensitivity|13",
               fmt::format(">Contribution, {}|14", rule.unit().name), ">Share of variance|10"},
              "Budget", "small");
    double variance = 0.0;
    for (const BudgetRow& row : window.budget)
        variance += row.contribution_m_s * row.contribution_m_s;
    for (const BudgetRow& row : window.budget)
        add_source(block, row, variance, rule);
    add_row(block,
            {"u", "Combined standard uncertainty: root of the sum of squares", "", "", "",
             degrees_text(window.effective_degrees_of_freedom), "",
             contribution_text(rule, window.standard_uncertainty_m_s), ""},
            "total");
    std::string expanded =
        fmt::format("Expanded uncertainty, k = {}", coverage_text(rule.verdict.coverage_factor));
    if (window.bias_limit_m_s > 0.0)
        expanded += fmt::format(", and the limit of the bias of choosing, {}",
                                contribution_text(rule, window.bias_limit_m_s));
    add_row(block, {"U", expanded, "", "", "", "", "", expanded_text(rule), ""}, "total");
    return block;
}

/// The Monte Carlo check beside what the law of propagation gives for the same interval, compared
/// as [GUM-S1] 8 asks: both within the numerical tolerance.
std::string monte_carlo_text(const RuleView& rule) {
    const SpeedUnit& unit = rule.unit();
    const MonteCarloCheck& check = *rule.best()->monte_carlo;
    const LinearisationJudgement judged = judge_linearisation(*rule.best());
    const auto text = [&](double speed_m_s) {
        return speed_text(speed_m_s, check.standard_uncertainty_m_s, unit);
    };
    return fmt::format(
        "Check of linearisation, the same rows drawn {} times (Monte Carlo, seed {}): {} {}, u = "
        "{} {}, 95 % interval {} to {} {}; {}, numerical tolerance {} {}. Its u {} with the "
        "budget's. The budget's 95 % interval, {} to {} {}, {}.",
        check.trials, check.seed, text(check.mean_m_s), unit.name,
        contribution_text(rule, check.standard_uncertainty_m_s), unit.name, text(check.lower_m_s),
        text(check.upper_m_s), unit.name, check.converged ? "converged" : "not converged",
        significant_text(check.tolerance_m_s * unit.per_m_s, 2), unit.name,
        judged.uncertainty_agrees ? "agrees" : "does not agree", text(judged.lower_m_s),
        text(judged.upper_m_s), unit.name,
        judged.interval_agrees  ? "agrees within that tolerance"
        : judged.interval_holds ? "holds it and is wider: it is on the safe side"
                                : "does not agree within that tolerance");
}

}  // namespace

std::vector<Block> budget_blocks(const RuleView& rule) {
    std::vector<Block> blocks;
    if (!rule.best()->budget.empty()) blocks.push_back(budget_table(rule));
    if (rule.best()->monte_carlo) blocks.push_back(paragraph(monte_carlo_text(rule), "note"));
    return blocks;
}

std::vector<Block> budgets_of_all(const std::vector<RuleView>& rules) {
    std::vector<RuleView> certified;
    std::ranges::copy_if(rules, std::back_inserter(certified), &RuleView::best);
    if (certified.empty()) return {};
    constexpr std::size_t of_sources = 30;
    const bool of_one_unit = std::ranges::all_of(certified, [&](const RuleView& rule) {
        return rule.unit().name == certified.front().unit().name;
    });
    const auto unit_of = [](const RuleView& rule) { return fmt::format(", {}", rule.unit().name); };
    std::vector<std::string> heads{fmt::format("Contribution to the standard uncertainty{}|{}",
                                               of_one_unit ? unit_of(certified.front()) : "",
                                               of_sources)};
    std::vector<std::string> sources;
    Block legend = facts({}, "Budgets", "narrow");
    for (const RuleView& rule : certified) {
        const std::string name = fmt::format("Rule {}", heads.size());
        heads.push_back(fmt::format(">{}{}|{}", name, of_one_unit ? "" : unit_of(rule),
                                    (100 - of_sources) / certified.size()));
        add_fact(legend, name,
                 fmt::format("{}: {}", rule.profile.id,
                             measured_speed_text(rule.shown(), rule.verdict.coverage_factor)));
        for (const BudgetRow& row : rule.best()->budget)
            if (std::ranges::find(sources, row.source) == sources.end())
                sources.push_back(row.source);
    }
    Block block = table(heads, {}, "small");
    const auto add_each = [&](const std::string& name, auto cell, const char* mark) {
        TableRow& row = add_row(block, {name}, mark);
        std::ranges::transform(certified, std::back_inserter(row.cells), cell);
    };
    for (const std::string& source : sources)
        add_each(
            source,
            [&](const RuleView& rule) {
                const auto& budget = rule.best()->budget;
                const auto row = std::ranges::find(budget, source, &BudgetRow::source);
                return row == budget.end() ? "" : contribution_text(rule, row->contribution_m_s);
            },
            "");
    add_each(
        "Combined standard uncertainty",
        [](const RuleView& rule) {
            return contribution_text(rule, rule.best()->standard_uncertainty_m_s);
        },
        "total");
    add_each("Expanded uncertainty, with the limit of the bias of choosing", expanded_text,
             "total");
    return {std::move(legend), std::move(block),
            paragraph("Estimates, distributions, sensitivities and undetected errors of each rule: "
                      "runcert audit RUN_FOLDER.",
                      "note")};
}

}  // namespace runcert
