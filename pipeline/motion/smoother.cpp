#include "motion/smoother.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
using Factor = Eigen::LLT<StateMatrix<Axes>>;

/// The Cholesky factor of a covariance. If it fails to be positive definite only by rounding, so
/// that adding 1e-9 of each variance makes it so, that is added.
template <int Axes>
Factor<Axes> factorise(const StateMatrix<Axes>& covariance, double time_s, std::int64_t& repaired) {
    const Factor<Axes> factor(covariance);
    // NaN passes the factorisation.
    if (factor.info() == Eigen::Success && covariance.allFinite()) return factor;
    if (covariance.allFinite() && (covariance.diagonal().array() > 0.0).all()) {
        constexpr double rounding = 1e-9;
        StateMatrix<Axes> mended = covariance;
        mended.diagonal() *= 1.0 + rounding;
        const Factor<Axes> again(mended);
        if (again.info() == Eigen::Success) {
            ++repaired;
            return again;
        }
    }
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the predicted covariance is not positive definite",
                  "Check the stated standard deviations and the time steps around this epoch");
}

/// The RTS step: updates `state`, given the measurements up to its own epoch, with what later ones
/// say about the next epoch.
template <int Axes>
StateEstimate<Axes> step_back(const StateEstimate<Axes>& state, const StateMatrix<Axes>& gain,
                              const StateEstimate<Axes>& next,
                              const StateEstimate<Axes>& next_predicted) {
    const StateMatrix<Axes> covariance =
        state.covariance + gain * (next.covariance - next_predicted.covariance) * gain.transpose();
    return {.mean = state.mean + gain * (next.mean - next_predicted.mean),
            .covariance = 0.5 * (covariance + covariance.transpose())};
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
    const auto of = [&](const StateVector<Axes>& gradient, std::size_t k) -> double {
        return gradient.transpose() * (states[k].covariance * gradient);
    };
    double sum = 0.0;
    StateVector<Axes> carried = gradients[0];
    for (std::size_t i = 0; i + 1 < gradients.size(); ++i) {
        const std::size_t k = s + i;
        const StateVector<Axes> next = gains[k].transpose() * carried;
        sum += of(carried, k) - of(next, k + 1);
        carried = gradients[i + 1] + next;
    }
    return sum + of(carried, s + gradients.size() - 1);
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
        const StepKind kind = step_kind(arc[k], arc[k + 1]);
        const StateEstimate<Axes>& predicted = predictions[k + 1];
        const Factor<Axes> factor =
            factorise<Axes>(predicted.covariance, arc[k + 1].time_s, result.repaired);
        StateEstimate<Axes>& state = result.states[k];
        const StateMatrix<Axes> gain =
            factor.solve(filter.transition_of(kind) * state.covariance).transpose();
        state.mean += gain * (result.states[k + 1].mean - predicted.mean);
        const StateMatrix<Axes> covariance =
            state.covariance +
            gain * (result.states[k + 1].covariance - predicted.covariance) * gain.transpose();
        result.largest_asymmetry =
            std::max(result.largest_asymmetry,
                     (covariance - covariance.transpose()).norm() / covariance.norm());
        state.covariance = 0.5 * (covariance + covariance.transpose());
        if (!(state.covariance.diagonal().array() > 0.0).all())
            throw Failure(
                fmt::format("time {:.3f} s", arc[k].time_s),
                "the smoothed covariance is not positive definite",
                "Check the stated standard deviations and the time steps around this epoch");
        result.gains[k] = gain;
    }
    return result;
}

template <int Axes>
std::vector<StateEstimate<Axes>> smooth_fixed_lag(std::span<const ArcEpoch<Axes>> arc,
                                                  const EstimationModel& model, std::size_t lag) {
    if (arc.empty()) return {};
    // Gains depend only on the filter, so those of the whole arc serve every lag.
    const std::vector<StateMatrix<Axes>> gains = smooth<Axes>(arc, model).gains;
    std::vector<StateEstimate<Axes>> predicted;
    std::vector<StateEstimate<Axes>> filtered;
    predicted.reserve(arc.size());
    filtered.reserve(arc.size());
    KalmanFilter<Axes> filter(model);
    filter_along<Axes>(filter, arc,
                       [&](std::size_t, const StateEstimate<Axes>& before, const Innovation<Axes>*,
                           const StateEstimate<Axes>& after) {
                           predicted.push_back(before);
                           filtered.push_back(after);
                       });
    std::vector<StateEstimate<Axes>> states(arc.size());
    const std::size_t end = arc.size() - 1;
    // From here on the epochs know all measurements, and share the recursion from the arc's end.
    const std::size_t sharing = lag < end ? end - lag : 0;
    states[end] = filtered[end];
    for (std::size_t k = end; k-- > sharing;)
        states[k] = step_back<Axes>(filtered[k], gains[k], states[k + 1], predicted[k + 1]);
    for (std::size_t k = 0; k < sharing; ++k) {
        StateEstimate<Axes> state = filtered[k + lag];
        for (std::size_t j = k + lag; j-- > k;)
            state = step_back<Axes>(filtered[j], gains[j], state, predicted[j + 1]);
        states[k] = state;
    }
    return states;
}

template struct SmoothedArc<1>;
template struct SmoothedArc<2>;
template SmoothedArc<1> smooth<1>(std::span<const ArcEpoch<1>>, const EstimationModel&);
template SmoothedArc<2> smooth<2>(std::span<const ArcEpoch<2>>, const EstimationModel&);
template std::vector<StateEstimate<1>> smooth_fixed_lag<1>(std::span<const ArcEpoch<1>>,
                                                           const EstimationModel&, std::size_t);
template std::vector<StateEstimate<2>> smooth_fixed_lag<2>(std::span<const ArcEpoch<2>>,
                                                           const EstimationModel&, std::size_t);

}  // namespace runcert
