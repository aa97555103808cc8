#include "estimation/kalman.h"

#include <Eigen/Cholesky>

namespace runcert {

template <int Axes>
StateEstimate<Axes> vague_prior(const PositionVector<Axes>& position) {
    constexpr double sigma_position_m = 100.0;
    constexpr double sigma_velocity_mps = 300.0;
    constexpr double sigma_acceleration_mps2 = 100.0;
    StateEstimate<Axes> prior;
    prior.mean.template head<Axes>() = position;
    StateVector<Axes> sigma;
    sigma << PositionVector<Axes>::Constant(sigma_position_m),
        PositionVector<Axes>::Constant(sigma_velocity_mps),
        PositionVector<Axes>::Constant(sigma_acceleration_mps2);
    prior.covariance = sigma.cwiseAbs2().asDiagonal();
    return prior;
}

template <int Axes>
StateEstimate<Axes> predict(const StateEstimate<Axes>& estimate, const MotionModel& model,
                            double dt_s) {
    const StateMatrix<Axes> f = transition<Axes>(dt_s);
    StateEstimate<Axes> predicted;
    predicted.mean = f * estimate.mean;
    const StateMatrix<Axes> covariance =
        f * estimate.covariance * f.transpose() + process_noise<Axes>(model, dt_s);
    predicted.covariance = 0.5 * (covariance + covariance.transpose());
    return predicted;
}

template <int Axes>
Innovation<Axes> innovation(const StateEstimate<Axes>& predicted,
                            const PositionMeasurement<Axes>& measurement) {
    Innovation<Axes> result;
    result.residual = measurement.position - predicted.mean.template head<Axes>();
    result.covariance =
        predicted.covariance.template topLeftCorner<Axes, Axes>() + measurement.covariance;
    result.statistic = result.residual.dot(result.covariance.llt().solve(result.residual));
    return result;
}

template <int Axes>
StateEstimate<Axes> update(const StateEstimate<Axes>& predicted,
                           const PositionMeasurement<Axes>& measurement) {
    const Innovation<Axes> seen = innovation(predicted, measurement);
    using GainMatrix = Eigen::Matrix<double, state_size<Axes>, Axes>;
    const GainMatrix cross = predicted.covariance.template leftCols<Axes>();
    const GainMatrix gain = seen.covariance.llt().solve(cross.transpose()).transpose();
    StateMatrix<Axes> keep = StateMatrix<Axes>::Identity();
    keep.template leftCols<Axes>() -= gain;
    StateEstimate<Axes> updated;
    updated.mean = predicted.mean + gain * seen.residual;
    const StateMatrix<Axes> covariance = keep * predicted.covariance * keep.transpose() +
                                         gain * measurement.covariance * gain.transpose();
    updated.covariance = 0.5 * (covariance + covariance.transpose());
    return updated;
}

#define RUNCERT_INSTANTIATE(AXES)                                                              \
    template StateEstimate<AXES> vague_prior<AXES>(const PositionVector<AXES>&);               \
    template StateEstimate<AXES> predict<AXES>(const StateEstimate<AXES>&, const MotionModel&, \
                                               double);                                        \
    template Innovation<AXES> innovation<AXES>(const StateEstimate<AXES>&,                     \
                                               const PositionMeasurement<AXES>&);              \
    template StateEstimate<AXES> update<AXES>(const StateEstimate<AXES>&,                      \
                                              const PositionMeasurement<AXES>&);
RUNCERT_INSTANTIATE(2)
RUNCERT_INSTANTIATE(3)

}  // namespace runcert
