#include "motion/kalman.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/failure.h"

namespace runcert {

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::prior(const PositionVector<Axes>& position) const {
    constexpr double sigma_velocity_m_s = 300.0;
    constexpr double sigma_acceleration_m_s2 = 100.0;
    StateEstimate<Axes> prior;
    prior.mean.template head<Axes>() = position;
    StateVector<Axes> sigma;
    sigma << PositionVector<Axes>::Constant(vague_position_sigma_m),
        PositionVector<Axes>::Constant(sigma_velocity_m_s),
        PositionVector<Axes>::Constant(sigma_acceleration_m_s2),
        PositionVector<Axes>::Constant(model_.error.initial_sigma_m);
    prior.covariance = sigma.cwiseAbs2().asDiagonal();
    return prior;
}

template <int Axes>
void KalmanFilter<Axes>::prepare(const StepKind& kind) {
    if (kind == kind_) return;
    kind_ = kind;
    numbers_ = kernel::numbers_of(axis_step(model_, kind));
}

template <int Axes>
const kernel::StepNumbers<double>& KalmanFilter<Axes>::numbers_of(const StepKind& kind) {
    prepare(kind);
    return numbers_;
}

template <int Axes>
void KalmanFilter<Axes>::carry(StateEstimate<Axes>& estimate, const StepKind& kind) {
    prepare(kind);
    kernel::carry<Axes>(numbers_, estimate.mean.data());
    kernel::carry_covariance<Axes>(numbers_, estimate.covariance.data());
    kernel::mirror<state_size<Axes>>(estimate.covariance.data());
}

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::predict(StateEstimate<Axes> estimate, double dt_s) {
    carry(estimate, {.length_ns = std::llround(dt_s * 1e9)});
    return estimate;
}

template <int Axes>
void KalmanFilter<Axes>::carry_to(StateEstimate<Axes>& estimate, const ArcEpoch<Axes>& from,
                                  const ArcEpoch<Axes>& to) {
    carry(estimate, step_kind(from, to));
    if (to.step_before)
        estimate.covariance.diagonal().template head<Axes>().array() +=
            vague_position_sigma_m * vague_position_sigma_m;
}

template <int Axes>
Innovation<Axes> KalmanFilter<Axes>::update(StateEstimate<Axes>& estimate,
                                            const PositionMeasurement<Axes>& measurement) const {
    const double scale = model_.measurement_scale * model_.measurement_scale;
    Innovation<Axes> seen;
    seen.white = kernel::whitening_of<Axes>(measurement.covariance);
    for (int j = 0; j < Axes; ++j) {
        const double measured = kernel::whitened<Axes>(
            seen.white, j, [&](int axis) { return measurement.position(axis); });
        seen.coordinates[j] =
            kernel::update<Axes>(seen.white, j, measured, scale * seen.white.variance[j],
                                 estimate.mean.data(), estimate.covariance.data());
    }
    kernel::mirror<state_size<Axes>>(estimate.covariance.data());
    return seen;
}

template <int Axes>
void require_positive_definite(const PositionMatrix<Axes>& covariance, double time_s) {
    if (kernel::whitening_of<Axes>(covariance).is_positive_definite()) return;
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the stated covariance of the position is not positive definite",
                  "Check the stated standard deviations and correlations of this epoch");
}
template void require_positive_definite<1>(const PositionMatrix<1>&, double);
template void require_positive_definite<2>(const PositionMatrix<2>&, double);
template void require_positive_definite<3>(const PositionMatrix<3>&, double);

template <int Axes>
double memory_s(std::span<const ArcEpoch<Axes>> epochs, const EstimationModel& model) {
    constexpr double time_constants = 28.0;
    double variance_m2 = 0.0;
    double least_factor = epochs.back().jerk_factor;
    for (const ArcEpoch<Axes>& epoch : epochs) {
        least_factor = std::min(least_factor, epoch.jerk_factor);
        if (epoch.measurement)
            variance_m2 = std::max(variance_m2, epoch.measurement->covariance.trace());
    }
    variance_m2 *= model.measurement_scale * model.measurement_scale;
    const double interval_s =
        (epochs.back().time_s - epochs.front().time_s) / static_cast<double>(epochs.size() - 1);
    const GaussMarkovError& error = model.error;
    const double slow_m2 =
        std::max(error.initial_sigma_m * error.initial_sigma_m,
                 0.5 * error.tau_s * error.process_density * error.process_density);
    const auto uncertain_s = [&](double density) {
        return std::cbrt(std::sqrt(density) / (least_factor * model.motion.jerk_density));
    };
    return time_constants *
           (error.tau_s + 2.0 * interval_s + 2.0 * uncertain_s(variance_m2 * interval_s) +
            2.0 * uncertain_s(2.0 * slow_m2 * error.tau_s));
}

template double memory_s<1>(std::span<const ArcEpoch<1>>, const EstimationModel&);
template double memory_s<2>(std::span<const ArcEpoch<2>>, const EstimationModel&);

template class KalmanFilter<1>;
template class KalmanFilter<2>;
template class KalmanFilter<3>;

}  // namespace runcert
