#pragma once

#include "schemas/day_results/declared.h"

namespace runcert {

/// What that rule says of the attempt, or null where it does not claim it.
const DayResult* result_by(const AttemptResult& attempt, std::string_view profile);

}  // namespace runcert
