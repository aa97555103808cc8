#pragma once

#include <string>
#include <vector>

#include "stages/check/check.h"

namespace runcert {

/// What must be read with every figure of the measurement, a sentence or two each: what the
/// uncertainty covers, how the noise was estimated and where it could not be, how the filter fared,
/// what the recording does not say.
std::vector<std::string> statements_of(const CheckInput& input);

}  // namespace runcert
