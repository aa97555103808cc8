#include "core/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
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

std::string shown_speed(SpeedKind kind, double speed_m_s, int decimals, const SpeedUnit& unit) {
    return shown_figure(speed_as_kept_m_s(speed_m_s) * unit.per_m_s, decimals, rounding_of(kind),
                        speed_guard_m_s * unit.per_m_s);
}

int decimals_in(std::string_view figure) {
    const std::size_t point = figure.find('.');
    return point == std::string_view::npos ? 0 : static_cast<int>(figure.size() - point - 1);
}

std::string shown_difference(std::string_view figure, std::string_view less) {
    return format_fixed(parse_double(figure).value_or(0.0) - parse_double(less).value_or(0.0),
                        std::max(decimals_in(figure), decimals_in(less)));
}

std::string signed_difference(std::string_view figure, std::string_view less,
                              std::optional<int> decimals) {
    std::string text = shown_difference(figure, less);
    if (decimals) text = format_fixed(parse_double(text).value_or(0.0), *decimals);
    const bool more = text.find_first_of("123456789") != std::string::npos && text[0] != '-';
    return (more ? "+" : "") + text;
}

std::string time_of_day_text(GpsTime time) {
    const std::string iso = to_utc_iso(time, 1);
    const std::size_t day = iso.find('T') + 1;
    return "at " + iso.substr(day, iso.find_first_not_of("0123456789:.", day) - day) + " UTC";
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

double speed_as_kept_m_s(double speed_m_s) {
    return std::isfinite(speed_m_s) ? rounded(speed_m_s, speed_decimals_kept) : speed_m_s;
}

bool begins_after(const std::string& day, GpsTime instant) {
    // Where the date changes first, local time is 14 hours ahead.
    constexpr double ahead_s = 14.0 * 3600.0;
    return parse_gps_iso(day + "T00:00:00").seconds_since(instant) > ahead_s;
}

}  // namespace runcert
