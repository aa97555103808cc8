#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/verdict/figures.h"
#include "stages/check/requirements.h"

namespace runcert {
namespace {

std::string per_unit(double speed_m_s, const DecimalRule& rule) {
    return fmt::format(
        "{} {}",
        format_fixed(speed_m_s / metres_per_second(rule.unit), static_cast<int>(rule.decimals)),
        rule.unit);
}

/// Why the measured speed is another than that of the body's arithmetic.
std::vector<std::string> reasons_of(const ClauseContext& context, const RuleScore& score) {
    const CertifiableWindow& best = *context.windows.best;
    const DecimalRule& unit = context.profile.arithmetic->rounding;
    std::vector<std::string> reasons;
    if (score.span.first_epoch != best.span.first_epoch ||
        score.span.last_epoch != best.span.last_epoch)
        reasons.push_back(fmt::format("its window is another, {}", beginning_text(best.span)));
    if (const auto& selection = best.selection;
        selection && selection->treatment == SelectionTreatment::subtracted &&
        selection->bias_m_s > 0.0)
        reasons.push_back(fmt::format("the selection bias of {} is taken off",
                                      per_unit(selection->bias_m_s, unit)));
    if (context.profile.speed_source == SpeedSource::position) {
        reasons.emplace_back("noise of single samples is smoothed");
        return reasons;
    }
    for (const BudgetRow& row : best.budget)
        if (row.symbol == "p" && row.estimate != 0.0)
            reasons.push_back(fmt::format(
                "what the speeds are {} by beside the positions, "
                "{:.2f} %, is taken off",
                row.estimate > 0.0 ? "too high" : "too low", 100.0 * std::abs(row.estimate)));
        else if (row.symbol == "f" && row.estimate > 0.0)
            reasons.push_back(
                fmt::format("the selection bias of {} is taken off", per_unit(row.estimate, unit)));
    if (reasons.empty()) reasons.emplace_back("the body rounds otherwise");
    return reasons;
}

}  // namespace

OwnArithmetic own_arithmetic(const ClauseContext& context) {
    const std::optional<RuleArithmetic>& rule = context.profile.arithmetic;
    OwnArithmetic own{.text =
                          rule ? rule->text
                               : "How the body itself computes a speed from samples is not known."};
    if (!rule) return own;
    const auto& score = context.windows.score;
    const bool less_current = context.profile.current == CurrentUse::subtracted;
    // Without a speed the current is not known, and cannot be taken off.
    if (!score || (less_current && !context.speed)) {
        own.text += " In this recording it gives no speed.";
        return own;
    }
    own.speed_m_s = score->speed_m_s - (less_current ? context.current->along_m_s : 0.0);
    const DecimalRule& rounding = rule->rounding;
    const double unit_m_s = metres_per_second(rounding.unit);
    const int decimals = static_cast<int>(rounding.decimals);
    const std::string figure =
        shown_figure(*own.speed_m_s / unit_m_s, decimals, direction_of(rounding));
    own.shown = fmt::format("{} {}", figure, rounding.unit);
    if (!score->screened) own.text += " Samples that screening left out are in it.";
    if (!context.shown) return own;
    // As the two stand on the page: both in one unit, as written.
    const double measured = parse_double(context.shown->speed).value() *
                            (metres_per_second(context.shown->unit) / unit_m_s);
    const double less = parse_double(figure).value() - measured;
    const std::string apart = format_fixed(std::abs(less), decimals);
    own.text += parse_double(apart).value() == 0.0
                    ? " The measured speed is the same."
                    : fmt::format(" The measured speed is {} {} {}: {}.", apart, rounding.unit,
                                  less > 0.0 ? "lower" : "higher",
                                  fmt::join(reasons_of(context, *score), "; "));
    return own;
}

}  // namespace runcert
