#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "schemas/day_results/day_results.h"

namespace runcert {

/// An outcome as people read it: in words, with a sign beside them, and how the page colours it.
struct OutcomeWords {
    std::string words;
    std::string sign;
    std::string tone;  ///< "yes", "open", "no", "refused"
};
OutcomeWords outcome_words(const DayResult& result);

/// A speed in the rule's unit, as text and as numbers for a drawing.
struct SpeedWords {
    std::string speed;           ///< "202.91"
    std::string uncertainty;     ///< "0.32"
    std::string required_speed;  ///< "205.34"; empty where no record is named
    std::string unit;            ///< "km/h"
};
/// As the verdict shows it; of a verdict that shows none, in m/s with three decimals. Nothing where
/// there is no speed.
std::optional<SpeedWords> speed_words(const DayResult& result);

/// "2022-03-18 08:51:22.300 UTC", or "12.340 s after the first epoch"; empty where there is no
/// window.
std::string window_words(const DayResult& result);

/// "not told apart from rank 2", "... from ranks 1 to 4"; empty where both neighbours are.
/// `above` and `below` are the ranks next to its own.
std::string told_apart_words(const DayPlace& place, std::optional<std::int64_t> above,
                             std::optional<std::int64_t> below);

/// What the best of the day's attempts is as the best of so many, in a sentence.
std::string best_words(const BestOfDay& best);

/// A file's name as a relative link: every byte but letters, digits and - . _ ~ / as %NN.
std::string link_to(std::string_view file);

}  // namespace runcert
