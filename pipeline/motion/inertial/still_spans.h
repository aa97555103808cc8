#pragma once

#include <functional>
#include <span>
#include <vector>

#include "inertial/strapdown.h"

namespace runcert {

/// A span of an IMU's times (s).
struct StillSpan {
    double from_s = 0.0;
    double to_s = 0.0;
};

/// The spans in which an IMU felt that the craft stood, in order of time.
///
/// There angular rate and specific force scatter within a second by less than half of their median
/// while the craft moves (by more than 1 m/s), and by less than four times that of the quietest
/// tenth of the recording. An IMU that feels the same at speed shows nothing. Three seconds at
/// both ends are left out, and what remains lasts 10 s or more. `speed_m_s` gives the craft's speed
/// at a time, NaN where it is unknown; at 0.2 m/s and more it does not stand. No IMU feels a craft
/// that creeps steadily on smooth ground.
std::vector<StillSpan> still_spans(std::span<const ImuSample> samples,
                                   const std::function<double(double)>& speed_m_s);

/// Medians of the scatter (m/s^2) of an IMU's specific force within a second: where the craft
/// stands (below 0.2 m/s), and below and above half of its greatest speed in motion. 0 where there
/// is none.
struct Shaking {
    double standing_m_s2 = 0.0;
    double slow_m_s2 = 0.0;
    double fast_m_s2 = 0.0;
};
Shaking shaking_of(std::span<const ImuSample> samples,
                   const std::function<double(double)>& speed_m_s);

}  // namespace runcert
