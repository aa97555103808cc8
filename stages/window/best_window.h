#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "schemas/common/table.h"
#include "schemas/profile/declared.h"

namespace runcert {

/// One arc that windows may lie in: its samples in order of time. What may be
/// empty is empty or as long as `times`.
struct SampleSeries {
    std::vector<ElapsedTime> times;          ///< strictly increasing, at least one
    std::vector<Eigen::Vector3d> positions;  ///< m; axes that the rule does not count are zero
    std::vector<double> speeds_m_s;          ///< needed for the means only
    std::vector<double> path_m;              ///< up to the sample; empty: along the positions
    /// Running count: a window holds no obstacle where the counts at its ends are the same.
    std::vector<std::int64_t> obstacles;  ///< empty: none
    std::vector<bool> bounds;  ///< whether a window may begin or end here; empty: everywhere
};

/// What a window must be. Of the figures, only those that the kind names are read.
struct WindowCriteria {
    WindowKind kind = WindowKind::time;
    SpeedDefinition definition = SpeedDefinition::displacement;
    WindowEnds ends = WindowEnds::epochs;
    /// Time between epochs: one must be `duration_s` away to the tolerance, or no window begins.
    bool exact = false;
    double duration_s = 0.0;            ///< time
    double duration_tolerance_s = 0.0;  ///< time between epochs
    double nominal_interval_s = 0.0;    ///< time between epochs
    double distance_m = 0.0;            ///< distance, alpha
    double proximity_m = 0.0;           ///< alpha
    double turn_deg = 0.0;              ///< alpha
};

/// A path that is as near as this (m) to a rule's distance has that length: sums of decimals
/// are not exact.
inline constexpr double path_rounding_m = 1e-6;

/// The direction of travel at a sample is that between the nearest samples before and after it
/// that are at least this far (m) away along the path, so that standing still has none of its own.
inline constexpr double direction_reach_m = 0.1;

struct FoundWindow {
    std::size_t series = 0;
    /// Samples that enclose it: times[first] <= start < times[first + 1],
    /// times[last - 1] < end <= times[last].
    std::size_t first = 0;
    std::size_t last = 0;
    ElapsedTime start, end;  ///< rounded to the nanosecond
    double length_m = 0.0;   ///< by the definition; of a mean, the mean speed times the duration
    double speed_m_s = 0.0;  ///< length over duration, before the ends are rounded
    /// What is to be taken off the speed before windows are compared: so much less can be claimed.
    double allowance_m_s = 0.0;

    double assured_m_s() const { return speed_m_s - allowance_m_s; }
};

/// What is to be taken off a window's speed; infinite where nothing can be claimed of it.
using Allowance = std::function<double(const FoundWindow&)>;

/// What a search found, and how many samples and pairs of samples it looked at.
struct WindowSearch {
    std::vector<FoundWindow> windows;
    std::int64_t steps = 0;
};

/// Whether the first window is to be preferred: the one of the higher assured speed, the earlier of
/// equals.
bool preferred(const FoundWindow& one, const FoundWindow& other);

/// Whether a window from a sample to another holds no obstacle and may begin and end there.
bool window_allowed(const SampleSeries& series, std::size_t first, std::size_t last);

/// The fastest `count` windows that do not overlap (they may share an end), fastest first: the
/// fastest of all, then the fastest of those that do not overlap it, and so on. The earlier of
/// equals; fewer where there are no more.
///
/// Time, between epochs: from each sample to the first at least the duration less the tolerance
/// away, where it is less than one nominal interval beyond (`window_ends`), or within the
/// tolerance (`exact`). Speed over the time that really passed; `mean_n_plus_1` is the mean of all
/// samples' speeds, `mean_n` of all but the first.
///
/// Time, at any instant: positions between samples are interpolated linearly. The square of the
/// displacement is then convex in the window's start, and the path linear, as long as neither end
/// passes a sample: the fastest window begins or ends at one (or at the end of one already found).
///
/// Distance, between epochs: from each sample to the first that the path (`path_length`) or the
/// straight distance (`displacement`) puts at least `distance_m` away; the latter is looked for on
/// up to twice that much path. Distance, at any instant: exactly `distance_m` of path; the time for
/// it is linear in the start's place on the path as long as neither end passes a sample.
///
/// Alpha, between epochs: to each sample from the first whose path to there is at most
/// `distance_m`, so that it is as long as whole samples allow; the ends at most `proximity_m` from
/// one another, and directions of travel at the two that differ by at least `turn_deg`. The path up
/// to its end must be `distance_m` or more: a short turn soon after the series begins is no alpha.
/// Nor is one soon after an obstacle, as the window that ends there would hold it.
///
/// An end between samples must be enclosed by samples where a window may end, and the window from
/// the enclosing first to the enclosing last must hold no obstacle.
///
/// Linear in the samples for each of the count. For the straight distance a sample costs at most as
/// many steps as there are samples in `distance_m` of path (one on a straight course).
///
/// Failure where the rule is none of these: a mean speed elsewhere than in time between epochs, a
/// displacement over a distance or an alpha at any instant, a course (`passages`), or a length
/// that is not positive.
std::vector<FoundWindow> best_windows(const std::vector<SampleSeries>& series,
                                      const WindowCriteria& rule, std::size_t count);

/// The same, with the steps it took.
WindowSearch search_windows(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                            std::size_t count);

/// All allowed windows in order of series and start: one for each sample that one may begin at, and
/// at any instant one for each that one may end at; of alphas one for each sample that one may end
/// at. And the best of them; with an allowance those of the highest assured speeds.
struct AllowedWindows {
    std::vector<FoundWindow> all;
    std::vector<FoundWindow> best;
};
AllowedWindows allowed_and_best(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                                std::size_t count, const Allowance& allowance = {});

/// Sets the allowance of each window, and removes those of which nothing can be claimed.
void make_allowances(std::vector<FoundWindow>& windows, const Allowance& allowance);

}  // namespace runcert
