#pragma once

#include <cstdint>
#include <string>

#include "store/measured_series.h"

namespace runcert {

/// How a flow's direction is given: for wind where it comes from, for current where it flows to.
enum class FlowKind { wind, current };

/// The flow during a window, from a series.
struct FlowInWindow {
    double mean_m_s = 0.0;       ///< of the vector mean
    double gust_m_s = 0.0;       ///< largest speed of a sample, or of the interpolation at an end
    double direction_deg = 0.0;  ///< of the vector mean, in the series' convention; 0 to below 360
    double along_m_s = 0.0;      ///< component in the craft's direction; negative against it
    double across_m_s = 0.0;     ///< component to the craft's right
    std::int64_t samples = 0;    ///< in the window, ends included
    std::string missing;         ///< why there is no result; empty if there is one
};

/// The vector mean of a flow over the window's time, linear between samples, with its components
/// along and across a heading (degrees, clockwise from north). Times are from the recording's first
/// epoch. At every instant of the window (start_s to end_s) there must be a sample at most
/// `max_spacing_s` before it and one at most that long after. Otherwise `missing` gives the reason.
FlowInWindow flow_in_window(const MeasuredSeries& series, FlowKind kind, double start_s,
                            double end_s, double heading_deg, double max_spacing_s = 60.0);

}  // namespace runcert
