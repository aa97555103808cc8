#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "schemas/enu/frame_origin.h"
#include "schemas/trajectory/declared.h"
#include "stages/check/course.h"
#include "surface/triangulation.h"
#include "witness/runs.h"

namespace runcert {

/// The surface that a craft ran on, in the run's frame.
struct CourseGround {
    Triangulation surface;
    double vertical_sd_m = 0.0;  ///< of its vertices
};

/// What the surface says of the course under the craft.
struct GroundFacts {
    CourseFigure height_difference_m;  ///< highest minus lowest ground under the run
    CourseFigure slope;                ///< of the ground under the window's ends, upwards positive
};

/// The facts of the ground under a run and a window in it, straight below each estimate of the
/// antenna; heights above a tangent plane are corrected as for `course_facts`. Errors of two
/// heights are taken as independent, each of the vertices' stated size. Nothing where an estimate
/// of the run does not lie over the surface, or the window's ends lie at one place.
std::optional<GroundFacts> ground_facts(std::span<const TrajectoryEpoch> rows, const CraftRun& run,
                                        std::size_t window_first_row, std::size_t window_last_row,
                                        const CourseGround& ground,
                                        const std::optional<FrameOrigin>& origin);

}  // namespace runcert
