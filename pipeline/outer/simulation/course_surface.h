#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "simulation/simulate.h"

namespace runcert {

/// The ground along a course as triangles, in east, north and up of the run's place (m).
struct CourseSurface {
    std::vector<Eigen::Vector3d> vertices_m;
    std::vector<std::array<std::size_t, 3>> triangles;  ///< each counter-clockwise from above
};

/// The strip of ground along the course of the spec's craft, and a little beyond both ends, of an
/// oval no more than one lap; heights with the errors of a survey, which are drawn one for each
/// vertex. A lake is level, an oval leans as its bank. Needs craft and surface. Failure as
/// `simulate`.
CourseSurface simulate_surface(const SimulationSpec& spec);

/// A surface as LandXML 1.2: a TIN in metres, points as north, east, up.
std::string landxml_text(const CourseSurface& surface, GpsTime date);

}  // namespace runcert
