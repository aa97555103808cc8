#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "schemas/observations/observations.h"

namespace runcert::sbp {

/// A step of the recorded UTC between two rows that is off the recording's rate by whole seconds.
struct UtcJump {
    std::size_t row = 0;       ///< index of the row after it
    std::int64_t seconds = 0;  ///< negative where UTC went back
};

/// The first jumps, and how many there are.
struct UtcJumps {
    static constexpr std::size_t listed_at_most = 3;
    std::vector<UtcJump> first;
    std::size_t count = 0;
};

/// Finds where a receiver that has UTC alone received the leap seconds: SiRF receivers count with
/// those of their firmware until they have received the almanac's. A step back is one unless the
/// row repeats the one before it; a step forward is one, and no gap, where the craft moved by what
/// its speed makes in one interval and not by what it makes in the time stamped. Needs times since
/// the first epoch and the nominal interval.
UtcJumps find_utc_jumps(const Observations& observations);

}  // namespace runcert::sbp
