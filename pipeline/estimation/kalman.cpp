#include "estimation/kalman.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
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
    step_ = axis_step(model_, kind);
    kernel_step_ = kernel::Transition(step_);
    transition_ = runcert::transition<Axes>(step_);
}

template <int Axes>
const AxisStep& KalmanFilter<Axes>::step_of(const StepKind& kind) {
    prepare(kind);
    return step_;
}

template <int Axes>
const StateMatrix<Axes>& KalmanFilter<Axes>::transition_of(const StepKind& kind) {
    prepare(kind);
    return transition_;
}

template <int Axes>
void KalmanFilter<Axes>::carry(StateEstimate<Axes>& estimate, const StepKind& kind) {
    prepare(kind);
    kernel::carry<Axes, 4>(kernel_step_, estimate.mean.data());
    kernel::carry_covariance<Axes, 4>(kernel_step_, estimate.covariance.data());
    kernel::add_noise<Axes, 4>(step_, estimate.covariance.data());
}

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::predict(const StateEstimate<Axes>& estimate, double dt_s) {
    StateEstimate<Axes> predicted = estimate;
    carry(predicted, {.length_ns = std::llround(dt_s * 1e9)});
    return predicted;
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
StateEstimate<Axes> KalmanFilter<Axes>::predict_to(const StateEstimate<Axes>& estimate,
                                                   const ArcEpoch<Axes>& from,
                                                   const ArcEpoch<Axes>& to) {
    StateEstimate<Axes> predicted = estimate;
    carry_to(predicted, from, to);
    return predicted;
}

template <int Axes>
Innovation<Axes> KalmanFilter<Axes>::innovation(
    const StateEstimate<Axes>& predicted, const PositionMeasurement<Axes>& measurement) const {
    const StateMatrix<Axes>& p = predicted.covariance;
    const double scale = model_.measurement_scale * model_.measurement_scale;
    Innovation<Axes> result;
    result.residual = residual(predicted.mean, measurement.position);
    result.covariance = p.template topLeftCorner<Axes, Axes>() +
                        p.template topRightCorner<Axes, Axes>() +
                        p.template bottomLeftCorner<Axes, Axes>() +
                        p.template bottomRightCorner<Axes, Axes>() + scale * measurement.covariance;
    const PositionMatrix<Axes> noise = scale * measurement.covariance;
    result.statistic = kernel::see<Axes, 4>(predicted.mean.data(), p.data(),
                                            measurement.position.data(), noise.data())
                           .statistic;
    return result;
}

template <int Axes>
typename KalmanFilter<Axes>::GainMatrix KalmanFilter<Axes>::gain(
    const StateEstimate<Axes>& predicted, const Innovation<Axes>& seen) const {
    // H = [I 0 0 I].
    const GainMatrix cross = predicted.covariance.template leftCols<Axes>() +
                             predicted.covariance.template rightCols<Axes>();
    return seen.covariance.llt().solve(cross.transpose()).transpose();
}

template <int Axes>
kernel::Seen<Axes, 4> KalmanFilter<Axes>::take_in(
    StateEstimate<Axes>& estimate, const PositionMeasurement<Axes>& measurement) const {
    const double scale = model_.measurement_scale * model_.measurement_scale;
    const PositionMatrix<Axes> noise = scale * measurement.covariance;
    const auto seen = kernel::see<Axes, 4>(estimate.mean.data(), estimate.covariance.data(),
                                           measurement.position.data(), noise.data());
    kernel::take_in<Axes, 4>(seen, noise.data(), estimate.mean.data(), estimate.covariance.data());
    kernel::mirror<state_size<Axes>>(estimate.covariance.data());
    return seen;
}

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::update(const StateEstimate<Axes>& predicted,
                                               const PositionMeasurement<Axes>& measurement) const {
    StateEstimate<Axes> updated = predicted;
    take_in(updated, measurement);
    return updated;
}

template <int Axes>
void require_positive_definite(const PositionMatrix<Axes>& covariance, double time_s) {
    if (kernel::is_positive_definite<Axes>(covariance.data())) return;
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the stated covariance of the position is not positive definite",
                  "Check the stated standard deviations and correlations of this epoch");
}
template void require_positive_definite<1>(const PositionMatrix<1>&, double);
template void require_positive_definite<2>(const PositionMatrix<2>&, double);
template void require_positive_definite<3>(const PositionMatrix<3>&, double);

template class KalmanFilter<1>;
template class KalmanFilter<2>;
template class KalmanFilter<3>;

}  // namespace runcert
