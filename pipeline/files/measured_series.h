#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"
#include "core/timed_value.h"

namespace runcert {

/// What an attempt hands in as a series of measurements.
enum class SeriesKind {
    flow,   ///< wind or current: a speed and a direction
    wheel,  ///< the speed of a wheel
    gates,  ///< passages of timing gates: the distance of each from the first, along the course
};

/// Whether the word is that of a kind; `kind` is then it.
bool from_text(std::string_view word, SeriesKind& kind);

struct SeriesSample {
    double time_s = 0.0;         ///< from the recording's first epoch
    double value = 0.0;          ///< m/s; of gates m
    double direction_deg = 0.0;  ///< of a flow, from north over east; else 0
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
/// `time_s` (seconds from the recording's first epoch); of a flow or a wheel a speed, `speed_m_s`,
/// `speed_kn` or `speed_km_h`; of gates `distance_m`; and of a flow `direction_deg`, 0 to 360.
/// Lines that are empty or begin with # are passed over.
///
/// Of a flow or a wheel, lines that cannot be read, or whose times the most lines that follow one
/// another in time leave no place for, are left out where they are at most one in twenty.
///
/// Failure at "where:line:column" (bytes, from 1) for more of them, the first one's, and for
/// anything else: an unknown, missing or second column, of a line a cell that is not a number or
/// time, a time not after the one before, a speed below 0 or above 150 m/s, a distance not beyond
/// the one before, no sample; and for instants where `first_epoch` is empty, the recording's times
/// being relative.
MeasuredSeries read_series(std::string_view text, const std::string& where,
                           const std::optional<GpsTime>& first_epoch, SeriesKind kind);

/// Times and values of the samples.
std::vector<TimedValue> timed_values(const MeasuredSeries& series);

}  // namespace runcert
