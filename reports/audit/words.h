#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/prose.h"
#include "core/text.h"
#include "schemas/screened/screened.h"

// The words that the parts of an audit share.

namespace runcert {

/// How often something of that probability happens: "once in 590 million".
std::string once_in(double probability);

/// "3 to 5", or "3" where both are the same.
std::string one_or_range(const std::string& low, const std::string& high);

/// The figures of rows that share a decision, "0.183 m to 0.350 m"; `unit` begins with its blank.
/// `figure(row)` is an optional; empty where there is none or one is missing.
template <class Rows, class Figure>
std::string range_text(const Rows& rows, int decimals, std::string_view unit, Figure figure) {
    std::optional<double> low;
    std::optional<double> high;
    for (const ScreenedEpoch& row : rows) {
        const std::optional<double> value = figure(row);
        if (!value) return {};
        low = std::min(low.value_or(*value), *value);
        high = std::max(high.value_or(*value), *value);
    }
    if (!low) return {};
    return one_or_range(format_fixed(*low, decimals) + std::string(unit),
                        format_fixed(*high, decimals) + std::string(unit));
}

/// An error towards two directions, or upwards, with its standard uncertainties: "0.174 m east,
/// 0.057 m south, each +- 0.020 m". Empty where nothing was estimated.
std::string components(const EstimatedError& error);
/// Its length, m; nothing where it was not estimated. The same of a ramp, m/s.
std::optional<double> size_of(const EstimatedError& error);
std::optional<double> rate_of(const EstimatedError& error);
/// A ramp towards two directions, or upwards.
std::string rate_components(const EstimatedError& error);

}  // namespace runcert
