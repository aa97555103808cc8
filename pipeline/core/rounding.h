#pragma once

#include <optional>
#include <string>

// Rounding of stored figures and of figures shown to people.

namespace runcert {

/// `value` rounded to `decimals` decimals, so that its shortest text has no more than these.
/// Failure if it is not finite.
double rounded(double value, int decimals);

/// Relative error that a few operations on binary fractions leave (16 units in the last place).
/// Speeds that differ by less count as equal.
constexpr double kBinaryNoise = 16.0 * 2.220446049250313e-16;

/// Largest number of decimals of a figure.
constexpr int kMostDecimals = 9;

/// 10^decimals, exact; decimals 0 to 9.
double power_of_ten(int decimals);

/// Direction of rounding to whole steps.
enum class StepRounding { down, nearest, up };

/// Rounds a figure, counted in units of its last place, to a whole number. A figure within
/// `tolerance` of a whole number (or, for `nearest`, below a half) counts as that number. `nearest`
/// rounds a half up. Failure (at "rounding") for more than 15 digits or a figure that is not
/// finite.
double whole_steps(double steps, double tolerance, StepRounding mode);

/// The rounding direction that cannot favour the claim. Speeds are rounded down; uncertainties and
/// required speeds are rounded up.
enum class SafeSide { down, up };

/// The figure with `decimals` decimals (0 to 9), always rounded to the safe side. A value within a
/// few units of its last binary place of a decimal figure, as a conversion leaves it, counts as
/// that figure: 222.87 with two decimals is "222.87" on both sides. Zero has no sign. Failure (at
/// "rounding") for a value that is not finite, decimals outside 0 to 9, or more than 15 digits.
std::string shown_figure(double value, int decimals, SafeSide side);

/// The same in any direction. A value within `guard`, in its own unit, of a decimal figure counts
/// as that figure, too: what was kept with fewer digits than it was computed with.
std::string shown_figure(double value, int decimals, StepRounding direction, double guard = 0.0);

/// Number of decimals to show: the rule's, but no more than the expanded uncertainty justifies. An
/// uncertainty justifies the decimals (0 to 6) of its two significant digits when rounded up
/// (0.164: "0.17", so 2; 0.0991: "0.10", so 2). The uncertainty has the unit that is shown. Zero
/// sets no limit and, without a rule's decimals, gives 2. Failure (at "rounding") for an
/// uncertainty that is negative or not finite, or decimals outside 0 to 9.
int decimals_of(double expanded_uncertainty, std::optional<int> rule_decimals);

/// Decimals (0 to 6) that show two significant digits of an uncertainty; 2 for zero. Meant for a
/// figure beside it that is rounded to nearest.
int uncertainty_decimals(double uncertainty);

/// An uncertainty rounded up to two significant digits, so that it is never understated: "0.17".
std::string uncertainty_rounded_up(double uncertainty);

}  // namespace runcert
