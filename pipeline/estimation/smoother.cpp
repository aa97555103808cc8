#include "estimation/smoother.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
using Factor = Eigen::LLT<StateMatrix<Axes>>;

/// The Cholesky factor of a covariance, after a repair where rounding has made one necessary.
template <int Axes>
Factor<Axes> factorise(const StateMatrix<Axes>& covariance, double time_s, std::int64_t& repaired) {
    const Factor<Axes> factor(covariance);
    // What is not a number passes the factorisation.
    if (factor.info() == Eigen::Success && covariance.allFinite()) return factor;
    const StateVector<Axes> scale = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    if (covariance.allFinite() && (scale.array() > 0.0).all()) {
        const StateVector<Axes> inverse = scale.cwiseInverse();
        const Eigen::SelfAdjointEigenSolver<StateMatrix<Axes>> solver(
            inverse.asDiagonal() * covariance * inverse.asDiagonal());
        constexpr double rounding = 1e-9;
        if (solver.info() == Eigen::Success && solver.eigenvalues().minCoeff() > -rounding) {
            const StateVector<Axes> values = solver.eigenvalues().cwiseMax(1e-12);
            const StateMatrix<Axes> mended = scale.asDiagonal() * solver.eigenvectors() *
                                             values.asDiagonal() *
                                             solver.eigenvectors().transpose() * scale.asDiagonal();
            const Factor<Axes> again(mended);
            if (again.info() == Eigen::Success) {
                ++repaired;
                return again;
            }
        }
    }
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the predicted covariance is not positive definite",
                  "Check the stated accuracies and the time steps around this epoch");
}

}  // namespace

template <int Axes>
StateMatrix<Axes> SmoothedArc<Axes>::cross_covariance(std::size_t s, std::size_t e) const {
    StateMatrix<Axes> product = states[e].covariance;
    for (std::size_t k = e; k > s; --k)
        product = gains[k - 1] * product;
    return product;
}

template <int Axes>
double SmoothedArc<Axes>::variance(std::size_t s, const Gradients<Axes>& gradients) const {
    assert(!gradients.empty() && s + gradients.size() <= states.size());
    double sum = 0.0;
    StateVector<Axes> carried = gradients[0];
    for (std::size_t i = 0; i + 1 < gradients.size(); ++i) {
        const std::size_t k = s + i;
        const StateVector<Axes> next = gains[k].transpose() * carried;
        sum +=
            carried.dot(states[k].covariance * carried) - next.dot(states[k + 1].covariance * next);
        carried = gradients[i + 1] + next;
    }
    return sum + carried.dot(states[s + gradients.size() - 1].covariance * carried);
}

template <int Axes>
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model) {
    assert(!arc.empty() && arc.front().measurement);
    KalmanFilter<Axes> filter(model);
    SmoothedArc<Axes> result;
    result.states.reserve(arc.size());
    std::vector<StateEstimate<Axes>> predictions;
    predictions.reserve(arc.size());
    filter_along<Axes>(filter, arc,
                       [&](std::size_t, const StateEstimate<Axes>& predicted,
                           const Innovation<Axes>* seen, const StateEstimate<Axes>& filtered) {
                           predictions.push_back(predicted);
                           result.states.push_back(filtered);
                           if (!seen) return;
                           result.innovation_sum += seen->statistic;
                           ++result.measurements;
                       });
    result.gains.resize(arc.size() - 1);
    for (std::size_t k = arc.size() - 1; k-- > 0;) {
        const double dt_s = arc[k + 1].time_s - arc[k].time_s;
        const StateEstimate<Axes>& predicted = predictions[k + 1];
        const Factor<Axes> factor =
            factorise<Axes>(predicted.covariance, arc[k + 1].time_s, result.repaired);
        StateEstimate<Axes>& state = result.states[k];
        const StateMatrix<Axes> gain =
            factor.solve(filter.transition_over(dt_s) * state.covariance).transpose();
        state.mean += gain * (result.states[k + 1].mean - predicted.mean);
        const StateMatrix<Axes> covariance =
            state.covariance +
            gain * (result.states[k + 1].covariance - predicted.covariance) * gain.transpose();
        result.largest_asymmetry =
            std::max(result.largest_asymmetry,
                     (covariance - covariance.transpose()).norm() / covariance.norm());
        state.covariance = 0.5 * (covariance + covariance.transpose());
        if (!(state.covariance.diagonal().array() > 0.0).all())
            throw Failure(fmt::format("time {:.3f} s", arc[k].time_s),
                          "the smoothed covariance is not positive definite",
                          "Check the stated accuracies and the time steps around this epoch");
        result.gains[k] = gain;
    }
    return result;
}

template struct SmoothedArc<1>;
template struct SmoothedArc<2>;
template struct SmoothedArc<3>;
template SmoothedArc<1> smooth<1>(std::span<const ArcEpoch<1>>, const EstimationModel&);
template SmoothedArc<2> smooth<2>(std::span<const ArcEpoch<2>>, const EstimationModel&);
template SmoothedArc<3> smooth<3>(std::span<const ArcEpoch<3>>, const EstimationModel&);

}  // namespace runcert
