#include "stages/smooth/trajectory_rows.h"

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"
#include "motion/chain.h"
#include "motion/sections.h"
#include "motion/speed.h"
#include "stages/smooth/dhd22.h"

namespace runcert {
namespace {

/// Standard deviations from a covariance's diagonal.
template <int Axes>
PositionVector<Axes> sigmas(const PositionMatrix<Axes>& covariance) {
    return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

void set_motion(const Chain<2>& chain, std::size_t k, TrajectoryEpoch& row) {
    const StateVector<2> mean = chain.mean(k);
    const Eigen::Matrix2d of_velocity = chain.covariance_of(1, k);
    const Eigen::Vector2d position = sigmas<2>(chain.covariance_of(0, k));
    const Eigen::Vector2d velocity = sigmas<2>(of_velocity);
    const Eigen::Vector2d acceleration = sigmas<2>(chain.covariance_of(2, k));
    row.east_m = mean(0);
    row.north_m = mean(1);
    row.velocity_east_m_s = mean(2);
    row.velocity_north_m_s = mean(3);
    row.acceleration_east_m_s2 = mean(4);
    row.acceleration_north_m_s2 = mean(5);
    row.sigma_east_m = position(0);
    row.sigma_north_m = position(1);
    row.sigma_velocity_east_m_s = velocity(0);
    row.sigma_velocity_north_m_s = velocity(1);
    row.sigma_acceleration_east_m_s2 = acceleration(0);
    row.sigma_acceleration_north_m_s2 = acceleration(1);
    const SpeedEstimate speed = horizontal_speed(mean.segment<2>(2), of_velocity);
    row.speed_m_s = speed.speed_m_s;
    row.sigma_speed_m_s = speed.standard_uncertainty_m_s;
}

void set_motion(const Chain<1>& chain, std::size_t k, TrajectoryEpoch& row) {
    const StateVector<1> mean = chain.mean(k);
    row.up_m = mean(0);
    row.velocity_up_m_s = mean(1);
    row.acceleration_up_m_s2 = mean(2);
    row.sigma_up_m = sigmas<1>(chain.covariance_of(0, k))(0);
    row.sigma_velocity_up_m_s = sigmas<1>(chain.covariance_of(1, k))(0);
    row.sigma_acceleration_up_m_s2 = sigmas<1>(chain.covariance_of(2, k))(0);
}

template <int Axes>
double scaled_condition(const StateMatrix<Axes>& covariance) {
    const StateVector<Axes> inverse = covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd eigenvalues =
        symmetric_eigenvalues(inverse.asDiagonal() * covariance * inverse.asDiagonal());
    const double smallest = eigenvalues(0);
    return smallest > 0.0 ? eigenvalues(eigenvalues.size() - 1) / smallest : 1e18;
}

constexpr std::size_t condition_every = 16;
constexpr std::size_t epochs_at_once = 16'384;

}  // namespace

template <int Axes>
std::vector<ArcSection> smoothed_sections(std::span<const ArcEpoch<Axes>> epochs,
                                          const EstimationModel& model) {
    const double memory = epochs.size() > epochs_at_once ? memory_s<Axes>(epochs, model) : 0.0;
    return sections_of<Axes>(epochs, memory, epochs_at_once);
}

template <int Axes>
SmoothedMeans<Axes> smooth_rows(const Arc<Axes>& arc, const EstimationModel& model,
                                std::vector<TrajectoryEpoch>& rows) {
    const std::span<const ArcEpoch<Axes>> epochs(arc.epochs);
    SmoothedMeans<Axes> smoothed;
    smoothed.states.resize(epochs.size());
    smoothed.measurements = std::ranges::count_if(
        epochs, [](const ArcEpoch<Axes>& epoch) { return epoch.measurement.has_value(); });
    for (const ArcSection& section : smoothed_sections<Axes>(epochs, model)) {
        const Chain<Axes> chain(
            epochs.subspan(section.used_first, section.used_end - section.used_first), model);
        for (std::size_t k = section.first; k < section.end; ++k) {
            const std::size_t at = k - section.used_first;
            smoothed.states[k] = chain.mean(at);
            set_motion(chain, at, rows[arc.rows[k]]);
            if (k == epochs.size() / 2)
                smoothed.covariance_in_the_middle = chain.state(at).covariance;
            if (k % condition_every != 0) continue;
            smoothed.largest_condition = std::max(
                smoothed.largest_condition, scaled_condition<Axes>(chain.state(at).covariance));
            smoothed.largest_asymmetry = std::max(smoothed.largest_asymmetry, chain.asymmetry(at));
        }
    }
    return smoothed;
}

template <int Axes>
void set_jerk_density(const Arc<Axes>& arc, const EstimationModel& model,
                      std::vector<TrajectoryEpoch>& rows) {
    constexpr auto column =
        Axes == 1 ? &TrajectoryEpoch::jerk_density_up : &TrajectoryEpoch::jerk_density;
    for (std::size_t k = 0; k < arc.epochs.size(); ++k)
        rows[arc.rows[k]].*column = model.motion.jerk_density * arc.epochs[k].jerk_factor;
}

template void set_jerk_density<1>(const Arc<1>&, const EstimationModel&,
                                  std::vector<TrajectoryEpoch>&);
template void set_jerk_density<2>(const Arc<2>&, const EstimationModel&,
                                  std::vector<TrajectoryEpoch>&);

template std::vector<ArcSection> smoothed_sections<1>(std::span<const ArcEpoch<1>>,
                                                      const EstimationModel&);
template std::vector<ArcSection> smoothed_sections<2>(std::span<const ArcEpoch<2>>,
                                                      const EstimationModel&);

template SmoothedMeans<1> smooth_rows<1>(const Arc<1>&, const EstimationModel&,
                                         std::vector<TrajectoryEpoch>&);
template SmoothedMeans<2> smooth_rows<2>(const Arc<2>&, const EstimationModel&,
                                         std::vector<TrajectoryEpoch>&);

void set_paper_methods(const Arc<2>& arc, double acceleration_sigma_m_s2,
                       std::vector<TrajectoryEpoch>& rows) {
    std::vector<PlanePosition> positions;
    std::vector<std::size_t> of_rows;
    for (std::size_t k = 0; k < arc.epochs.size(); ++k) {
        const auto& measurement = arc.epochs[k].measurement;
        if (!measurement) continue;
        positions.push_back({.time_s = arc.epochs[k].time_s,
                             .position = measurement->position,
                             .sigma_m = std::sqrt(measurement->covariance.trace() / 2.0)});
        of_rows.push_back(arc.rows[k]);
    }
    const auto v1 = speed_v1(positions);
    const auto v2 = speed_v2(positions);
    const auto filtered = filter_dhd22(positions, acceleration_sigma_m_s2);
    for (std::size_t k = 0; k < of_rows.size(); ++k) {
        TrajectoryEpoch& row = rows[of_rows[k]];
        row.speed_v1_m_s = v1[k];
        row.speed_v2_m_s = v2[k];
        row.speed_kalman_m_s = filtered[k].speed_m_s();
    }
}

}  // namespace runcert
