#pragma once

#include <optional>
#include <vector>

#include "arcs/arcs.h"
#include "arcs/window_ends.h"
#include "schemas/windows/windows.h"

namespace runcert {

/// Windows of one arc that could have been the best, close enough to one another to be estimated
/// together.
template <int Axes>
struct WindowCluster {
    const Arc<Axes>* arc = nullptr;
    std::vector<EpochPair> windows;  ///< in the order of their beginning
    /// Which of them is the chosen window; empty where it is in another cluster.
    std::optional<std::size_t> chosen = std::nullopt;
};

/// The two noise models that a selection rests on, and how windows were compared.
struct SelectionModels {
    EstimationModel searched;   ///< of the trajectory that the windows were compared on
    EstimationModel certified;  ///< of the speed that is stated for the chosen one
    bool by_path = false;       ///< compared by path length over time, not by displacement
};

/// What choosing the fastest of these windows adds to the speed stated for it (m/s).
///
/// Where the craft is fast for longer than a window, the fastest of many windows is the one whose
/// errors point forward. How much that adds is found by doing it again: the motion through each
/// cluster is estimated anew with a jerk density fitted to the cluster alone, errors as the noise
/// model has them are drawn onto it (all windows of a draw share them: their joint distribution),
/// each draw is smoothed and searched as the recording was, and the speed stated for its fastest
/// window is compared with that window's true one; what smoothing itself does to the window is so
/// part of the answer. The motion so estimated still holds some noise, which makes the answer too
/// small; the same is done from motions estimated from drawn recordings, and the difference put on
/// (a bootstrap, calibrated by a second one: Efron & Tibshirani 1993, 18).
///
/// `stated_mps` is the certified speed of the chosen window, which one of the clusters has.
template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_mps, std::int64_t samples,
                             std::int64_t seed);

}  // namespace runcert
