#include "reports/words/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/rounding.h"
#include "core/speed_unit.h"
#include "core/text.h"

namespace runcert {
namespace {

StepRounding rounding_of(SpeedKind kind) {
    switch (kind) {
        case SpeedKind::measured:
            return StepRounding::down;
        case SpeedKind::uncertainty:
        case SpeedKind::required:
        case SpeedKind::limit:
            return StepRounding::up;
        case SpeedKind::plain:
            break;
    }
    return StepRounding::nearest;
}

SpeedKind kind_of(SafeSide side) {
    return side == SafeSide::up ? SpeedKind::limit : SpeedKind::measured;
}

double kept_m_s(double speed_m_s) {
    return std::isfinite(speed_m_s) ? rounded(speed_m_s, speed_decimals_kept) : speed_m_s;
}

/// The decimals of an uncertainty's two digits in a unit.
int decimals_in(double expanded_uncertainty_m_s, const SpeedUnit& unit,
                std::optional<int> rule_decimals = std::nullopt) {
    return decimals_of(kept_m_s(expanded_uncertainty_m_s) * unit.per_m_s, rule_decimals);
}

/// The decimals in any unit of what is shown beside those figures.
int decimals_beside(const ShownFigures& shown, const SpeedUnit& unit) {
    if (shown.unit == unit.name) return decimals_of(shown);
    const double expanded_m_s =
        parse_double(shown.expanded_uncertainty).value_or(0.0) / speed_unit(shown.unit).per_m_s;
    return expanded_m_s > 0.0 ? decimals_in(expanded_m_s, unit) : unit.decimals;
}

std::string without_letters(std::string iso) {
    if (iso.ends_with('Z')) iso.pop_back();
    if (const std::size_t letter = iso.find('T'); letter != std::string::npos) iso[letter] = ' ';
    return iso;
}

}  // namespace

const std::array<SpeedUnit, 4>& speed_units() {
    static constexpr std::array<SpeedUnit, 4> units{
        {{"km_h", "km/h", km_h_per_m_s, 2, 4},
         {"m_s", "m/s", 1.0, 3, 6},
         {"knots", "kn", 3600.0 / metres_per_nautical_mile, 2, 4},
         {"mph", "mph", 3600.0 / metres_per_statute_mile, 2, 4}}};
    return units;
}

const SpeedUnit& speed_unit(std::string_view name) {
    if (name.empty()) return speed_units()[0];
    for (const SpeedUnit& unit : speed_units())
        if (unit.name == name) return unit;
    throw Failure("unit of speed", fmt::format("\"{}\" is not known", name),
                  "Use km/h, m/s, kn or mph");
}

std::string uncertainty_text(double uncertainty) {
    return format_fixed(uncertainty, uncertainty_decimals(uncertainty));
}

std::string significant_text(double value, int digits) {
    if (value == 0.0) return "0";
    if (!std::isfinite(value)) return "not determined";
    if (std::abs(value) < 1e-6) return scientific_text(value);
    // The exponent after rounding: 9.96 with two digits is 10.
    const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
    const int exponent = std::stoi(scientific.substr(scientific.find('e') + 1));
    return format_fixed(value, std::max(0, digits - 1 - exponent));
}

std::string number_text(double value, std::string_view unit) {
    return fmt::format("{:.9g}{}{}", value, unit.empty() ? "" : " ", unit);
}

std::string quantity_text(double value, std::optional<double> expanded_uncertainty,
                          std::string_view unit) {
    const std::string with_unit = unit.empty() ? "" : fmt::format(" {}", unit);
    if (!expanded_uncertainty || !(*expanded_uncertainty > 0.0))
        return (value != 0.0 && std::abs(value) < 1e-4 ? significant_text(value, 2)
                                                       : fmt::format("{:.6g}", value)) +
               with_unit;
    const std::string uncertainty = uncertainty_rounded_up(*expanded_uncertainty);
    return fmt::format("{}{} ± {}{}",
                       format_fixed(value, decimals_of(*expanded_uncertainty, std::nullopt)),
                       with_unit, uncertainty, with_unit);
}

std::string figure_value_text(const Figure& figure) {
    if (!figure.shown.empty()) return figure.shown;
    const std::string text = quantity_text(figure.value, figure.expanded_uncertainty, figure.unit);
    return figure.expanded_uncertainty && *figure.expanded_uncertainty > 0.0 ? text + " (k = 2)"
                                                                             : text;
}

std::string figure_text(const Figure& figure) {
    return fmt::format("{}: {}{}{}", figure.name, figure_value_text(figure),
                       figure.note.empty() ? "" : "; ", figure.note);
}

std::string coverage_text(double coverage_factor) {
    return fmt::format("{}", rounded(coverage_factor, 2));
}

std::string speed_text(double speed_m_s, std::optional<double> uncertainty_m_s,
                       const SpeedUnit& unit) {
    int decimals = unit.decimals;
    if (uncertainty_m_s)
        decimals = std::max(decimals, uncertainty_decimals(*uncertainty_m_s * unit.per_m_s));
    return format_fixed(speed_m_s * unit.per_m_s, decimals);
}

std::string speed_with_uncertainty_text(double speed_m_s, double expanded_uncertainty_m_s,
                                        const SpeedUnit& unit) {
    return measured_speed_text(shown_in(
        {.speed_m_s = speed_m_s, .expanded_uncertainty_m_s = expanded_uncertainty_m_s}, unit));
}

std::string shown_speed(SpeedKind kind, double speed_m_s, int decimals, const SpeedUnit& unit) {
    return shown_figure(kept_m_s(speed_m_s) * unit.per_m_s, decimals, rounding_of(kind),
                        speed_guard_m_s * unit.per_m_s);
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

int decimals_in(std::string_view figure) {
    const std::size_t point = figure.find('.');
    return point == std::string_view::npos ? 0 : static_cast<int>(figure.size() - point - 1);
}

std::string shown_difference(std::string_view figure, std::string_view less) {
    return format_fixed(parse_double(figure).value_or(0.0) - parse_double(less).value_or(0.0),
                        std::max(decimals_in(figure), decimals_in(less)));
}

int decimals_of(const ShownFigures& shown) {
    return decimals_in(shown.speed);
}

std::string beside(const ShownFigures& shown, double speed_m_s, SafeSide side) {
    return shown_speed(kind_of(side), speed_m_s, shown, speed_unit(shown.unit));
}

std::string speed_beside(const ProfileVerdict& verdict, double speed_m_s, std::string_view unit,
                         SafeSide side) {
    if (!verdict.speed_m_s) {
        const SpeedUnit& own = speed_unit(unit);
        return fmt::format("{} {}", shown_speed(kind_of(side), speed_m_s, own.decimals, own), unit);
    }
    const ShownFigures shown = shown_of(verdict, unit);
    return fmt::format("{} {}", beside(shown, speed_m_s, side), shown.unit);
}

std::string signed_difference(std::string_view figure, std::string_view less,
                              std::optional<int> decimals) {
    std::string text = shown_difference(figure, less);
    if (decimals) text = format_fixed(parse_double(text).value_or(0.0), *decimals);
    const bool more = text.find_first_of("123456789") != std::string::npos && text[0] != '-';
    return (more ? "+" : "") + text;
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

std::string seconds_text(ElapsedTime time) {
    return format_fixed(time.seconds(), 3) + " s";
}

namespace {

/// The time of day of "YYYY-MM-DDTHH:MM:SS.s".
std::string time_of_day(GpsTime time) {
    const std::string iso = to_utc_iso(time, 1);
    const std::size_t day = iso.find('T') + 1;
    return "at " + iso.substr(day, iso.find_first_not_of("0123456789:.", day) - day) + " UTC";
}

std::string after_first_epoch(ElapsedTime time) {
    return format_fixed(time.seconds(), 1) + " s after the first epoch";
}

}  // namespace

std::string instant_text(const std::optional<GpsTime>& first_epoch, ElapsedTime time) {
    return first_epoch ? time_of_day(first_epoch->plus_nanoseconds(time.nanoseconds))
                       : after_first_epoch(time);
}

std::string beginning_text(const WindowSpan& span) {
    return span.start_gps ? time_of_day(*span.start_gps) : after_first_epoch(span.start);
}

std::string time_span_text(double duration_s) {
    constexpr double long_s = 100.0;
    constexpr double whole_s = 1e-3;
    const bool whole = std::abs(duration_s - std::round(duration_s)) < whole_s;
    return format_fixed(duration_s, duration_s < long_s && !whole ? 1 : 0) + " s";
}

std::string utc_text(GpsTime time) {
    return without_letters(to_utc_iso(time, 3));
}

std::string gps_text(GpsTime time) {
    return without_letters(to_iso(time, 3));
}

std::string scientific_text(double value) {
    return std::isfinite(value) ? fmt::format("{:.1e}", value) : "not determined";
}

}  // namespace runcert
