#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "schemas/windows/windows.h"
#include "stages/window/best_window.h"
#include "witness/arcs.h"
#include "witness/certifiable.h"

namespace runcert {

/// A window slower than the best by this many standard uncertainties could not have been the best.
inline constexpr double selection_width = 4.0;

/// A speed minus the bias (both m/s) of choosing it as the fastest, but at least 0: a standstill
/// has no speed to reduce.
double less_bias(double speed_m_s, double bias_m_s);

/// Windows of one series that could have been the best. Each overlaps one before it.
struct WindowLeg {
    std::vector<FoundWindow> windows;                  ///< in order of their samples
    std::optional<std::size_t> chosen = std::nullopt;  ///< index of the chosen one, if it is here

    std::size_t series() const { return windows.front().series; }
};

/// The windows whose assured speed is at least `least_m_s`, in legs. A leg also ends where a window
/// begins more than `longest` samples, and more than one window, after the first.
std::vector<WindowLeg> legs_of(const std::vector<FoundWindow>& all, const FoundWindow& chosen,
                               double least_m_s,
                               std::size_t longest = std::numeric_limits<std::size_t>::max());

/// The windows of a choice, with their velocities as the recording shows them.
struct Rivals {
    int components = 1;  ///< of a velocity
    /// The components of one window after those of another.
    std::vector<double> velocities_m_s = {};
    std::vector<double> allowances_m_s = {};
    std::vector<std::size_t> legs = {};  ///< of each, in ascending order
    std::size_t chosen = 0;

    std::size_t size() const { return allowances_m_s.size(); }
};

/// What one simulated choice shows, m/s. The error of the window chosen in the recording has a mean
/// of zero over the draws, so that subtracting it makes their mean converge with fewer of them.
struct SimulatedChoice {
    double error = 0.0;       ///< of the window that is then the fastest
    double calibrated = 0.0;  ///< the bias
    double best_true = 0.0;   ///< speed of the window that is truly the fastest
};

/// Simulates the choice of the fastest of some windows, whatever source their speeds are from.
///
/// Errors are drawn onto the velocities that the recording leaves likely; the error of the window
/// that is then the fastest is the bias. What the recording shows already contains errors, which
/// separate the windows and make the result too small. The same is therefore done from velocities
/// with drawn errors, and the difference is added (a bootstrap, calibrated by a second one: [ET93]
/// 18). Legs whose fastest windows differ by no more than errors of `together_m_s` explain are
/// drawn together before: such errors would make legs like those recorded out of equal ones.
class ChoiceSimulation {
  public:
    explicit ChoiceSimulation(Rivals rivals, double together_m_s = 0.0);

    /// The components of all velocities together.
    Eigen::Index rows() const { return likely_.size(); }

    /// `errors` are those of the stated velocities, `before` others that part the windows before.
    SimulatedChoice operator()(const Eigen::VectorXd& errors, const Eigen::VectorXd& before) const;

  private:
    void draw_together(Eigen::VectorXd& velocities) const;

    Rivals rivals_;
    double together_m_s_;
    Eigen::VectorXd likely_;  ///< the velocities that the recording leaves likely
};

/// The bias between that under the least errors and that under the most, from equally many draws of
/// each. Neither is below 0, and the bounded one is not below the fitted one. Their standard
/// uncertainty is the larger one of both means. The middle is the bias, with half the difference
/// as its limits. If that is more than `widest_m_s`, the range tells nothing of where in it the
/// bias is: the bias is then the fitted one, and all of the difference its limit.
SelectionBias bias_between(const std::vector<SimulatedChoice>& least,
                           const std::vector<SimulatedChoice>& most,
                           double widest_m_s = std::numeric_limits<double>::infinity());

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
/// the one of the highest assured speed where allowances are made, by positions.
///
/// Where the craft is fast for longer than a window, the fastest of many windows is the one whose
/// errors point forward. Their speeds are weighted sums of the measured positions
/// (`Chain::weights`), so that their errors are jointly normal with covariance W R W'. Draws of
/// these are added to the velocities of the motion, which is estimated from each leg, and five
/// seconds before and after it, with a jerk density fitted to that stretch alone. Of many windows
/// at least 200 stand for all, each the best of its neighbours.
///
/// A time-correlated error of the positions resembles motion, so that the recording does not show
/// how much it influenced the choice. The bias lies between that for the errors as fitted and that
/// with the time-correlated error at its bound. Both are computed. The middle is the result, with
/// half their difference as its limits.
///
/// `arcs` are those of the windows' series. `stated_m_s` is the estimated speed of the chosen
/// window, which is in one of the legs. `samples` is the number of draws for each of the two types
/// of errors, at least 2, or 0: nothing is drawn, and the bias is 0. The same `seed` gives the same
/// result. The caller sets `treatment`.
template <int Axes>
SelectionBias selection_bias(const std::vector<Arc<Axes>>& arcs, const std::vector<WindowLeg>& legs,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed);

}  // namespace runcert
