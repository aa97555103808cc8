#pragma once

#include <string>

#include "schemas/screened/screened.h"

// What screening found of witnesses, without a capital and a full stop, to be put after a label or
// into a sentence.

namespace runcert {

/// "43 s behind", "0.12 s ahead of".
std::string delay_words(double delay_s);

/// "over epochs 71 to 375 they are 43 s behind the positions (the speeds differ by 6.27 m/s, at
/// that delay by 0.30 m/s)": where recorded velocities have a delay that is not taken off, if so.
std::string other_moments_text(const VelocityComparison& velocity);

/// "they contradict the positions at 96 % of the epochs"; empty where they are fit for a speed.
std::string unfit_text(const VelocityComparison& velocity);

/// "Carrier phases of the receiver's raw signals: over 3 s they differ by 0.012 m per axis (57
/// spans) and contradict 2 epochs", without its end.
std::string displacement_comparison_text(const DisplacementComparison& comparison);

}  // namespace runcert
