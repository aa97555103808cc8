#include "schemas/verdict/figures.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text.h"

namespace runcert {
namespace {

SpeedKind kind_of(SafeSide side) {
    return side == SafeSide::up ? SpeedKind::limit : SpeedKind::measured;
}

/// The decimals of an uncertainty's two digits in a unit.
int decimals_in(double expanded_uncertainty_m_s, const SpeedUnit& unit,
                std::optional<int> rule_decimals = std::nullopt) {
    return decimals_of(speed_as_kept_m_s(expanded_uncertainty_m_s) * unit.per_m_s, rule_decimals);
}

/// The decimals in any unit of what is shown beside those figures.
int decimals_beside(const ShownFigures& shown, const SpeedUnit& unit) {
    if (shown.unit == unit.name) return decimals_of(shown);
    const double expanded_m_s =
        parse_double(shown.expanded_uncertainty).value_or(0.0) / speed_unit(shown.unit).per_m_s;
    return expanded_m_s > 0.0 ? decimals_in(expanded_m_s, unit) : unit.decimals;
}

}  // namespace

std::string figure_value_text(const Figure& figure) {
    if (!figure.shown.empty()) return figure.shown;
    const std::string text = quantity_text(figure.value, figure.expanded_uncertainty, figure.unit);
    return figure.expanded_uncertainty && *figure.expanded_uncertainty > 0.0 ? text + " (k = 2)"
                                                                             : text;
}

std::string limit_text(const Figure& figure) {
    if (!figure.relation || !figure.limit) return {};
    return fmt::format(", {} {}", words_of(*figure.relation),
                       quantity_text(*figure.limit, std::nullopt, figure.unit));
}

std::string figure_text(const Figure& figure) {
    return fmt::format("{}: {}{}{}{}", figure.name, figure_value_text(figure), limit_text(figure),
                       figure.note.empty() ? "" : "; ", figure.note);
}

std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit) {
    return measured_speed_text(shown_in(
        {.speed_m_s = speed_m_s, .expanded_uncertainty_m_s = expanded_uncertainty_m_s}, unit));
}

std::string shown_speed(SpeedKind kind, double speed_m_s, const ShownFigures& beside,
                        const SpeedUnit& unit) {
    const int decimals = decimals_beside(beside, unit);
    return shown_speed(kind, speed_m_s,
                       kind == SpeedKind::plain ? std::max(decimals, unit.decimals) : decimals,
                       unit);
}

ShownFigures shown_in(const SpeedsToShow& speeds, const SpeedUnit& unit,
                      std::optional<int> rule_decimals) {
    const int decimals = decimals_in(speeds.expanded_uncertainty_m_s, unit, rule_decimals);
    const auto shown = [&](SpeedKind kind, double speed_m_s) {
        return shown_speed(kind, speed_m_s, decimals, unit);
    };
    ShownFigures figures{
        .unit = std::string(unit.name),
        .speed = shown(SpeedKind::measured, speeds.speed_m_s),
        .expanded_uncertainty = shown(SpeedKind::uncertainty, speeds.expanded_uncertainty_m_s)};
    if (speeds.required_speed_m_s)
        figures.required_speed = shown(SpeedKind::required, *speeds.required_speed_m_s);
    if (speeds.acceptance_limit_m_s)
        figures.acceptance_limit = shown(SpeedKind::limit, *speeds.acceptance_limit_m_s);
    return figures;
}

ShownFigures shown_of(const ProfileVerdict& verdict, std::string_view unit) {
    if (verdict.shown) return *verdict.shown;
    SpeedsToShow speeds{.speed_m_s = verdict.speed_m_s.value(),
                        .expanded_uncertainty_m_s = verdict.expanded_uncertainty_m_s.value_or(0.0),
                        .required_speed_m_s = verdict.required_speed_m_s};
    if (verdict.decision) speeds.acceptance_limit_m_s = verdict.decision->acceptance_limit_m_s;
    return shown_in(speeds, speed_unit(unit));
}

int decimals_of(const ShownFigures& shown) {
    return decimals_in(shown.speed);
}

std::string in_decimals_of(const ShownFigures& shown, double speed_m_s, SafeSide side) {
    return shown_speed(kind_of(side), speed_m_s, shown, speed_unit(shown.unit));
}

std::string speed_beside(const ProfileVerdict& verdict, double speed_m_s, std::string_view unit,
                         SafeSide side) {
    if (!verdict.speed_m_s) {
        const SpeedUnit& own = speed_unit(unit);
        return fmt::format("{} {}", shown_speed(kind_of(side), speed_m_s, own.decimals, own), unit);
    }
    const ShownFigures shown = shown_of(verdict, unit);
    return fmt::format("{} {}", in_decimals_of(shown, speed_m_s, side), shown.unit);
}

ComparedSpeeds compared_in(const SpeedUnit& unit, const SpeedsToShow& other, double judged_m_s,
                           const ShownFigures& page) {
    const ShownFigures shown = shown_in(other, unit, decimals_of(page));
    const std::string judged =
        shown_speed(SpeedKind::measured, judged_m_s, decimals_of(page), unit);
    return {.other = measured_speed_text(shown),
            .judged = fmt::format("{} {}", judged, unit.name),
            .difference = fmt::format(
                "{} {}", signed_difference(shown.speed, judged, decimals_of(shown)), unit.name)};
}

std::string measured_speed_text(const ShownFigures& shown) {
    return fmt::format("{0} {2} ± {1} {2}", shown.speed, shown.expanded_uncertainty, shown.unit);
}

std::string own_arithmetic_text(const OwnArithmetic& own) {
    if (own.shown.empty()) return own.text;
    return fmt::format("By the rule's own arithmetic: {}. {}", own.shown, own.text);
}

std::string measured_speed_text(const ShownFigures& shown, double coverage_factor) {
    return fmt::format("{} (k = {})", measured_speed_text(shown), coverage_text(coverage_factor));
}

}  // namespace runcert
