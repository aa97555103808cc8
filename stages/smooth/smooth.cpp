#include "stages/smooth/smooth.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "arcs/arcs.h"
#include "core/failure.h"
#include "estimation/speed.h"
#include "stages/smooth/batch.h"
#include "stages/smooth/dhd22.h"

namespace runcert {
namespace {

constexpr double agreement_position_m = 1e-6;
constexpr double agreement_velocity_mps = 1e-5;

/// The axes of a vector as cells: the third stays empty in the plane.
template <int Axes, class Vector>
void set_axes(const Vector& values, std::optional<double>& east, std::optional<double>& north,
              std::optional<double>& up) {
    east = values(0);
    north = values(1);
    if constexpr (Axes == 3) up = values(2);
}

template <int Axes>
void set_state(const StateEstimate<Axes>& state, double variance_factor, TrajectoryEpoch& row) {
    const StateVector<Axes>& mean = state.mean;
    const StateVector<Axes> sigma =
        (variance_factor * state.covariance.diagonal()).cwiseMax(0.0).cwiseSqrt();
    set_axes<Axes>(mean.template head<Axes>(), row.east_m, row.north_m, row.up_m);
    set_axes<Axes>(mean.template segment<Axes>(Axes), row.velocity_east_mps, row.velocity_north_mps,
                   row.velocity_up_mps);
    set_axes<Axes>(mean.template tail<Axes>(), row.acceleration_east_mps2,
                   row.acceleration_north_mps2, row.acceleration_up_mps2);
    set_axes<Axes>(sigma.template head<Axes>(), row.sigma_east_m, row.sigma_north_m,
                   row.sigma_up_m);
    set_axes<Axes>(sigma.template segment<Axes>(Axes), row.sigma_velocity_east_mps,
                   row.sigma_velocity_north_mps, row.sigma_velocity_up_mps);
    set_axes<Axes>(sigma.template tail<Axes>(), row.sigma_acceleration_east_mps2,
                   row.sigma_acceleration_north_mps2, row.sigma_acceleration_up_mps2);
    const SpeedEstimate speed =
        horizontal_speed(mean.template segment<2>(Axes),
                         variance_factor * state.covariance.template block<2, 2>(Axes, Axes));
    row.speed_mps = speed.speed_mps;
    row.sigma_speed_mps = speed.standard_uncertainty_mps;
}

/// The methods of [DHD22] over the usable positions of an arc.
template <int Axes>
void set_paper_methods(const Arc<Axes>& arc, const SmoothConfig& config,
                       std::vector<TrajectoryEpoch>& rows) {
    std::vector<PlanePosition> positions;
    std::vector<std::size_t> index;
    for (std::size_t k = 0; k < arc.epochs.size(); ++k) {
        const auto& measurement = arc.epochs[k].measurement;
        if (!measurement) continue;
        const double horizontal_variance =
            measurement->covariance.template topLeftCorner<2, 2>().trace() / 2.0;
        positions.push_back({.time_s = arc.epochs[k].time_s,
                             .position = measurement->position.template head<2>(),
                             .sigma_m = std::sqrt(horizontal_variance)});
        index.push_back(arc.rows[k]);
    }
    const auto v1 = speed_v1(positions);
    const auto v2 = speed_v2(positions);
    const auto filtered = filter_dhd22(positions, config.dhd22_acceleration_sigma_mps2);
    for (std::size_t k = 0; k < positions.size(); ++k) {
        rows[index[k]].speed_v1_mps = v1[k];
        rows[index[k]].speed_v2_mps = v2[k];
        rows[index[k]].speed_kalman_mps = filtered[k].speed_mps();
    }
}

/// Compares the batch solution with the smoothed one and fills its column.
template <int Axes>
void set_batch(const Arc<Axes>& arc, const SmoothedArc<Axes>& smoothed, const MotionModel& model,
               TrajectoryTable& table) {
    const auto batch = solve_batch<Axes>(arc.epochs, model);
    for (std::size_t k = 0; k < batch.size(); ++k) {
        const StateVector<Axes> difference = batch[k] - smoothed.states[k].mean;
        const double position_m = difference.template head<Axes>().norm();
        const double velocity_mps = difference.template segment<Axes>(Axes).norm();
        EstimationSummary& summary = table.estimation;
        summary.largest_position_difference_m =
            std::max(summary.largest_position_difference_m, position_m);
        summary.largest_velocity_difference_mps =
            std::max(summary.largest_velocity_difference_mps, velocity_mps);
        if (!(position_m <= agreement_position_m && velocity_mps <= agreement_velocity_mps))
            throw Failure(
                fmt::format("epoch {}, {:.3f} s", table.rows[arc.rows[k]].epoch,
                            arc.epochs[k].time_s),
                fmt::format("smoother and batch least squares differ by {:.2e} m and {:.2e} m/s, "
                            "more than {:.0e} m and {:.0e} m/s",
                            position_m, velocity_mps, agreement_position_m, agreement_velocity_mps),
                "The estimate cannot be trusted here; check stated accuracies and time steps, and "
                "report it with the run folder");
        table.rows[arc.rows[k]].speed_batch_mps = batch[k].template segment<2>(Axes).norm();
    }
}

template <int Axes>
void estimate(const ScreenedTable& screened, const SmoothConfig& config, TrajectoryTable& table) {
    const auto arcs = arcs_of<Axes>(screened);
    std::vector<SmoothedArc<Axes>> smoothed;
    double innovation_sum = 0.0;
    for (const Arc<Axes>& arc : arcs) {
        smoothed.push_back(smooth<Axes>(arc.epochs, config.model));
        innovation_sum += smoothed.back().innovation_sum;
        // The vague prior leaves position, velocity and acceleration of each axis to the data.
        table.estimation.degrees_of_freedom += Axes * smoothed.back().measurements - 3 * Axes;
        set_batch(arc, smoothed.back(), config.model, table);
        set_paper_methods(arc, config, table.rows);
    }
    EstimationSummary& summary = table.estimation;
    summary.arcs = static_cast<std::int64_t>(arcs.size());
    if (summary.degrees_of_freedom > 0)
        summary.variance_factor = innovation_sum / static_cast<double>(summary.degrees_of_freedom);
    summary.variance_factor_applied = std::max(1.0, summary.variance_factor);
    for (std::size_t a = 0; a < arcs.size(); ++a)
        for (std::size_t k = 0; k < arcs[a].rows.size(); ++k)
            set_state(smoothed[a].states[k], summary.variance_factor_applied,
                      table.rows[arcs[a].rows[k]]);
}

}  // namespace

SmoothConfig smooth_config(const Attempt& attempt) {
    const nlohmann::ordered_json& parameters = attempt.parameters.at("smooth");
    return {.model = {.jerk_density = parameters.at("jerk_density")},
            .dhd22_acceleration_sigma_mps2 = parameters.at("dhd22_acceleration_sigma")};
}

TrajectoryTable smooth_trajectory(const ScreenedTable& screened, const SmoothConfig& config) {
    TrajectoryTable table;
    table.facts = screened.facts;
    table.origin = screened.origin;
    table.rows.reserve(screened.rows.size());
    for (const ScreenedEpoch& row : screened.rows) {
        TrajectoryEpoch& epoch = table.rows.emplace_back();
        epoch.epoch = row.epoch;
        epoch.time = row.time;
        epoch.arc = row.arc;
        epoch.usable = row.usable;
    }
    if (screened.facts.vertical_measured)
        estimate<3>(screened, config, table);
    else
        estimate<2>(screened, config, table);
    return table;
}

}  // namespace runcert
