#pragma once

#include "schemas/observations/observations.h"

namespace runcert {

/// Takes out of a recording's velocities what its device did not measure, and notes it:
///
/// - velocities that are all zero while the positions move: the field was never filled;
/// - courses that are all north while the positions go elsewhere: the same of the course; the
///   speeds stay;
/// - a course that stands at its last value while the speed goes on changing below 1.5 m/s, as
///   devices write whose satellites no longer show it: that epoch's speed stays. Only of formats
///   that record a course.
void drop_unfilled_velocities(Observations& observations);

}  // namespace runcert
