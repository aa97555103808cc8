#include "stages/check/shown_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "stages/check/decimal_steps.h"

namespace runcert {
namespace {

constexpr int kMostShown = 6;
constexpr int kShownWithoutUncertainty = 2;

void require_decimals(int decimals) {
    if (decimals < 0 || decimals > kMostDecimals)
        throw Failure("rounding", fmt::format("{} decimals", decimals),
                      fmt::format("Give 0 to {}", kMostDecimals));
}

/// The value in units of the last place, rounded to the safe side.
double steps_of(double value, int decimals, SafeSide side) {
    const double steps = value * power_of_ten(decimals);
    return whole_steps(steps, kBinaryNoise * std::abs(steps),
                       side == SafeSide::up ? StepRounding::up : StepRounding::down);
}

int decimals_of_two_digits(double uncertainty) {
    int decimals = 0;
    while (decimals < kMostShown && steps_of(uncertainty, decimals, SafeSide::down) < 10.0)
        ++decimals;
    // Rounding up may add a digit: 0.0991 to 0.10.
    const bool carries = steps_of(uncertainty, decimals, SafeSide::up) >= 100.0;
    return carries ? std::max(0, decimals - 1) : decimals;
}

}  // namespace

std::string shown_figure(double value, int decimals, SafeSide side) {
    require_decimals(decimals);
    const double steps = steps_of(value, decimals, side);
    // Adding 0 takes the sign from a zero.
    return fmt::format("{:.{}f}", steps / power_of_ten(decimals) + 0.0, decimals);
}

int decimals_of(double expanded_uncertainty, std::optional<int> rule_decimals) {
    if (!(expanded_uncertainty >= 0.0 && std::isfinite(expanded_uncertainty)))
        throw Failure("rounding",
                      fmt::format("the expanded uncertainty is {}", expanded_uncertainty),
                      "Give a finite number, 0 or more");
    if (rule_decimals) require_decimals(*rule_decimals);
    if (expanded_uncertainty == 0.0) return rule_decimals.value_or(kShownWithoutUncertainty);
    const int justified = decimals_of_two_digits(expanded_uncertainty);
    return std::min(justified, rule_decimals.value_or(justified));
}

}  // namespace runcert
