#pragma once

#include <optional>

#include "stages/window/best_window.h"

namespace runcert {

/// A series with running sums, so that a window's cost does not depend on its length. It refers to
/// the series, which must outlive it.
struct SummedSeries {
    const SampleSeries* samples = nullptr;
    std::size_t index = 0;          ///< of the series
    std::vector<double> path_m;     ///< path length up to the sample
    std::vector<double> speed_sum;  ///< sum of the speeds up to and including the sample; may be
                                    ///< empty

    std::size_t size() const { return samples->times.size(); }
};

/// The running sums of a series with this index.
SummedSeries summed(const SampleSeries& series, std::size_t index);

/// An instant in a series: the `fraction`, in [0, 1], of the step that follows sample `after`. At
/// the last sample the fraction is 0.
struct SeriesInstant {
    std::size_t after = 0;
    double fraction = 0.0;
};

/// Distance (m) between two positions. Without a third axis it is exactly the hypotenuse of the two
/// differences.
double distance_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b);

/// The instant at a time within the series, searched from sample `from` on.
SeriesInstant instant_at_time(const SummedSeries& series, std::int64_t time_ns, std::size_t from);

/// The last or first instant at which the path is `path_m` long (within the series), searched from
/// sample `from` on. The two differ where the craft stands still.
SeriesInstant last_instant_at_path(const SummedSeries& series, double path_m, std::size_t from);
SeriesInstant first_instant_at_path(const SummedSeries& series, double path_m, std::size_t from);

/// Time of an instant (ns), rounded to whole nanoseconds.
std::int64_t time_of(const SummedSeries& series, SeriesInstant instant);

/// Path length (m) up to an instant.
double path_at(const SummedSeries& series, SeriesInstant instant);

/// The window between two instants, with its speed. Empty if it is not allowed. Means need
/// instants at samples.
std::optional<FoundWindow> window_between(const SummedSeries& series, SeriesInstant start,
                                          SeriesInstant end, SpeedDefinition definition);

/// The window between two samples, with its speed. Empty if it is not allowed.
std::optional<FoundWindow> window_between(const SummedSeries& series, std::size_t first,
                                          std::size_t last, SpeedDefinition definition);

/// All allowed windows of a series under a rule of time, distance or alpha, in order of start.
WindowSearch windows_in(const SummedSeries& series, const WindowCriteria& rule);

/// Windows at any instant that begin at the end of a found window of this series, or end at its
/// start. Together with those that begin or end at a sample, they include the fastest that does not
/// overlap it.
WindowSearch windows_beside(const SummedSeries& series, const WindowCriteria& rule,
                            const FoundWindow& found);

}  // namespace runcert
