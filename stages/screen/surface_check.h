#pragma once

#include <string>

#include "schemas/screened/screened.h"
#include "stages/screen/test_plan.h"
#include "surface/triangulation.h"

namespace runcert {

/// The surface that a receiver's craft runs on, and what the attempt says of it.
struct GroundBelow {
    Triangulation surface;  ///< in the run's frame
    double vertical_sd_m = 0.0;
    double antenna_height_m = 0.0;
    double tilt_max_deg = 0.0;
    double undulation_m = 0.0;  ///< what was added to the surface's heights
    std::string place = {};     ///< of the attempt, for messages
};

/// Marks usable epochs whose antenna is not where the surface has it: the normal constraint of
/// [FHB03] as a test, which never moves a position. The reason is `surface`.
///
/// The figure is d = n . (r - P) - h, the distance of the antenna r from the plane of the triangle
/// below it, along the upward normal n, less its height above the ground. Its standard uncertainty
/// is sqrt(vertex^2 + n' C n) + h (1 - cos tilt): the vertices' stated one, the position's stated
/// covariance C times the table's variance factor, and what the antenna comes down by at the
/// largest tilt. The antenna of a leaning mast also moves sideways, by h sin(tilt), over ground of
/// the same slope: along the normal that changes nothing. Epochs whose |d| over it exceeds the
/// normal quantile of the plan's size are marked; the statistic is that ratio.
///
/// First the median of d over all usable epochs above the surface is looked at. Where it is more
/// than 3.29 times the uncertainty (0.001, two-sided), all heights differ alike, by a datum or the
/// antenna's height: that says nothing of a single position, and epochs are tested for what is left
/// without it.
///
/// Nothing where there are no heights. Failure, at the attempt's place: no usable position lies
/// over the surface; or the median is three metres or more, which is a height above the geoid taken
/// for one above the ellipsoid, or another surface; or more than half of the heights differ by more
/// than 3.29 times their uncertainty.
std::optional<SurfaceComparison> check_surface(ScreenedTable& screened, const GroundBelow& ground,
                                               const TestPlan& plan);

}  // namespace runcert
