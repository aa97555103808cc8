#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "schemas/enu/enu.h"

namespace runcert {

/// One epoch of the smoothed trajectory. Outside arcs only epoch and time are given; vertical
/// figures only where heights were measured. Sigmas are standard uncertainties.
struct TrajectoryEpoch {
    std::int64_t epoch = 0;
    ElapsedTime time;
    std::optional<double> east_m, north_m, up_m;
    std::optional<double> velocity_east_mps, velocity_north_mps, velocity_up_mps;
    std::optional<double> acceleration_east_mps2, acceleration_north_mps2, acceleration_up_mps2;
    std::optional<double> speed_mps;
    std::optional<double> sigma_east_m, sigma_north_m, sigma_up_m;
    std::optional<double> sigma_velocity_east_mps, sigma_velocity_north_mps, sigma_velocity_up_mps;
    std::optional<double> sigma_acceleration_east_mps2, sigma_acceleration_north_mps2,
        sigma_acceleration_up_mps2;
    std::optional<double> sigma_speed_mps;
    std::optional<double> speed_batch_mps;
    std::optional<double> speed_v1_mps;
    std::optional<double> speed_v2_mps;
    std::optional<double> speed_kalman_mps;
    std::optional<std::int64_t> arc;
    bool usable = false;
};

/// How the estimate of a whole recording went.
struct EstimationSummary {
    std::int64_t arcs = 0;
    std::int64_t degrees_of_freedom = 0;
    double variance_factor = 1.0;          ///< a posteriori, of unit weight
    double variance_factor_applied = 1.0;  ///< by which all covariances were multiplied
    double largest_position_difference_m = 0.0;
    double largest_velocity_difference_mps = 0.0;
};

/// 4-trajectory.ecsv, `schemas/trajectory/v1.yaml`.
struct TrajectoryTable {
    Header header;
    RecordingFacts facts;
    std::optional<FrameOrigin> origin;
    EstimationSummary estimation;
    std::vector<TrajectoryEpoch> rows;
};

std::string write_trajectory(const TrajectoryTable& table);
TrajectoryTable read_trajectory(std::string_view text, const std::string& where);

}  // namespace runcert
