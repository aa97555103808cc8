#pragma once

#include <optional>
#include <span>

#include "core/satellite.h"
#include "satellites/line_of_sight.h"

namespace runcert {

/// What a pseudorange says: where its satellite was, and how far it seems.
struct CodeMeasurement {
    SatelliteSystem system = SatelliteSystem::gps;
    Eigen::Vector3d satellite_m;  ///< at the transmission, in the Earth's frame then
    double pseudorange_m = 0.0;   ///< with the satellite's clock and group delay taken out
};

struct PointSolution {
    Eigen::Vector3d position_m;
    double clock_m = 0.0;  ///< of the receiver against the first measurement's system, times c
    std::size_t satellites = 0;
};

/// The receiver's position by pseudoranges alone: least squares, a clock for every system,
/// troposphere modelled, weights by elevation; good to some metres. Nothing where there are too few
/// satellites, or they do not determine it. A place near by saves steps.
std::optional<PointSolution> point_solution(
    std::span<const CodeMeasurement> measurements,
    const Eigen::Vector3d& start_m = Eigen::Vector3d::Zero());

}  // namespace runcert
