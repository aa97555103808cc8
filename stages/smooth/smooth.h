#pragma once

#include "estimation/noise_fit.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// The figures of smoothing; `schemas/attempt/v1.yaml` describes them under `parameters.smooth`.
struct SmoothConfig {
    bool fit_noise = true;  ///< else noise as stated
    NoiseFitOptions fit;
    double robust_scale = 2.0;  ///< of the Cauchy loss, in standard deviations
    double dhd22_acceleration_sigma_m_s2 = 0.1;
};

SmoothConfig smooth_config(const Attempt& attempt);

/// Position, velocity and acceleration of every epoch of every arc, with standard uncertainties:
/// noise estimated from the recording, Kalman filter and RTS smoother, and beside them the same
/// problem as batch least squares, the batch with a robust loss, and the three methods of [DHD22].
///
/// Horizontal and vertical are estimated apart, each with its own noise; the stated correlations
/// between them are not used. Failure where smoother and batch differ by more than 1e-6 m or
/// 1e-5 m/s. The header is the caller's.
TrajectoryTable smooth_trajectory(const ScreenedTable& table, const SmoothConfig& config);

}  // namespace runcert
