#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "reports/day/day.h"
#include "reports/plot/plot.h"
#include "schemas/document/document.h"
#include "schemas/verdict/outcome.h"

namespace runcert {

/// One rule: its counts, its pictures and its ranking.
struct RankingPart {
    Section section;
    Plots plots;  ///< of that number and the next ones
};
RankingPart ranking_part(const DayProfile& profile, const AttemptsById& attempts,
                         const WindowCurves& curves, std::size_t number);

/// The rankings for a terminal: a line for each place (rank, attempt, speed, outcome), none cut.
std::string ranking_text(const DayResults& results);

/// What the title of a result speaks of.
OutcomeState state_of(const DayResult& result);

/// "2022-03-18 08:51:22.300 UTC", "12.340 s after the first epoch"; empty without a window.
std::string window_words(const DayResult& result);

/// "cannot be separated from rank 2", "... from ranks 1 to 4"; empty where both neighbours are.
/// `above` and `below` are the ranks next to its own.
std::string separation_words(const DayPlace& place, std::optional<std::int64_t> above,
                             std::optional<std::int64_t> below);

/// What the best of the day's attempts is as the best of so many, in a sentence.
std::string best_words(const BestOfDay& best);

}  // namespace runcert
