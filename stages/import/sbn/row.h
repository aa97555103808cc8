#pragma once

#include <optional>
#include <string_view>

#include "core/gps_time.h"
#include "stages/import/row_collector.h"

namespace runcert::sbn {

inline constexpr char geodetic_message = 41;

/// An epoch out of message 41.
struct GeodeticRow {
    /// Nothing where the receiver does not know the time yet: there is no epoch without one.
    std::optional<TimedRow> row;
    /// Leap seconds that the receiver's UTC counts with: GPS time less the UTC shown, to the
    /// nearest second. Nothing where the UTC shown is no time.
    std::optional<std::int64_t> leap_seconds;
};

/// Reads the payload of a message 41. Failure at its place.
GeodeticRow read_geodetic(std::string_view payload, const RecordingBytes& recording,
                          const RecordPlace& place);

}  // namespace runcert::sbn
