#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "schemas/observations/observations.h"

namespace runcert {

/// A recording as it is, in the order of time, one value for each epoch; nothing where an epoch has
/// none. Times are from the first epoch.
struct RawTrack {
    std::vector<double> time_s;
    std::vector<std::optional<double>> east_m, north_m;  ///< from the first position
    std::vector<std::optional<double>> height_m;
    std::vector<std::optional<double>> recorded_speed_m_s;  ///< horizontal
    std::vector<std::optional<double>> position_speed_m_s;  ///< horizontal, from the epoch before
    std::vector<std::optional<double>> sigma_horizontal_m;  ///< as stated
    std::vector<std::pair<double, double>> gaps;  ///< from and to, as `inspect` counts them
};

/// Positions in the plane at the first one.
RawTrack raw_track(const Observations& observations);

}  // namespace runcert
