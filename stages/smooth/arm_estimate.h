#pragma once

#include <optional>
#include <string>
#include <vector>

#include "inertial/inertial_smoother.h"
#include "schemas/attitude/declared.h"
#include "witness/inertial_input.h"

namespace runcert {

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

}  // namespace runcert
