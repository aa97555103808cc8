#pragma once

#include "inertial/inertial_filter.h"

namespace runcert {

struct FittedImuNoise {
    ImuNoise noise = {};
    double log_likelihood = 0.0;
    bool at_limit = false;  ///< that of the motion or the velocity ended first
};

/// The likeliest noise of an IMU: the data's own, its random walks multiplied by 1 to 50 (velocity)
/// and 1 to 8 (angle), with noise of 0 to 0.032 of the motion. Coordinates are searched in turn
/// over ladders of factors 2 to 2.5, twice; likelihoods are those of filters linear about one
/// trajectory.
FittedImuNoise fit_imu_noise(InertialData data, const InertialPrior& prior,
                             std::span<const InertialNominal> about);

}  // namespace runcert
