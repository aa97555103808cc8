#pragma once

#include <cstdint>
#include <vector>

#include "schemas/enu/declared.h"

namespace runcert {

/// The standing of an epoch's time relative to the others.
enum class TimeStanding {
    in_order,      ///< part of the sequence that is retained
    repeated,      ///< repeats time and position of another epoch
    same_time,     ///< the time of a retained epoch, to a twentieth of the interval
    out_of_order,  ///< another time, for which the retained epochs leave no place
};

/// The epochs of a recording in the order of time.
struct TimeOrder {
    std::vector<TimeStanding> standing;  ///< of each row, in the order given
    /// The rows in output order. Kept rows are in order of time. Each other row comes after the
    /// retained one that it repeats, or otherwise follows in the recording.
    std::vector<std::size_t> rows;
    /// For each row as given: it is retained, but the retained row before it in time does not
    /// directly precede it in the recording, and the motion does not continue from there.
    std::vector<bool> seam;
    std::int64_t moved = 0;  ///< number of retained rows that come after a row of later time in the
                             ///< recording
};

/// Parameters of the ordering by time.
struct TimeOrderOptions {
    double interval_s = 0.0;      ///< nominal interval between epochs
    double gap_factor = 1.5;      ///< a step of more intervals is a gap
    double session_gap_s = 60.0;  ///< longer gaps separate sessions
    std::int64_t fewest = 6;      ///< least number of epochs of a separate session
};

/// Judges the times of all rows of a recording together, in the order in which they were recorded.
///
/// The recording is divided into blocks wherever a step of the stamps is not forward or is a gap.
/// The sequence of blocks with increasing times that holds most epochs is retained. So is each
/// further block that fits into free time: a session written after a later one, or a stretch out of
/// place. Of a block that overlaps, the longest part that does not is retained, if it is two thirds
/// of the block.
///
/// A block is left out, although its times fit, where it was evidently recorded in place with
/// incorrect stamps. The neighbouring epochs in the recording then leave just the room for it
/// between their stamps, and the positions continue from them to it and from it to them. A block of
/// fewer than `fewest` epochs at an end of the recording is also left out if it is further than
/// `session_gap_s` from all others in time and continues from its neighbour.
///
/// Of epochs less than a twentieth of the interval apart only the first stays. No receiver measures
/// at such steps, and they would make every estimate stiff. Takes n log n time. Rows are returned
/// unchanged where all steps go forward and no session is that short.
TimeOrder order_by_time(const std::vector<EnuEpoch>& rows, const TimeOrderOptions& options);

}  // namespace runcert
