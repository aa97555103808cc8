#pragma once

#include <cstdint>
#include <vector>

#include "schemas/enu/enu.h"

namespace runcert {

/// What an epoch's time says beside the others'.
enum class TimeStanding {
    in_order,      ///< it belongs to the sequence that is kept
    repeated,      ///< time and position of another epoch once more
    same_time,     ///< the time of an epoch kept beside it, to a twentieth of the interval
    out_of_order,  ///< another time that the epochs kept leave no place for
};

/// The epochs of a recording in the order of time.
struct TimeOrder {
    std::vector<TimeStanding> standing;  ///< of each row, as they were given
    /// The rows as they are to stand: those kept in the order of their times, each of the others
    /// after the one kept that it repeats, or else that it follows in the recording.
    std::vector<std::size_t> rows;
    /// By row as given: it is kept, and what is kept before it in time does not stand directly
    /// before it in the recording, nor does the motion go on from there.
    std::vector<bool> seam;
    std::int64_t moved = 0;  ///< rows kept that a row of a later time precedes in the recording
};

struct TimeOrderOptions {
    double interval_s = 0.0;      ///< nominal, between epochs
    double gap_factor = 1.5;      ///< a step of more intervals is a gap
    double session_gap_s = 60.0;  ///< further apart: another session
    std::int64_t fewest = 6;      ///< epochs that a session by itself has at least
};

/// Judges the times of a recording's rows, in the order in which they were recorded, all together.
///
/// The recording is cut into blocks wherever a step of the stamps is not forward or is a gap. Kept
/// is the sequence of blocks of increasing times that holds most epochs, and each further block
/// that fits where nothing of it lies: a session that was written after a later one, a stretch out
/// of place. Of a block that overlaps, the longest part that does not, if that is two thirds of it.
///
/// A block is left out, though its times fit, where the epochs around it in the recording have just
/// the room for it between their stamps and the positions go on from them to it and from it to
/// them: it was recorded there, and its stamps are wrong. So is one of fewer than `fewest` epochs
/// at an end of the recording, further than `session_gap_s` from all others in time, that goes on
/// from its neighbour. Of epochs less than a twentieth of the interval apart the first alone stays:
/// no receiver measures at such steps, and they would make every estimate stiff. Takes n log n
/// time; rows are returned as they are where all steps go forward and no session is that short.
TimeOrder order_by_time(const std::vector<EnuEpoch>& rows, const TimeOrderOptions& options);

}  // namespace runcert
