#pragma once

#include <optional>
#include <span>

#include "core/satellite.h"
#include "satellites/line_of_sight.h"

namespace runcert {

/// A pseudorange and the position of its satellite.
struct CodeMeasurement {
    SatelliteSystem system = SatelliteSystem::gps;
    Eigen::Vector3d satellite_m;  ///< at transmission, in the Earth-fixed frame of that instant
    double pseudorange_m = 0.0;   ///< corrected for satellite clock and group delay
};

/// A receiver's position and clock from pseudoranges.
struct PointSolution {
    Eigen::Vector3d position_m;
    double clock_m = 0.0;  ///< receiver clock offset from the first measurement's system, times c
    std::size_t satellites = 0;
};

/// The receiver's position from pseudoranges alone, good to some metres: least squares weighted by
/// elevation, with one clock for each system and a troposphere model. Empty if there are too few
/// satellites, or they do not determine it. A nearby start saves iterations.
std::optional<PointSolution> point_solution(
    std::span<const CodeMeasurement> measurements,
    const Eigen::Vector3d& start_m = Eigen::Vector3d::Zero());

}  // namespace runcert
