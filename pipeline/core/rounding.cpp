#include "core/rounding.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr int kMostShown = 6;
constexpr int kShownWithoutUncertainty = 2;

void require_decimals(int decimals) {
    if (decimals < 0 || decimals > kMostDecimals)
        throw Failure("rounding", fmt::format("{} decimals", decimals),
                      fmt::format("Give 0 to {}", kMostDecimals));
}

StepRounding direction_of(SafeSide side) {
    return side == SafeSide::up ? StepRounding::up : StepRounding::down;
}

/// The value in units of the last place, rounded.
double steps_of(double value, int decimals, StepRounding direction, double guard = 0.0) {
    const double scale = power_of_ten(decimals);
    const double steps = value * scale;
    return whole_steps(steps, std::max(guard * scale, kBinaryNoise * std::abs(steps)), direction);
}

int decimals_of_two_digits(double uncertainty) {
    int decimals = 0;
    while (decimals < kMostShown && steps_of(uncertainty, decimals, StepRounding::down) < 10.0)
        ++decimals;
    // Rounding up may carry into another digit: 0.0991 becomes 0.10.
    const bool carries = steps_of(uncertainty, decimals, StepRounding::up) >= 100.0;
    return carries ? std::max(0, decimals - 1) : decimals;
}

}  // namespace

double rounded(double value, int decimals) {
    if (!std::isfinite(value))
        throw Failure("document", "a result is not a finite number",
                      "This is a fault of the program or of its input; please report it with the "
                      "run folder");
    return parse_double(format_fixed(value, decimals)).value();
}

double power_of_ten(int decimals) {
    assert(decimals >= 0 && decimals <= kMostDecimals);
    double power = 1.0;
    for (int i = 0; i < decimals; ++i)
        power *= 10.0;
    return power;
}

double whole_steps(double steps, double tolerance, StepRounding mode) {
    constexpr double most = 1e15;
    if (!(std::abs(steps) < most))
        throw Failure("rounding",
                      fmt::format("{} units of the last place are no figure of 15 digits", steps),
                      "Give a finite speed, or fewer decimals");
    const double whole = std::round(steps);
    if (std::abs(steps - whole) <= tolerance) return whole;
    switch (mode) {
        case StepRounding::down:
            return std::floor(steps);
        case StepRounding::up:
            return std::ceil(steps);
        case StepRounding::nearest:
            break;
    }
    return std::floor(steps + 0.5 + tolerance);
}

std::string shown_figure(double value, int decimals, SafeSide side) {
    return shown_figure(value, decimals, direction_of(side));
}

std::string shown_figure(double value, int decimals, StepRounding direction, double guard) {
    require_decimals(decimals);
    const double steps = steps_of(value, decimals, direction, guard);
    // Adding 0 removes the sign of a zero.
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

int uncertainty_decimals(double uncertainty) {
    if (!(uncertainty > 0.0)) return 2;
    int decimals = 0;
    for (double scaled = uncertainty; scaled < 9.95 && decimals < 6; scaled *= 10.0)
        ++decimals;
    return decimals;
}

std::string uncertainty_rounded_up(double uncertainty) {
    return shown_figure(uncertainty, decimals_of(uncertainty, std::nullopt), SafeSide::up);
}

}  // namespace runcert
