#pragma once

#include <optional>
#include <vector>

#include "schemas/windows/windows.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A window this many standard uncertainties slower than the best could not have been it.
inline constexpr double selection_width = 4.0;

/// A speed less the bias (both m/s) of choosing it as the fastest, and not below 0: a craft that
/// stands has no speed to take a bias off.
double less_bias(double speed_m_s, double bias_m_s);

/// Windows of one arc (Axes 2: east and north; 1: heights alone) that could have been the best,
/// close enough to one another to be estimated together.
template <int Axes>
struct WindowCluster {
    const Arc<Axes>* arc = nullptr;
    /// Indices of the first and last epoch into the epochs of `arc`.
    std::vector<EpochPair> windows;  ///< in the order of their beginning
    /// What is taken off the speed of each before they are compared, m/s; empty: nothing.
    std::vector<double> allowances_m_s;
    /// Which of them is the chosen window; empty where it is in another cluster.
    std::optional<std::size_t> chosen = std::nullopt;
};

/// What a selection rests on, and how windows were compared.
struct SelectionModels {
    EstimationModel estimated;  ///< of the trajectory that the windows were compared on
    bool by_path = false;       ///< compared by path length over time, not by displacement
    double along =
        1.0;  ///< the fitted time-correlated error along the windows, over that of all axes
    /// The time-correlated error that the certificate allows for: of this size, m, or of that with
    /// which it wanders as fast as the fitted one, with any correlation time from the one to the
    /// other, s.
    double bound_m = 0.0;
    double tau_min_s = 0.5;
    double tau_max_s = 10.0;
};

/// The errors that a draw is made with.
enum class DrawnErrors {
    fitted,  ///< as the noise model has them
    bounded  ///< with the time-correlated error at its bound, the correlation times spread over
             ///< their range
};

/// What choosing the fastest of these windows, or the one of the highest assured speed where
/// allowances are made, adds to the speed stated for it (m/s).
///
/// Where the craft is fast for longer than a window, the fastest of many windows is the one whose
/// errors point forward. How much that adds is found by doing it again: the motion through each
/// cluster, and five seconds before and after it, is estimated again with a jerk density fitted to
/// that stretch alone, errors are drawn onto it (all windows of a draw share them: their joint
/// distribution), each draw is smoothed and searched as the recording was, and the speed stated for
/// its fastest window is compared with that window's true one; what smoothing itself does to the
/// window is so part of the answer. The motion so estimated still holds some noise, which makes the
/// answer too small; the same is done from motions estimated from drawn recordings, and the
/// difference put on (a bootstrap, calibrated by a second one: [ET93] 18).
///
/// A time-correlated error of the positions looks like motion, so that the recording does not say
/// how much of it chose the window. The bias lies between that of the errors as fitted and that
/// with the time-correlated error at its bound: both are found, and the middle is the answer, with
/// half their difference as its limits.
///
/// `stated_m_s` is the speed of the chosen window, which one of the clusters has, as estimated.
/// `samples` is the number of draws for each of the two kinds of errors, at least 2. The same
/// `seed` gives the same answer, whatever the number of threads. Neither bias is below 0, and the
/// bounded one not below the fitted one. `bias_uncertainty_m_s` is the larger standard uncertainty
/// of their means, from the finite number of draws. `treatment` is left to the caller.
template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed);

}  // namespace runcert
