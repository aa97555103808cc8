#include "witness/window_ends.h"

#include <cmath>

namespace runcert {

std::vector<std::optional<std::size_t>> window_ends(std::span<const ElapsedTime> times,
                                                    double duration_s, double duration_tolerance_s,
                                                    double nominal_interval_s) {
    // Whole nanoseconds, so that 3 s after 0.1 s is 3.1 s.
    const std::int64_t shortest = std::llround((duration_s - duration_tolerance_s) * 1e9);
    const std::int64_t longest = std::llround((duration_s + nominal_interval_s) * 1e9);
    std::vector<std::optional<std::size_t>> ends(times.size());
    std::size_t last = 0;
    for (std::size_t first = 0; first < times.size(); ++first) {
        while (last < times.size() && times[last].nanoseconds - times[first].nanoseconds < shortest)
            ++last;
        if (last < times.size() && times[last].nanoseconds - times[first].nanoseconds < longest)
            ends[first] = last;
    }
    return ends;
}

}  // namespace runcert
