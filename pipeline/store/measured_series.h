#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "core/timed_value.h"

namespace runcert {

/// What a series gives at each time, of these the ones that it is declared with: "speed",
/// "direction", "distance", "uncertainty", "length". The first is its value.
using SeriesQuantities = std::vector<std::string>;

/// What is not given is 0.
struct SeriesSample {
    double time_s = 0.0;                    ///< from the recording's first epoch
    double value = 0.0;                     ///< m/s; of a distance m
    double direction_deg = 0.0;             ///< from north over east
    double expanded_uncertainty_m_s = 0.0;  ///< k = 2
    double length_m = 0.0;                  ///< of the stretch over which it was measured
};

/// Times increase. `where` names the file.
struct MeasuredSeries {
    std::string where;
    std::vector<SeriesSample> samples;
    std::string left_out =
        {};  ///< a sentence on the lines that were left out; empty where none were
};

/// Reads a series from comma-separated text. Its header line names these columns, in any order:
/// a time, which is `time` (UTC, "2022-12-11T01:02:03.5Z"), `time_gps` (GPS time, without the Z) or
/// `time_s` (seconds from the recording's first epoch); a speed, `speed_m_s`, `speed_kn` or
/// `speed_km_h`; a direction, `direction_deg`, 0 to 360; a distance from the first, `distance_m`;
/// an expanded uncertainty, `expanded_uncertainty_m_s`, `_kn` or `_km_h`; a length, `length_m`.
/// Lines that are empty or begin with # are passed over.
///
/// Lines that cannot be read, or whose times the most lines that follow one another in time leave
/// no place for, are left out where they are at most one in twenty, and where no line counts by
/// itself, as the passage of a gate does.
///
/// Failure at "where:line:column" (bytes, from 1) for more of them, the first one's, and for
/// anything else: an unknown, missing or second column, of a line a cell that is not a number or
/// time, a time not after the one before, a number out of its range, a distance not beyond the one
/// before, no sample; and for instants where `first_epoch` is empty, the recording's times being
/// relative.
MeasuredSeries read_series(std::string_view text, const std::string& where,
                           const std::optional<GpsTime>& first_epoch,
                           const SeriesQuantities& quantities);

/// Times and values of the samples.
std::vector<TimedValue> timed_values(const MeasuredSeries& series);

}  // namespace runcert
