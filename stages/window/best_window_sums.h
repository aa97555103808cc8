#pragma once

#include <optional>
#include <vector>

#include "stages/window/best_window.h"
#include "witness/certifiable.h"

namespace runcert {

/// Running sums over samples, so that the cost of a window's speed does not depend on its length.
struct SpeedSums {
    std::vector<double> path_m{};      ///< path length up to the sample
    std::vector<double> speeds_m_s{};  ///< sum of the speeds up to and including it; may be empty

    /// As `speed_of` by one of these definitions: a mean, or otherwise the path.
    double speed_m_s(EpochPair window, double duration_s, SpeedDefinition definition) const;
};

/// A series with its sums. It refers to the series, which must outlive it.
struct SummedSeries {
    const SampleSeries* samples = nullptr;
    std::size_t index = 0;  ///< of the series
    SpeedSums sums{};

    std::size_t size() const { return samples->times.size(); }
    const std::vector<double>& path_m() const { return sums.path_m; }
};

/// The running sums of a series with this index.
SummedSeries summed(const SampleSeries& series, std::size_t index);

/// A series with samples added on the straight lines between its own: at these instants, and where
/// a window of the rule ends that begins at a sample or at one of them, or begins that ends there.
SampleSeries with_instants(const SampleSeries& series, const WindowCriteria& rule,
                           const std::vector<ElapsedTime>& instants);

/// The window between two samples, with its speed. Empty if it is not allowed.
std::optional<FoundWindow> window_between(const SummedSeries& series, std::size_t first,
                                          std::size_t last, SpeedDefinition definition);

/// All allowed windows of a series under a rule of time, distance or alpha, in order of start. At
/// any instant: exactly the rule's time or distance between samples, as `with_instants` adds them.
WindowSearch windows_in(const SummedSeries& series, const WindowCriteria& rule);

}  // namespace runcert
