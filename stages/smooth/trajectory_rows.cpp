#include "stages/smooth/trajectory_rows.h"

#include <cmath>

#include "estimation/speed.h"
#include "stages/smooth/dhd22.h"

namespace runcert {
namespace {

/// Positions that may be differenced: no bridged step lies between them.
struct PositionRun {
    std::vector<PlanePosition> positions;
    std::vector<std::size_t> rows;  ///< of the table
    bool after_step = false;
};

/// The usable positions of an arc.
std::vector<PositionRun> position_runs(const Arc<2>& arc) {
    std::vector<PositionRun> runs(1);
    for (std::size_t k = 0; k < arc.epochs.size(); ++k) {
        if (k > 0 && arc.epochs[k].step_before) runs.push_back({{}, {}, true});
        const auto& measurement = arc.epochs[k].measurement;
        if (!measurement) continue;
        runs.back().positions.push_back(
            {.time_s = arc.epochs[k].time_s,
             .position = measurement->position,
             .sigma_m = std::sqrt(measurement->covariance.trace() / 2.0)});
        runs.back().rows.push_back(arc.rows[k]);
    }
    return runs;
}

}  // namespace

void set_horizontal(const StateEstimate<2>& state, TrajectoryEpoch& row) {
    const StateVector<2>& mean = state.mean;
    const StateVector<2> sigma = state.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    row.east_m = mean(0);
    row.north_m = mean(1);
    row.velocity_east_mps = mean(2);
    row.velocity_north_mps = mean(3);
    row.acceleration_east_mps2 = mean(4);
    row.acceleration_north_mps2 = mean(5);
    row.sigma_east_m = sigma(0);
    row.sigma_north_m = sigma(1);
    row.sigma_velocity_east_mps = sigma(2);
    row.sigma_velocity_north_mps = sigma(3);
    row.sigma_acceleration_east_mps2 = sigma(4);
    row.sigma_acceleration_north_mps2 = sigma(5);
    const SpeedEstimate speed =
        horizontal_speed(mean.segment<2>(2), state.covariance.block<2, 2>(2, 2));
    row.speed_mps = speed.speed_mps;
    row.sigma_speed_mps = speed.standard_uncertainty_mps;
}

void set_vertical(const StateEstimate<1>& state, TrajectoryEpoch& row) {
    const StateVector<1> sigma = state.covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    row.up_m = state.mean(0);
    row.velocity_up_mps = state.mean(1);
    row.acceleration_up_mps2 = state.mean(2);
    row.sigma_up_m = sigma(0);
    row.sigma_velocity_up_mps = sigma(1);
    row.sigma_acceleration_up_mps2 = sigma(2);
}

void set_paper_methods(const Arc<2>& arc, double acceleration_sigma_mps2,
                       std::vector<TrajectoryEpoch>& rows) {
    for (const PositionRun& run : position_runs(arc)) {
        const auto v1 = speed_v1(run.positions);
        const auto v2 = speed_v2(run.positions);
        const auto filtered = filter_dhd22(run.positions, acceleration_sigma_mps2);
        for (std::size_t k = 0; k < run.rows.size(); ++k) {
            TrajectoryEpoch& row = rows[run.rows[k]];
            row.speed_v1_mps = v1[k];
            row.speed_v2_mps = v2[k];
            if (k > 0 || !run.after_step) row.speed_kalman_mps = filtered[k].speed_mps();
        }
    }
}

}  // namespace runcert
