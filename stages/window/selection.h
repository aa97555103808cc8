#pragma once

#include <optional>
#include <vector>

#include "schemas/windows/windows.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A window slower than the best by this many standard uncertainties could not have been the best.
inline constexpr double selection_width = 4.0;

/// A speed minus the bias (both m/s) of choosing it as the fastest, but at least 0: a standstill
/// has no speed to reduce.
double less_bias(double speed_m_s, double bias_m_s);

/// Windows of one arc (Axes 2: east and north; 1: heights alone) that could have been the best, and
/// are close enough to one another to be estimated together.
template <int Axes>
struct WindowCluster {
    const Arc<Axes>* arc = nullptr;
    /// Indices into the epochs of `arc` of each window's first and last epoch.
    std::vector<EpochPair> windows;  ///< in order of their beginning
    /// Reductions of the windows' speeds before they are compared, m/s. Empty: none.
    std::vector<double> allowances_m_s;
    /// Index of the chosen window, empty if it is in another cluster.
    std::optional<std::size_t> chosen = std::nullopt;
};

/// The models behind a selection, and how windows were compared.
struct SelectionModels {
    EstimationModel estimated;  ///< of the trajectory on which the windows were compared
    bool by_path = false;       ///< compared by path length over time, not by displacement
    double along =
        1.0;  ///< size of the fitted time-correlated error along the windows, over that of all axes
    /// The time-correlated error that the certificate allows for, with any correlation time from
    /// `tau_min_s` to `tau_max_s` (s). Its size (m) is this, or that with which it wanders as fast
    /// as the fitted one.
    double bound_m = 0.0;
    double tau_min_s = 0.5;
    double tau_max_s = 10.0;
};

/// The bias (m/s) of the stated speed that results from choosing the fastest of these windows, or
/// the one of the highest assured speed where allowances are made.
///
/// Where the craft is fast for longer than a window, the fastest of many windows is the one whose
/// errors point forward. Their speeds are weighted sums of the measured positions
/// (`Chain::weights`), so that their errors are jointly normal with covariance W R W'. Draws of
/// these are added to the velocities of the motion, which is estimated from each cluster, and five
/// seconds before and after it, with a jerk density fitted to that stretch alone. The bias is the
/// mean error of the window that is then the fastest. Of many windows at least 200 stand for all,
/// each the best of its neighbours.
///
/// The estimated motion still contains some noise, which makes the result too small. The same is
/// done from motions with drawn errors, and the difference is added (a bootstrap, calibrated by a
/// second one: [ET93] 18).
///
/// A time-correlated error of the positions resembles motion, so that the recording does not show
/// how much it influenced the choice. The bias lies between that for the errors as fitted and that
/// with the time-correlated error at its bound. Both are computed. The middle is the result, with
/// half their difference as its limits.
///
/// `stated_m_s` is the estimated speed of the chosen window, which is in one of the clusters.
/// `samples` is the number of draws for each of the two types of errors, at least 2, or 0: nothing
/// is drawn, and the bias is 0. The same `seed` gives the same result. Neither bias is below 0, and
/// the bounded one is not below the fitted one. `bias_uncertainty_m_s` is the larger standard
/// uncertainty of their means, from the finite number of draws. The caller sets `treatment`.
template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed);

}  // namespace runcert
