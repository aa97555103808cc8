#pragma once

#include "schemas/attitude/declared.h"
#include "schemas/imu/declared.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "witness/inertial_input.h"

namespace runcert {

/// Attitude of the craft and motion of its reference point at every epoch that the IMU covers, by
/// `smooth_inertial`, and whether IMU and positions agree. Where they do not, too few positions lie
/// within the samples, or they have no place on the Earth, the table says why (`consistency`): that
/// is a finding, and the solution is used for nothing. Beside a second antenna its heading is
/// compared with that by the antennas. Over a surface (in the run's frame) its attitude may be the
/// start, and the axes of the IMU are judged by its normals, too. The caller sets the header.
AttitudeTable attitude_table(const ImuTable& imu, const ScreenedTable& screened,
                             const TrajectoryTable& trajectory,
                             const std::optional<SecondAntenna>& second = std::nullopt,
                             const Triangulation* surface = nullptr);

}  // namespace runcert
