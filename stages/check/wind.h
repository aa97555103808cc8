#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/gps_time.h"

namespace runcert {

/// Which way a flow's direction is given: wind by where it comes from, current by where it sets to.
enum class FlowKind { wind, current };

/// A measurement of wind or of current.
struct FlowSample {
    double time_s = 0.0;  ///< from the recording's first epoch
    double speed_m_s = 0.0;
    double direction_deg = 0.0;  ///< from north over east
};

/// Times increase. `where` names the file.
struct FlowSeries {
    std::string where;
    std::vector<FlowSample> samples;
};

/// Reads a series from comma-separated text. Its header line names these columns, in any order:
/// a time, which is `time` (UTC, "2022-12-11T01:02:03.5Z"), `time_gps` (GPS time, without the Z) or
/// `time_s` (seconds from the recording's first epoch); a speed, `speed_m_s`, `speed_kn` or
/// `speed_km_h`; and `direction_deg`, 0 to 360. Lines that are empty or begin with # are passed
/// over.
///
/// Failure at "where:line:column" (bytes, from 1) for anything else: an unknown, missing or second
/// column, a cell that is not a number or time, a time not after the one before, a speed below 0
/// or above 150 m/s, no sample; and for instants where `first_epoch` is empty, the recording's
/// times being relative.
FlowSeries read_flow(std::string_view text, const std::string& where,
                     const std::optional<GpsTime>& first_epoch);

/// What a series says of a window.
struct FlowInWindow {
    double mean_m_s = 0.0;       ///< of the vector mean
    double gust_m_s = 0.0;       ///< largest speed of a sample, or interpolated at an end
    double direction_deg = 0.0;  ///< of the vector mean, as the series gives it; 0 up to 360
    double along_m_s = 0.0;      ///< component that moves with the craft, against it negative
    double across_m_s = 0.0;     ///< component that moves to the craft's right
    std::int64_t samples = 0;    ///< in the window, ends included
    std::string missing;         ///< why it says nothing; empty where it does
};

/// The mean over the window's time of the flow's vector, linear between samples, and what it is
/// along and across a heading (degrees, from north over east). It says nothing unless, at every
/// instant of the window (start_s up to end_s, from the recording's first epoch), there is a sample
/// at most `max_spacing_s` before, and one at most that after.
FlowInWindow flow_in_window(const FlowSeries& series, FlowKind kind, double start_s, double end_s,
                            double heading_deg, double max_spacing_s = 60.0);

}  // namespace runcert
