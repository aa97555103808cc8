#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "reports/words/outcome.h"
#include "schemas/day_results/day_results.h"

namespace runcert {

/// What the title of a result speaks of.
OutcomeState state_of(const DayResult& result);

/// "2022-03-18 08:51:22.300 UTC", or "12.340 s after the first epoch"; empty where there is no
/// window.
std::string window_words(const DayResult& result);

/// "cannot be separated from rank 2", "... from ranks 1 to 4"; empty where both neighbours are.
/// `above` and `below` are the ranks next to its own.
std::string told_apart_words(const DayPlace& place, std::optional<std::int64_t> above,
                             std::optional<std::int64_t> below);

/// What the best of the day's attempts is as the best of so many, in a sentence.
std::string best_words(const BestOfDay& best);

/// A file's name as a relative link: every byte but letters, digits and - . _ ~ / as %NN.
std::string link_to(std::string_view file);

}  // namespace runcert
