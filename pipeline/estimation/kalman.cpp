#include "estimation/kalman.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/failure.h"

namespace runcert {

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::prior(const PositionVector<Axes>& position) const {
    constexpr double sigma_velocity_mps = 300.0;
    constexpr double sigma_acceleration_mps2 = 100.0;
    StateEstimate<Axes> prior;
    prior.mean.template head<Axes>() = position;
    StateVector<Axes> sigma;
    sigma << PositionVector<Axes>::Constant(vague_position_sigma_m),
        PositionVector<Axes>::Constant(sigma_velocity_mps),
        PositionVector<Axes>::Constant(sigma_acceleration_mps2),
        PositionVector<Axes>::Constant(model_.error.initial_sigma_m);
    prior.covariance = sigma.cwiseAbs2().asDiagonal();
    return prior;
}

template <int Axes>
void KalmanFilter<Axes>::prepare(double dt_s) {
    const std::int64_t step_ns = std::llround(dt_s * 1e9);
    if (step_ns == step_ns_) return;
    step_ns_ = step_ns;
    step_ = axis_step(model_, static_cast<double>(step_ns) * 1e-9);
    transition_ = runcert::transition<Axes>(step_);
    process_noise_ = runcert::process_noise<Axes>(step_);
}

template <int Axes>
const AxisStep& KalmanFilter<Axes>::step_over(double dt_s) {
    prepare(dt_s);
    return step_;
}

template <int Axes>
const StateMatrix<Axes>& KalmanFilter<Axes>::transition_over(double dt_s) {
    prepare(dt_s);
    return transition_;
}

namespace {

/// F times a matrix of the state's height, in place. The transition acts on whole blocks of rows,
/// which costs a small part of the general product.
template <int Axes, class Matrix>
void apply_transition(const AxisStep& step, Matrix& matrix) {
    const Eigen::Matrix3d& f = step.transition;
    matrix.template topRows<Axes>() += f(0, 1) * matrix.template middleRows<Axes>(Axes) +
                                       f(0, 2) * matrix.template middleRows<Axes>(2 * Axes);
    matrix.template middleRows<Axes>(Axes) += f(1, 2) * matrix.template middleRows<Axes>(2 * Axes);
    matrix.template middleRows<Axes>(2 * Axes) *= f(2, 2);
    matrix.template bottomRows<Axes>() *= step.error_transition;
}

}  // namespace

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::predict(const StateEstimate<Axes>& estimate, double dt_s) {
    prepare(dt_s);
    StateEstimate<Axes> predicted = estimate;
    apply_transition<Axes>(step_, predicted.mean);
    // F P, then F (F P)' = F P F' for a symmetric P.
    apply_transition<Axes>(step_, predicted.covariance);
    StateMatrix<Axes> covariance = predicted.covariance.transpose();
    apply_transition<Axes>(step_, covariance);
    predicted.covariance = 0.5 * (covariance + covariance.transpose()) + process_noise_;
    return predicted;
}

template <int Axes>
StateEstimate<Axes> KalmanFilter<Axes>::predict_to(const StateEstimate<Axes>& estimate,
                                                   const ArcEpoch<Axes>& from,
                                                   const ArcEpoch<Axes>& to) {
    StateEstimate<Axes> predicted = predict(estimate, to.time_s - from.time_s);
    if (to.step_before)
        predicted.covariance.diagonal().template head<Axes>().array() +=
            vague_position_sigma_m * vague_position_sigma_m;
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
    result.statistic = result.residual.dot(result.covariance.llt().solve(result.residual));
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
StateEstimate<Axes> KalmanFilter<Axes>::update(const StateEstimate<Axes>& predicted,
                                               const PositionMeasurement<Axes>& measurement,
                                               const Innovation<Axes>& seen) const {
    const double scale = model_.measurement_scale * model_.measurement_scale;
    const GainMatrix gain = this->gain(predicted, seen);
    StateEstimate<Axes> updated;
    updated.mean = predicted.mean + gain * seen.residual;
    // (I - K H) P (I - K H)' + K R K', one side after the other: H only adds columns.
    using Wide = Eigen::Matrix<double, Axes, state_size<Axes>>;
    const Wide seen_rows = predicted.covariance.template topRows<Axes>() +
                           predicted.covariance.template bottomRows<Axes>();
    const StateMatrix<Axes> one_side = predicted.covariance - gain * seen_rows;
    const GainMatrix seen_columns =
        one_side.template leftCols<Axes>() + one_side.template rightCols<Axes>();
    const GainMatrix noise = gain * (scale * measurement.covariance);
    const StateMatrix<Axes> covariance = one_side + (noise - seen_columns) * gain.transpose();
    updated.covariance = 0.5 * (covariance + covariance.transpose());
    return updated;
}

template <int Axes>
void require_positive_definite(const PositionMatrix<Axes>& covariance, double time_s) {
    if (covariance.allFinite() && covariance.llt().info() == Eigen::Success) return;
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the stated covariance of the position is not positive definite",
                  "Check the stated accuracies and correlations of this epoch");
}
template void require_positive_definite<1>(const PositionMatrix<1>&, double);
template void require_positive_definite<2>(const PositionMatrix<2>&, double);
template void require_positive_definite<3>(const PositionMatrix<3>&, double);

template class KalmanFilter<1>;
template class KalmanFilter<2>;
template class KalmanFilter<3>;

}  // namespace runcert
