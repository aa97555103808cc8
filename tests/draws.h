#pragma once

#include <cstdlib>

namespace runcert {

/// How many draws a test makes, or how many times it tries.
struct Draws {
    int daily;  ///< sized by what the test must tell apart; the test says it
    int study;  ///< under the label study
};

/// Whether a study runs and not the daily set: CTest sets RUNCERT_STUDY for those of that label.
inline bool is_study() {
    return std::getenv("RUNCERT_STUDY") != nullptr;
}

/// The number for the set that runs.
inline int draws(const Draws& numbers) {
    return is_study() ? numbers.study : numbers.daily;
}

}  // namespace runcert
