#pragma once

namespace runcert {

/// Relative error that a few operations on binary fractions leave (16 units in the last place):
/// speeds that differ by less are equal.
constexpr double kBinaryNoise = 16.0 * 2.220446049250313e-16;

/// Decimals that a figure may have.
constexpr int kMostDecimals = 9;

/// 10^decimals, exact; decimals 0 to 9.
double power_of_ten(int decimals);

enum class StepRounding { down, nearest, up };

/// A figure counted in units of its last place, to a whole number: a figure within `tolerance` of a
/// whole number (or, for `nearest`, below a half) counts as that. `nearest` takes a half up.
/// Failure (at "rounding") for more than 15 digits or a figure that is not finite.
double whole_steps(double steps, double tolerance, StepRounding mode);

}  // namespace runcert
