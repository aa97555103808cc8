#include "stages/check/decimal_steps.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "core/failure.h"

namespace runcert {

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

}  // namespace runcert
