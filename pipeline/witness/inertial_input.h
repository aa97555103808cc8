#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "inertial/inertial_smoother.h"
#include "schemas/attempt/attempt.h"
#include "schemas/attitude/declared.h"
#include "schemas/imu/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "surface/triangulation.h"

namespace runcert {

/// What the inertial smoother takes of a run.
struct InertialInput {
    std::vector<ImuSample> samples;
    std::vector<PositionFix> fixes;  ///< usable epochs with all three coordinates
    InertialSetup setup;
};

/// The noise of an IMU of that grade: of a phone's, where the attempt does not say.
ImuNoise imu_noise(const std::optional<ImuGrade>& grade);

/// Another receiver whose antenna has a place on the same craft.
struct SecondAntenna {
    const ScreenedTable& screened;
    LeverArm arm;  ///< from its antenna to the craft's reference point
};

/// What the attempt says of the second receiver: its place on the craft. Null where the first has
/// no IMU, there is no second, or it has no place.
const Receiver* second_on_craft(const Attempt& attempt);

/// Samples from the IMU's table; usable positions with their stated covariances, enlarged as the
/// noise fit of the trajectory found; its correlated error, if it found one. The positions must
/// have an origin on the Earth, by which gravity and the Earth's rotation are known. With a second
/// antenna also the way from the first to it, of epochs that both have with heights. With a surface
/// (in the run's frame) its normals under the antenna.
InertialInput inertial_input(const ImuTable& imu, const ScreenedTable& screened,
                             const TrajectoryTable& trajectory,
                             const std::optional<SecondAntenna>& second,
                             const Triangulation* surface = nullptr);

/// Standard uncertainty of each component of an arm taken from the motion: what it differs from the
/// one stated, and no less than it is known to.
double arm_shown_sigma_m(const EstimatedArm& arm);

/// Sets the solution of 4-attitude, about which one pass is enough: its noise, time offset, states,
/// and start where that came from a surface.
void take_solution(const AttitudeTable& attitude, InertialSetup& setup);

/// An IMU's noise as 4-attitude states it.
LikeliestNoise likeliest_noise(const ImuNoise& noise);

}  // namespace runcert
