#pragma once

#include <string>
#include <vector>

#include "stages/check/check.h"

namespace runcert {

/// What must be read with every figure of the measurement, a sentence or two each: what the
/// uncertainty covers, how the noise was estimated and where it could not be, how the filter fared,
/// what the recording does not say.
std::vector<std::string> statements_of(const CheckInput& input);

/// Whether the recorded velocities are of another speed than the positions show, all over the
/// recording: by more than 2 % and four standard uncertainties of their ratio.
bool is_another_speed(const VelocityComparison& velocity);

/// By how much, a sentence.
std::string another_speed_text(const VelocityComparison& velocity);

}  // namespace runcert
