#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "core/random.h"
#include "motion/chain.h"
#include "stages/window/selection.h"

namespace runcert {

/// Number of drawn recordings that are smoothed and searched side by side.
inline constexpr std::size_t selection_lanes = 4;

/// The fastest window of a drawn recording, its speed in the search, and the error of its stated
/// speed.
struct FastestWindow {
    double searched_m_s = -std::numeric_limits<double>::infinity();  ///< minus its allowance
    double error_m_s = 0.0;
    double chosen_error_m_s = 0.0;  ///< of the window chosen in the recording, if it is in this
                                    ///< cluster
};

/// The result of one draw for a cluster.
struct ClusterDraw {
    FastestWindow once;   ///< errors drawn onto the estimated motion
    FastestWindow again;  ///< the same errors on a motion estimated from a drawn recording
    /// The errors of the speed stated for the chosen window if positions have no errors.
    double chosen_without_noise_once_m_s = 0.0;
    double chosen_without_noise_again_m_s = 0.0;
    double fastest_true_m_s = 0.0;  ///< with the motion estimated from a drawn recording
};

/// The measured epochs of a cluster.
template <int Axes>
struct MeasuredStretch {
    std::vector<ArcEpoch<Axes>> epochs;
    std::vector<EpochPair> windows;   ///< indices into the epochs
    std::vector<double> durations_s;  ///< of each window
    std::vector<double> allowances_m_s;
};

/// One cluster: draws errors, smooths and searches.
///
/// Everything except the search is linear. The noise is smoothed separately and added to the motion
/// and its smoothed version, which are the same in all draws.
template <int Axes>
class SelectionCluster {
  public:
    SelectionCluster(const WindowCluster<Axes>& windows, const SelectionModels& models);

    /// Number of standard normal numbers needed for a draw.
    std::size_t normals() const { return 4 * axes * stretch_.epochs.size(); }

    /// Evaluates `selection_lanes` draws at a time. `numbers[l]` are the `normals()` of draw l.
    /// `tau_s[l]` is the correlation time of its time-correlated error, where that is not the
    /// fitted one.
    std::array<ClusterDraw, selection_lanes> draw(
        const std::array<const double*, selection_lanes>& numbers,
        const std::optional<std::array<double, selection_lanes>>& tau_s) const;

  private:
    static constexpr auto axes = static_cast<std::size_t>(Axes);
    using Positions = std::vector<PositionVector<Axes>>;
    using Lanes = std::vector<LanePositions<Axes, static_cast<int>(selection_lanes)>>;
    using Lane = runcert::Lane<static_cast<int>(selection_lanes)>;

    /// A motion, and the smoother's estimate of it.
    template <class Track>
    struct Smoothed {
        Track motion;
        Track estimated;
    };
    class Speeds;
    class SlowError;

    Lanes errors(std::array<const double*, selection_lanes> numbers,
                 const std::optional<std::array<double, selection_lanes>>& tau_s) const;
    Smoothed<Positions> smoothed(const Positions& motion) const;
    std::array<FastestWindow, selection_lanes> search(const Smoothed<Lanes>& drawn) const;
    Lane chosen_errors(const Smoothed<Lanes>& drawn) const;

    MeasuredStretch<Axes> stretch_;
    std::optional<std::size_t> chosen_;
    bool by_path_;
    GaussMarkovError fitted_error_;
    double bound_m_;
    std::vector<PositionMatrix<Axes>> white_factors_;
    Chain<Axes> estimator_;
    Chain<Axes> local_;
    Smoothed<Positions> motion_;     ///< as estimated
    Smoothed<Positions> re_motion_;  ///< as estimated from that without errors
};

}  // namespace runcert
