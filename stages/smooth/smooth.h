#pragma once

#include "motion/noise_fit.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// The parameters of smoothing, described in `schemas/attempt/v1.yaml` under `parameters.smooth`.
struct SmoothConfig {
    bool fit_noise = true;  ///< if false, the noise is as stated
    NoiseFitOptions fit;
    double robust_scale = 2.0;  ///< of the Cauchy loss, in standard deviations
    double dhd22_acceleration_sigma_m_s2 = 0.1;
};

/// The parameters that the attempt states, with the schema's defaults elsewhere.
SmoothConfig smooth_config(const Attempt& attempt);

/// Position, velocity and acceleration of every epoch of every arc, with standard uncertainties, by
/// Kalman filter and RTS smoother with noise estimated from the recording. The same problem is also
/// solved as batch least squares and with a robust loss. The three methods of [DHD22]
/// are added.
///
/// Horizontal and vertical are estimated separately, each with its own noise; the stated
/// correlations between them are not used. Failure if smoother and batch differ by more than
/// 1e-6 m or 1e-5 m/s. The caller sets the header.
TrajectoryTable smooth_trajectory(const ScreenedTable& table, const SmoothConfig& config);

}  // namespace runcert
