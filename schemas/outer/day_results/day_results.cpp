#include "schemas/day_results/day_results.h"

#include <algorithm>

namespace runcert {

const DayResult* result_by(const AttemptResult& attempt, std::string_view profile) {
    const auto found = std::ranges::find(attempt.results, profile, &DayResult::profile);
    return found == attempt.results.end() ? nullptr : &*found;
}

AttemptsById attempts_by_id(const DayResults& results) {
    AttemptsById attempts;
    for (const AttemptResult& attempt : results.attempts)
        if (const auto [found, added] = attempts.try_emplace(attempt.id, &attempt);
            !added && attempt.state == "done")
            found->second = &attempt;
    return attempts;
}

}  // namespace runcert
