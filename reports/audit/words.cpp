#include "reports/audit/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace runcert {
namespace {

/// The part along one axis: "0.174 m east", "0.057 m south".
std::string part(double value, std::string_view unit, std::string_view towards,
                 std::string_view away, const std::string& uncertainty = {}) {
    return fmt::format("{} {}{} {}", format_fixed(std::abs(value), 3), unit, uncertainty,
                       value < 0.0 ? away : towards);
}

}  // namespace

std::string one_or_range(const std::string& low, const std::string& high) {
    return low == high ? low : low + " to " + high;
}

std::string once_in(double probability) {
    const double times = 1.0 / probability;
    if (!(times < 1e15)) return fmt::format("less than once in {} million", counted(1'000'000'000));
    const double unit = times < 1e6 ? 1.0 : 1e6;
    const double value = times / unit;
    // Two digits that count.
    const double step = std::pow(10.0, std::max(0.0, std::floor(std::log10(value)) - 1.0));
    const auto whole = static_cast<std::int64_t>(std::llround(value / step) * std::llround(step));
    return fmt::format("once in {}{}", counted(whole), unit > 1.0 ? " million" : "");
}

std::string components(const EstimatedError& error) {
    const auto plus_minus = [](double sigma_m) {
        return fmt::format(" ± {} m", format_fixed(sigma_m, 3));
    };
    if (error.up_m)
        return part(*error.up_m, "m", "up", "down",
                    error.sigma_up_m ? plus_minus(*error.sigma_up_m) : "");
    if (!error.east_m || !error.north_m) return {};
    std::string east_uncertainty;
    std::string north_uncertainty;
    if (error.sigma_east_m && error.sigma_north_m) {
        east_uncertainty = plus_minus(*error.sigma_east_m);
        north_uncertainty = plus_minus(*error.sigma_north_m);
    }
    const bool equal = east_uncertainty == north_uncertainty;
    std::string text = part(*error.east_m, "m", "east", "west", equal ? "" : east_uncertainty) +
                       ", " +
                       part(*error.north_m, "m", "north", "south", equal ? "" : north_uncertainty);
    if (equal && !east_uncertainty.empty()) text += ", each" + east_uncertainty;
    return text;
}

std::optional<double> size_of(const EstimatedError& error) {
    if (error.up_m) return std::abs(*error.up_m);
    if (error.east_m && error.north_m) return std::hypot(*error.east_m, *error.north_m);
    return std::nullopt;
}

std::optional<double> rate_of(const EstimatedError& error) {
    if (error.rate_up_m_s) return std::abs(*error.rate_up_m_s);
    if (error.rate_east_m_s && error.rate_north_m_s)
        return std::hypot(*error.rate_east_m_s, *error.rate_north_m_s);
    return std::nullopt;
}

std::string rate_components(const EstimatedError& error) {
    if (error.rate_up_m_s) return part(*error.rate_up_m_s, "m/s", "up", "down");
    if (!error.rate_east_m_s || !error.rate_north_m_s) return {};
    return part(*error.rate_east_m_s, "m/s", "east", "west") + ", " +
           part(*error.rate_north_m_s, "m/s", "north", "south");
}

}  // namespace runcert
