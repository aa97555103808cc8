#pragma once

#include <cstdint>
#include <optional>

#include "stages/import/nmea/epoch.h"

namespace runcert::nmea {

/// What dates a recording's epochs.
struct FirstDay {
    std::int64_t day = 0;  ///< of its first epoch, days since 1980-01-06
    /// Whether dates of epochs without a fix count: no other epoch has one. A receiver that has no
    /// fix writes what its own clock has kept.
    bool without_fix = false;
};

/// The date of a recording's first epoch, by counting back from the first that is dated: not within
/// a minute of midnight, where dates come early or late, unless all are, of which most decide.
/// Nothing where none is dated. Reads no further than it must.
std::optional<FirstDay> find_first_day(const RecordingBytes& recording);

/// The day that an epoch says it is on, days since 1980-01-06; nothing where it says none that
/// counts.
std::optional<std::int64_t> day_of(const Epoch& epoch, const std::optional<FirstDay>& first);

}  // namespace runcert::nmea
