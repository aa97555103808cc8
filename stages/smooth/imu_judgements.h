#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inertial/inertial_smoother.h"
#include "schemas/attitude/declared.h"
#include "surface/triangulation.h"
#include "witness/inertial_input.h"

// What the motion shows of the distances and axes that the attempt states of an IMU.

namespace runcert {

/// What the motion says of the axes as stated: by course and level, and where there is a surface
/// (in the run's frame, or null) by course and its normals (`estimate_mount`). Each is good to 0.2
/// degrees at best, whatever its scatter. On a surface the scatter counts once for each triangle
/// that the craft ran over: all epochs on one share the errors of its survey.
void judge_mount(const InertialSolution& solution, const Triangulation* surface,
                 EstimatedMount& mount);

/// Estimates the arm from the IMU to the antenna beside its attitude, about the arm stated and with
/// half a metre of freedom in each component, by up to 3,000 positions around the fastest, and
/// states it in `arm` where the motion shows it: the solution is consistent, the craft rolls or
/// pitches, and each component is known to 0.15 m. Its standard uncertainty is twice the formal
/// one. (On recorded drives with a MEMS IMU the formal one was too small by two and more.)
///
/// Where a component differs from that stated by more than both uncertainties explain (3.29 of
/// their combined standard uncertainty) and by a metre at most, a second run rests on the arm
/// shown. Its solution is returned if it is consistent, with a sentence for the report in `notes`;
/// otherwise the arm stated stays, and nothing is returned.
///
/// Motion shows where the antenna is, not what was measured wrong: the antenna's place or the
/// IMU's, from which the reference point was measured, too. The whole difference is therefore part
/// of the uncertainty of the arm used (`arm_shown_sigma_m`). Beyond a metre somebody must measure.
std::optional<InertialSolution> solution_with_arm_shown(const InertialInput& input,
                                                        const InertialSolution& as_stated,
                                                        EstimatedArm& arm,
                                                        std::vector<std::string>& notes);

/// Compares the heading by two antennas with the inertial one (`judge_baseline`), and sets it in
/// the rows of the table. `receiver` is the id of the second. Does nothing where the setup has no
/// baseline.
void compare_headings(const InertialSolution& solution, const InertialSetup& setup,
                      const std::string& receiver, AttitudeTable& table);

}  // namespace runcert
