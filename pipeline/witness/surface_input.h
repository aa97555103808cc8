#pragma once

#include <Eigen/Core>
#include <optional>

#include "schemas/enu/frame_origin.h"
#include "schemas/surface/declared.h"
#include "surface/triangulation.h"

namespace runcert {

/// The surface of a table in the frame of a run: east, north and up of its origin, or of its
/// engineering CRS.
///
/// Failure (at "1-surface") where the table lies on the Earth and the run does not, and where a
/// triangle names a vertex that there is not.
Triangulation surface_of(const SurfaceTable& table, const std::optional<FrameOrigin>& origin);

/// A position of a run in the frame of its origin, where parts of the recording have frames of
/// their own.
Eigen::Vector3d in_frame_of_origin(const std::optional<FrameOrigin>& origin, ElapsedTime time,
                                   const Eigen::Vector3d& enu_m);

}  // namespace runcert
