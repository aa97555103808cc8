#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "core/text.h"
#include "core/uncertainty.h"
#include "reports/certificate/json_parts.h"

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

void set_row_texts(Json& json, const BudgetRow& row, const SpeedUnit& unit) {
    const std::string quantity_unit =
        is_speed(row) ? std::string(unit.name) : written_unit(row.unit);
    const double factor = is_speed(row) ? unit.per_m_s : 1.0;
    json["estimate_text"] = with_unit(short_text(row.estimate * factor, 4), quantity_unit);
    json["uncertainty_text"] =
        with_unit(significant_text(row.standard_uncertainty * factor, 2), quantity_unit);
    json["evaluation_text"] = fmt::format("{}, {}", row.type, row.distribution);
    json["degrees_text"] = degrees_text(row.degrees_of_freedom);
    if (is_speed(row)) {
        json["sensitivity_text"] = short_text(row.sensitivity, 3);
        return;
    }
    json["sensitivity_text"] =
        fmt::format("{} {}{}{}", significant_text(row.sensitivity * unit.per_m_s, 3), unit.name,
                    quantity_unit.empty() ? "" : " per ", quantity_unit);
}

double variance_of(const std::vector<BudgetRow>& rows) {
    double sum = 0.0;
    for (const BudgetRow& row : rows)
        sum += row.contribution_m_s * row.contribution_m_s;
    return sum;
}

/// Both intervals of 95 %, in words that say which of them is on the safe side.
std::string interval_words(const MonteCarloCheck& check, const LinearisationJudgement& judged,
                           const UncertaintyScale& scale) {
    const auto text = [&](double speed_m_s) {
        return speed_text(speed_m_s, check.standard_uncertainty_m_s, scale.unit);
    };
    const std::string both =
        fmt::format("The budget's 95 % interval, {} to {} {}, ", text(judged.lower_m_s),
                    text(judged.upper_m_s), scale.unit.name);
    if (judged.interval_agrees) return both + "agrees within that tolerance.";
    return both + (judged.interval_holds ? "holds it and is wider: it is on the safe side."
                                         : "does not agree within that tolerance.");
}

}  // namespace

Json budget_json(const CertifiableWindow& window, const UncertaintyScale& scale) {
    const double variance = variance_of(window.budget);
    Json rows = Json::array();
    for (const BudgetRow& row : window.budget) {
        const double share =
            variance > 0.0 ? row.contribution_m_s * row.contribution_m_s / variance : 0.0;
        Json json = members_json(row);
        json["share_percent"] = 100.0 * share;
        set_row_texts(json, row, scale.unit);
        json["contribution_text"] = contribution_text(row.contribution_m_s, window, scale.unit);
        json["share_text"] = row.contribution_m_s == 0.0
                                 ? std::string("0 %")
                                 : fmt::format("{} %", format_fixed(100.0 * share, 1));
        rows.push_back(std::move(json));
    }
    return rows;
}

Json budget_total_json(const CertifiableWindow& window, const UncertaintyScale& scale) {
    const double expanded_m_s = expanded_uncertainty_m_s(window, scale.coverage_factor);
    Json json{
        {"budget_unit", scale.unit.name},
        {"combined_text", contribution_text(window.standard_uncertainty_m_s, window, scale.unit)},
        {"effective_text", degrees_text(window.effective_degrees_of_freedom)},
        {"coverage_text", coverage_text(scale.coverage_factor)},
        {"expanded_text", uncertainty_rounded_up(expanded_m_s * scale.unit.per_m_s)}};
    if (window.bias_limit_m_s > 0.0)
        json["limit_text"] = contribution_text(window.bias_limit_m_s, window, scale.unit);
    return json;
}

Json monte_carlo_json(const CertifiableWindow& window, const UncertaintyScale& scale) {
    const MonteCarloCheck& check = *window.monte_carlo;
    const LinearisationJudgement judged = judge_linearisation(window);
    Json json = members_json(check);
    json["budget_lower_m_s"] = judged.lower_m_s;
    json["budget_upper_m_s"] = judged.upper_m_s;
    json["uncertainty_agrees"] = judged.uncertainty_agrees;
    json["interval_agrees"] = judged.interval_agrees;
    const auto text = [&](double speed_m_s) {
        return speed_text(speed_m_s, check.standard_uncertainty_m_s, scale.unit);
    };
    json["monte_carlo_words"] = fmt::format(
        "Check of linearisation, the same rows drawn {} times (Monte Carlo, seed {}): {} {}, u = "
        "{} {}, 95 % interval {} to {} {}; {}, numerical tolerance {} {}. Its u {} with the "
        "budget's. {}",
        check.trials, check.seed, text(check.mean_m_s), scale.unit.name,
        contribution_text(check.standard_uncertainty_m_s, window, scale.unit), scale.unit.name,
        text(check.lower_m_s), text(check.upper_m_s), scale.unit.name,
        check.converged ? "converged" : "not converged",
        significant_text(check.tolerance_m_s * scale.unit.per_m_s, 2), scale.unit.name,
        judged.uncertainty_agrees ? "agrees" : "does not agree",
        interval_words(check, judged, scale));
    return json;
}

}  // namespace runcert
