#pragma once

#include <cstdint>
#include <string>

#include "files/measured_series.h"

namespace runcert {

/// Which way a flow's direction is given: wind by where it comes from, current by where it sets to.
enum class FlowKind { wind, current };

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
FlowInWindow flow_in_window(const MeasuredSeries& series, FlowKind kind, double start_s,
                            double end_s, double heading_deg, double max_spacing_s = 60.0);

}  // namespace runcert
