#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/phase/declared.h"
#include "stages/import/recording.h"

namespace runcert {

using TakePhaseRow = std::function<void(const PhaseRow& row)>;

/// A receiver's phases whose rows are given one by one: by time, satellite and signal.
struct StreamedPhases {
    PhaseTable head;  ///< without the rows
    std::int64_t rows = 0;
    /// Gives them in order, as often as it is called. It owns what it needs.
    std::function<void(const TakePhaseRow& take)> give;
};

/// Whether the beginning of a file is of raw measurements that are read: RINEX observations, UBX.
bool has_phases(std::string_view bytes);

/// Reads a receiver's raw measurements (RINEX observations, or UBX with RXM-RAWX) with the
/// broadcast orbits of the navigation files, or where there are none of the UBX recording's own
/// RXM-SFRBX messages; and adds to each where its satellite was when it was sent, and how high it
/// stood. Satellites without an ephemeris keep their phases, without a position.
///
/// Failure where the file is none of these, where there are no ephemerides, or where they cover no
/// epoch (the message names a satellite and the age).
StreamedPhases import_phases(const Receiver& receiver, const RecordingBytes& phase,
                             const std::vector<RecordingBytes>& navigation);

}  // namespace runcert
