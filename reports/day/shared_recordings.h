#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schemas/day_results/day_results.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// Which attempts of a day rest on one recording, or on recordings that overlap: with files of the
/// same bytes, or with ten epochs and more that have the same time (to the millisecond) and
/// position (to 1e-7 degrees; in engineering coordinates to 1 cm, and without a date by the
/// position alone). What one receiver wrote, another never repeats.
class SharedRecordings {
  public:
    /// Takes in what a receiver of the attempt recorded; attempts are numbered by the caller.
    void add(std::uint32_t attempt, OpenTable<Observations> recording);

    /// Adds to the notes of each attempt those that it shares a recording with.
    void note(std::vector<AttemptResult>& attempts);

  private:
    struct Entry {
        std::uint64_t what;  ///< of an epoch or a file, hashed
        std::uint32_t attempt;
        auto operator<=>(const Entry&) const = default;
    };
    std::vector<Entry> epochs_, files_;
};

}  // namespace runcert
