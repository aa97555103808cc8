#include "estimation/smoother.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cassert>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
struct ForwardPass {
    std::vector<StateEstimate<Axes>> predicted;
    std::vector<StateEstimate<Axes>> filtered;
};

template <int Axes>
ForwardPass<Axes> filter_forward(std::span<const ArcEpoch<Axes>> arc, const MotionModel& model,
                                 SmoothedArc<Axes>& result) {
    assert(!arc.empty() && arc.front().measurement);
    ForwardPass<Axes> pass;
    pass.predicted.reserve(arc.size());
    pass.filtered.reserve(arc.size());
    for (std::size_t k = 0; k < arc.size(); ++k) {
        pass.predicted.push_back(
            k == 0 ? vague_prior<Axes>(arc[0].measurement->position)
                   : predict(pass.filtered.back(), model, arc[k].time_s - arc[k - 1].time_s));
        if (!arc[k].measurement) {
            pass.filtered.push_back(pass.predicted.back());
            continue;
        }
        result.innovation_sum += innovation(pass.predicted.back(), *arc[k].measurement).statistic;
        ++result.measurements;
        pass.filtered.push_back(update(pass.predicted.back(), *arc[k].measurement));
    }
    return pass;
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
SmoothedArc<Axes> smooth(std::span<const ArcEpoch<Axes>> arc, const MotionModel& model) {
    SmoothedArc<Axes> result;
    ForwardPass<Axes> pass = filter_forward(arc, model, result);
    result.states = std::move(pass.filtered);
    result.gains.resize(arc.size() - 1);
    for (std::size_t k = arc.size() - 1; k-- > 0;) {
        const double dt_s = arc[k + 1].time_s - arc[k].time_s;
        const StateEstimate<Axes>& predicted = pass.predicted[k + 1];
        const Eigen::LLT<StateMatrix<Axes>> factor(predicted.covariance);
        if (factor.info() != Eigen::Success)
            throw Failure(fmt::format("time {:.3f} s", arc[k + 1].time_s),
                          "the predicted covariance is not positive definite",
                          "Check the stated accuracies and the time steps around this epoch");
        StateEstimate<Axes>& state = result.states[k];
        const StateMatrix<Axes> gain =
            factor.solve(transition<Axes>(dt_s) * state.covariance).transpose();
        state.mean += gain * (result.states[k + 1].mean - predicted.mean);
        const StateMatrix<Axes> covariance =
            state.covariance +
            gain * (result.states[k + 1].covariance - predicted.covariance) * gain.transpose();
        state.covariance = 0.5 * (covariance + covariance.transpose());
        result.gains[k] = gain;
    }
    return result;
}

template struct SmoothedArc<2>;
template struct SmoothedArc<3>;
template SmoothedArc<2> smooth<2>(std::span<const ArcEpoch<2>>, const MotionModel&);
template SmoothedArc<3> smooth<3>(std::span<const ArcEpoch<3>>, const MotionModel&);

}  // namespace runcert
