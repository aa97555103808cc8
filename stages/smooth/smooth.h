#pragma once

#include "estimation/motion_model.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// The figures of smoothing; `schemas/attempt/v1.yaml` describes them under `parameters.smooth`.
struct SmoothConfig {
    MotionModel model;
    double dhd22_acceleration_sigma_mps2 = 0.1;
};

SmoothConfig smooth_config(const Attempt& attempt);

/// Position, velocity and acceleration of every epoch of every arc, with standard uncertainties:
/// Kalman filter and RTS smoother, and beside them the same problem as batch least squares and the
/// three methods of [DHD22].
///
/// All covariances are multiplied by the a posteriori variance factor where that exceeds 1.
/// Failure where smoother and batch differ by more than 1e-6 m or 1e-5 m/s. The header is the
/// caller's.
TrajectoryTable smooth_trajectory(const ScreenedTable& table, const SmoothConfig& config);

}  // namespace runcert
