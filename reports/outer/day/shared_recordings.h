#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "schemas/day_results/day_results.h"
#include "schemas/observations/observations.h"

namespace runcert {

/// Which attempts of a day rest on one recording, or on recordings that overlap: with files of the
/// same bytes; with ten epochs and more that have the same time (to the millisecond) and position
/// (to 1e-7 degrees, in engineering coordinates to 1 cm); or with ten stretches of 20 s of the same
/// motion, second by second to 5 cm, wherever and whenever, recorded in steps of 5 cm at most. What
/// one receiver wrote, another never repeats.
class SharedRecordings {
  public:
    /// Takes in what a receiver of the attempt recorded; attempts are numbered by the caller. Files
    /// that another attempt has are not read again.
    void add(std::uint32_t attempt, OpenTable<Observations> table);

    /// Adds to the notes of each attempt those that it shares a recording with.
    void note(std::vector<AttemptResult>& attempts);

  private:
    struct Recording {
        std::string files;  ///< their hashes
        std::vector<std::uint32_t> attempts;
    };
    struct Entry {
        std::uint64_t what;  ///< an epoch or a position, hashed
        std::uint32_t recording;
        auto operator<=>(const Entry&) const = default;
    };
    using Shared = std::map<std::uint32_t, std::map<std::uint32_t, std::int64_t>>;

    Shared shared_by(std::vector<Entry>& entries) const;

    std::vector<Recording> recordings_;
    std::vector<Entry> epochs_, motions_;
};

}  // namespace runcert
