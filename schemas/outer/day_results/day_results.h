#pragma once

#include <map>

#include "schemas/day_results/declared.h"

namespace runcert {

/// What that rule says of the attempt, or null where it does not claim it.
const DayResult* result_by(const AttemptResult& attempt, std::string_view profile);

/// Attempts by their id; of equal ids the one that is done.
using AttemptsById = std::map<std::string_view, const AttemptResult*>;
AttemptsById attempts_by_id(const DayResults& results);

}  // namespace runcert
