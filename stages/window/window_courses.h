#pragma once

#include "inertial/inertial_smoother.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// Sets the course of each window and of the run, from the smoothed positions at first and last
/// epoch: in the plane, along the loxodrome and along the geodesic (`course_angles`). Without one
/// where the trajectory is not georeferenced, or the two are less than 1 m apart: the angle of a
/// shorter way is that of its errors.
void set_courses(const TrajectoryTable& trajectory, Windows& windows);

/// Sets the craft's mean heading beside the course of each window. Without one as for
/// `craft_speeds`.
void add_headings(const InertialSolution& solution, Windows& windows);

}  // namespace runcert
