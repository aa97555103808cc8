#include "estimation/fixed_lag.h"

#include "estimation/smoother.h"

namespace runcert {
namespace {

/// The RTS step: `state`, given the measurements up to its own epoch, with what later ones say of
/// the next epoch.
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
std::vector<StateEstimate<Axes>> smooth_fixed_lag(std::span<const ArcEpoch<Axes>> arc,
                                                  const EstimationModel& model, std::size_t lag) {
    if (arc.empty()) return {};
    // A gain depends on the filter alone, so those of the whole arc serve every lag.
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
    // The epochs from here on know all measurements, and share the recursion from the arc's end.
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

template std::vector<StateEstimate<1>> smooth_fixed_lag<1>(std::span<const ArcEpoch<1>>,
                                                           const EstimationModel&, std::size_t);
template std::vector<StateEstimate<2>> smooth_fixed_lag<2>(std::span<const ArcEpoch<2>>,
                                                           const EstimationModel&, std::size_t);

}  // namespace runcert
