#include "schemas/day_results/day_results.h"

#include <algorithm>

namespace runcert {

const DayResult* result_by(const AttemptResult& attempt, std::string_view profile) {
    const auto found = std::ranges::find(attempt.results, profile, &DayResult::profile);
    return found == attempt.results.end() ? nullptr : &*found;
}

}  // namespace runcert
