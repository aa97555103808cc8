#pragma once

#include <optional>
#include <string>

// How figures are rounded: those that are kept, and those that people read.

namespace runcert {

/// `value` rounded to that many decimals, so that its shortest form has no more than these.
/// Failure where it is not finite.
double rounded(double value, int decimals);

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

/// The side to which rounding cannot flatter the claim: a speed is rounded down, an uncertainty and
/// a required speed are rounded up.
enum class SafeSide { down, up };

/// The figure with so many decimals (0 to 9), never rounded to the wrong side. A value that is a
/// decimal figure but for a few units of its last binary place (as a conversion leaves them) is
/// that figure: 222.87 with two decimals is "222.87" on both sides. A zero has no sign. Failure (at
/// "rounding") for a value that is not finite, decimals outside 0 to 9, or more than 15 digits.
std::string shown_figure(double value, int decimals, SafeSide side);

/// Decimals to show: the rule's, but no more than the expanded uncertainty justifies, which are
/// those (0 to 6) of its two significant digits when it is itself rounded up (0.164: "0.17", so 2;
/// 0.0991: "0.10", so 2). The uncertainty is in the unit that is shown; 0 sets no bound, and
/// without a rule's gives 2. Failure (at "rounding") for an uncertainty that is negative or not
/// finite, or decimals outside 0 to 9.
int decimals_of(double expanded_uncertainty, std::optional<int> rule_decimals);

/// Decimals (0 to 6) that show two significant digits of an uncertainty; 2 for zero. For a figure
/// beside it that is rounded to the nearest.
int uncertainty_decimals(double uncertainty);

/// An uncertainty rounded up to two significant digits, never shown smaller than it is: "0.17".
std::string uncertainty_rounded_up(double uncertainty);

}  // namespace runcert
