#pragma once

#include "inertial/inertial_smoother.h"
#include "schemas/attitude/declared.h"
#include "surface/triangulation.h"

namespace runcert {

/// What the motion says of the axes as stated: by course and level, and where there is a surface
/// (in the run's frame, or null) by course and its normals (`estimate_mount`). Each is good to 0.2
/// degrees at best, whatever its scatter. On a surface the scatter counts once for each triangle
/// that the craft ran over: all epochs on one share the errors of its survey.
void judge_mount(const InertialSolution& solution, const Triangulation* surface,
                 EstimatedMount& mount);

}  // namespace runcert
