#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "schemas/common/table.h"
#include "schemas/profile/declared.h"

namespace runcert {

/// The samples of one arc that windows may lie in, in order of time. Optional members are either
/// empty or as long as `times`.
struct SampleSeries {
    std::vector<ElapsedTime> times;          ///< strictly increasing, at least one
    std::vector<Eigen::Vector3d> positions;  ///< m; axes that the rule does not count are zero
    std::vector<double> speeds_m_s;          ///< needed only for means
    std::vector<double> path_m;              ///< up to each sample; if empty, measured along the
                                             ///< positions
    /// Running count of obstacles. A window contains none if the counts at its ends are equal.
    std::vector<std::int64_t> obstacles;  ///< if empty, there are none
    std::vector<bool> bounds;  ///< whether a window may begin or end here; if empty, everywhere
};

/// The requirements on a window. Only the values that its kind names are used.
struct WindowCriteria {
    WindowKind kind = WindowKind::time;
    SpeedDefinition definition = SpeedDefinition::displacement;
    WindowEnds ends = WindowEnds::epochs;
    /// For time between epochs: an epoch must lie `duration_s` away to the tolerance, or no window
    /// begins.
    bool exact = false;
    double duration_s = 0.0;            ///< for time
    double duration_tolerance_s = 0.0;  ///< for time between epochs
    double nominal_interval_s = 0.0;    ///< for time between epochs
    double distance_m = 0.0;            ///< for distance and alpha
    double proximity_m = 0.0;           ///< for alpha
    double turn_deg = 0.0;              ///< for alpha
    AlphaChoice alpha = AlphaChoice::longest;
};

/// A path within this (m) of a rule's distance counts as that long, because sums of decimals are
/// not exact.
inline constexpr double path_rounding_m = 1e-6;

/// The direction of travel at a sample is that between the nearest samples before and after it that
/// are at least this far (m) away along the path. A standstill then has no direction of its own.
inline constexpr double direction_reach_m = 0.1;
/// The same where alphas of any length are looked for.
inline constexpr double any_direction_reach_m = 5.0;

/// A window that a search found.
struct FoundWindow {
    std::size_t series = 0;
    /// Enclosing samples: times[first] <= start < times[first + 1],
    /// times[last - 1] < end <= times[last].
    std::size_t first = 0;
    std::size_t last = 0;
    ElapsedTime start, end;  ///< rounded to the nanosecond
    double length_m = 0.0;   ///< by the definition; for a mean, mean speed times duration
    double speed_m_s = 0.0;  ///< length over duration, before the ends are rounded
    /// Reduction of the speed for comparisons between windows, because that much less can be
    /// claimed.
    double allowance_m_s = 0.0;

    double assured_m_s() const { return speed_m_s - allowance_m_s; }
    double duration_s() const { return end.seconds() - start.seconds(); }
};

/// The reduction of a window's speed. Infinite if no speed can be claimed.
using Allowance = std::function<double(const FoundWindow&)>;

/// The result of a search, and the number of samples and pairs of samples it examined.
struct WindowSearch {
    std::vector<FoundWindow> windows;
    std::int64_t steps = 0;
};

/// Whether the first window is preferred: the higher assured speed, or the earlier if equal.
bool preferred(const FoundWindow& one, const FoundWindow& other);

/// Whether a window between two samples contains no obstacle and may begin and end there.
bool window_allowed(const SampleSeries& series, std::size_t first, std::size_t last);

/// The fastest `count` windows that do not overlap (they may share an end), fastest first: the
/// fastest of all, then the fastest of those that do not overlap it, and so on. Of equals the
/// earlier counts. There are fewer if no more exist.
///
/// Time, between epochs: from each sample to the first at least the duration minus the tolerance
/// away, if that is less than one nominal interval beyond (`window_ends`), or within the tolerance
/// (`exact`). The speed uses the actual time between the samples. `mean_n_plus_1` is the mean of
/// all samples' speeds, `mean_n` of all but the first, which must leave two.
///
/// Time, at any instant: positions between samples are interpolated linearly. As long as neither
/// end passes a sample, the squared displacement is convex in the window's start, and the path is
/// linear. The fastest window therefore begins or ends at a sample (or at the end of a window
/// already found).
///
/// Distance, between epochs: from each sample to the first that is at least `distance_m` away by
/// path (`path_length`) or in a straight line (`displacement`). The latter is searched on up to
/// twice that much path. Distance, at any instant: exactly `distance_m` of path. Its time is linear
/// in the start's place on the path as long as neither end passes a sample.
///
/// Alpha, between epochs: to each sample from the first whose path to there is at most
/// `distance_m`, which is as long as whole samples allow (`longest`). The ends must be at most
/// `proximity_m` apart, and directions of travel at the two must differ by at least `turn_deg`. The
/// path from the beginning of the series to the window's end must be `distance_m` or more: a short
/// turn soon after the series begins is no alpha. Nor is one soon after an obstacle, because the
/// window that ends there would contain it.
///
/// Alpha, any: to each sample the fastest of all windows whose path is at most `distance_m`, with
/// the same proximity and turn, and at least twice `proximity_m`. On a shorter one the ends are
/// near one another whatever the craft does, and half a gybe at full speed would be the fastest
/// alpha: 41.3 km/h where the logger says 38.0. The directions are those over
/// `any_direction_reach_m` of path: a short window must not take the scatter of its positions for a
/// turn. Windows that take more than twice the time of `distance_m` at the speed of the fastest
/// longest alpha are not looked at: they are slower than half of it. Where a sample has no other,
/// the longest counts.
///
/// An end between samples must be enclosed by samples where a window may end. The window from the
/// first to the last enclosing sample must contain no obstacle.
///
/// The cost is linear in the samples for each of `count` windows, but for the order of instants.
/// For the straight distance, and for any alpha, a sample costs at most as many steps as there are
/// samples in `distance_m` of path (one on a straight course, for the distance).
///
/// Failure for any other rule: a mean speed other than in time between epochs, a displacement over
/// a distance or an alpha at any instant, a course (`passages`), or a length that is not positive.
std::vector<FoundWindow> best_windows(const std::vector<SampleSeries>& series,
                                      const WindowCriteria& rule, std::size_t count);

/// `best_windows`, with the number of steps it took.
WindowSearch search_windows(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                            std::size_t count);

/// The allowed windows of a search, and the best of them.
struct AllowedWindows {
    std::vector<FoundWindow> all;
    std::vector<FoundWindow> best;
};

/// All allowed windows in order of series and start, and the best `count` of them. There is one for
/// each sample at which one may begin and, at any instant, one for each at which one may end. For
/// alphas there is one for each sample at which one may end. With an allowance, the best have the
/// highest assured speeds.
AllowedWindows allowed_and_best(const std::vector<SampleSeries>& series, const WindowCriteria& rule,
                                std::size_t count, const Allowance& allowance = {});

/// Sets the allowance of each window, and removes those for which no speed can be claimed.
void make_allowances(std::vector<FoundWindow>& windows, const Allowance& allowance);

}  // namespace runcert
