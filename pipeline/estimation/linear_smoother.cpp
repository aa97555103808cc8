#include "estimation/linear_smoother.h"

#include <cassert>
#include <utility>

namespace runcert {

template <int Axes>
LinearSmoother<Axes>::LinearSmoother(std::span<const ArcEpoch<Axes>> arc,
                                     const EstimationModel& model)
    : LinearSmoother(arc, model, smooth<Axes>(arc, model)) {}

template <int Axes>
LinearSmoother<Axes>::LinearSmoother(std::span<const ArcEpoch<Axes>> arc,
                                     const EstimationModel& model, SmoothedArc<Axes> smoothed)
    : filter_(model),
      smoother_gains_(std::move(smoothed.gains)),
      bridged_(std::move(smoothed.bridged)) {
    transitions_.reserve(arc.size());
    filter_gains_.reserve(arc.size());
    for (std::size_t k = 0; k + 1 < arc.size(); ++k)
        transitions_.push_back(filter_.transition_over(arc[k + 1].time_s - arc[k].time_s));
    filter_along<Axes>(filter_, arc,
                       [&](std::size_t, const StateEstimate<Axes>& predicted,
                           const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                           assert(seen);
                           filter_gains_.push_back(filter_.gain(predicted, *seen));
                       });
}

template <int Axes>
std::vector<PositionVector<Axes>> LinearSmoother<Axes>::operator()(
    std::span<const PositionVector<Axes>> measured) const {
    assert(measured.size() == filter_gains_.size());
    const std::size_t count = measured.size();
    std::vector<StateVector<Axes>> predicted(count);
    std::vector<StateVector<Axes>> states(count);
    for (std::size_t k = 0; k < count; ++k) {
        predicted[k] = k == 0 ? filter_.prior(measured[0]).mean
                              : StateVector<Axes>(transitions_[k - 1] * states[k - 1]);
        states[k] = predicted[k] + filter_gains_[k] * filter_.residual(predicted[k], measured[k]);
    }
    for (std::size_t k = count - 1; k-- > 0;)
        states[k] += smoother_gains_[k] * (states[k + 1] - predicted[k + 1]);
    std::vector<PositionVector<Axes>> positions(count);
    for (std::size_t k = 0; k < count; ++k)
        positions[k] = states[k].template head<Axes>();
    for (const BridgedStep& step : bridged_) {
        const std::size_t at = step.epoch;
        const PositionVector<Axes> offset = states[at].template head<Axes>() -
                                            states[at - 1].template head<Axes>() -
                                            step.motion<Axes>(states[at - 1], states[at]);
        for (std::size_t k = at; k < count; ++k)
            positions[k] -= offset;
    }
    return positions;
}

template class LinearSmoother<1>;
template class LinearSmoother<2>;

}  // namespace runcert
