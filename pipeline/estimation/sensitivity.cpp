#include "estimation/sensitivity.h"

#include <Eigen/Cholesky>
#include <cassert>

namespace runcert {

template <int Axes>
std::vector<PositionVector<Axes>> sensitivities(std::span<const ArcEpoch<Axes>> arc,
                                                const EstimationModel& model,
                                                const SmoothedArc<Axes>& smoothed, std::size_t s,
                                                const Gradients<Axes>& gradients) {
    const std::size_t count = arc.size();
    assert(smoothed.states.size() == count && s + gradients.size() <= count);
    const auto gradient = [&](std::size_t k) -> StateVector<Axes> {
        return k >= s && k < s + gradients.size() ? gradients[k - s] : StateVector<Axes>::Zero();
    };
    // Covariance of each state with the functional: the part of it that stands on this state and
    // those before, carried forward, and the part on those after, carried back.
    std::vector<StateVector<Axes>> covariance(count);
    StateVector<Axes> after = StateVector<Axes>::Zero();
    for (std::size_t k = count; k-- > 0;) {
        if (k + 1 < count)
            after = smoothed.gains[k] *
                    (smoothed.states[k + 1].covariance * gradient(k + 1) + after).eval();
        covariance[k] = after;
    }
    StateVector<Axes> carried = StateVector<Axes>::Zero();
    const double scale = model.measurement_scale * model.measurement_scale;
    std::vector<PositionVector<Axes>> result(count, PositionVector<Axes>::Zero());
    for (std::size_t k = 0; k < count; ++k) {
        carried =
            gradient(k) + (k > 0 ? StateVector<Axes>(smoothed.gains[k - 1].transpose() * carried)
                                 : StateVector<Axes>(StateVector<Axes>::Zero()));
        if (!arc[k].measurement) continue;
        const StateVector<Axes> both = covariance[k] + smoothed.states[k].covariance * carried;
        const PositionVector<Axes> seen = both.template head<Axes>() + both.template tail<Axes>();
        result[k] = (scale * arc[k].measurement->covariance).llt().solve(seen);
    }
    return result;
}

template std::vector<PositionVector<1>> sensitivities<1>(std::span<const ArcEpoch<1>>,
                                                         const EstimationModel&,
                                                         const SmoothedArc<1>&, std::size_t,
                                                         const Gradients<1>&);
template std::vector<PositionVector<2>> sensitivities<2>(std::span<const ArcEpoch<2>>,
                                                         const EstimationModel&,
                                                         const SmoothedArc<2>&, std::size_t,
                                                         const Gradients<2>&);

}  // namespace runcert
