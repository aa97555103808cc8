#include "motion/sensitivity.h"

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
    // Covariance of each state with the functional. One part comes from this and earlier states and
    // is carried forward; the other comes from later states and is carried back.
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

template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, const GaussMarkovError& error,
                         std::span<const PositionVector<Axes>> weights) {
    assert(weights.size() == arc.size());
    EstimationModel model;
    model.error = error;
    // Variance of the error, its covariance with the sum so far, and variance of the sum.
    double variance = error.initial_sigma_m * error.initial_sigma_m;
    PositionVector<Axes> with_sum = PositionVector<Axes>::Zero();
    double of_sum = 0.0;
    StepKind kind;
    AxisStep step;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (k > 0) {
            const StepKind next = step_kind(arc[k - 1], arc[k]);
            if (next.length_ns != kind.length_ns) step = axis_step(model, next.dt_s());
            kind = next;
            with_sum *= step.error_transition;
            variance = step.error_transition * step.error_transition * variance + step.error_noise;
        }
        of_sum += 2.0 * weights[k].dot(with_sum) + variance * weights[k].squaredNorm();
        with_sum += variance * weights[k];
    }
    return of_sum;
}

template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, double scale,
                         std::span<const PositionVector<Axes>> weights) {
    double sum = 0.0;
    for (std::size_t k = 0; k < arc.size(); ++k)
        if (arc[k].measurement) sum += weights[k].dot(arc[k].measurement->covariance * weights[k]);
    return scale * scale * sum;
}

#define RUNCERT_INSTANTIATE(AXES)                                                    \
    template double weighted_variance<AXES>(std::span<const ArcEpoch<AXES>>,         \
                                            const GaussMarkovError&,                 \
                                            std::span<const PositionVector<AXES>>);  \
    template double weighted_variance<AXES>(std::span<const ArcEpoch<AXES>>, double, \
                                            std::span<const PositionVector<AXES>>);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

template std::vector<PositionVector<1>> sensitivities<1>(std::span<const ArcEpoch<1>>,
                                                         const EstimationModel&,
                                                         const SmoothedArc<1>&, std::size_t,
                                                         const Gradients<1>&);
template std::vector<PositionVector<2>> sensitivities<2>(std::span<const ArcEpoch<2>>,
                                                         const EstimationModel&,
                                                         const SmoothedArc<2>&, std::size_t,
                                                         const Gradients<2>&);

}  // namespace runcert
