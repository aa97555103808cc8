#pragma once

#include <optional>
#include <string>

namespace runcert {

/// The side to which rounding cannot flatter the claim: a speed is rounded down, an uncertainty and
/// a speed to reach are rounded up.
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

}  // namespace runcert
