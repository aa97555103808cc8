#include "stages/window/instants.h"

#include <algorithm>
#include <cmath>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
std::size_t insert_instant(Arc<Axes>& arc, std::vector<ElapsedTime>& times, ElapsedTime instant) {
    const auto at = std::ranges::lower_bound(times, instant);
    const auto index = static_cast<std::size_t>(at - times.begin());
    if (at != times.end() && *at == instant) return index;
    if (index == 0 || at == times.end())
        throw Failure("window", "an end of it lies outside of its stretch",
                      "This is a fault of the program: report it with the run folder");
    ArcEpoch<Axes> epoch;
    epoch.time_s = instant.seconds();
    epoch.jerk_factor = arc.epochs[index].jerk_factor;
    arc.epochs.insert(arc.epochs.begin() + static_cast<std::ptrdiff_t>(index), epoch);
    arc.rows.insert(arc.rows.begin() + static_cast<std::ptrdiff_t>(index), arc.rows[index - 1]);
    times.insert(at, instant);
    return index;
}

/// How much later (s) the smoothed track reaches the gate's line.
double lateness_s(const Chain<2>& smoothed, std::size_t k, const SurveyedLine& gate) {
    const Eigen::Vector2d normal = along_course(gate);
    const Eigen::Vector2d position = smoothed.mean(k).head<2>();
    const Eigen::Vector2d velocity = smoothed.mean(k).segment<2>(2);
    // A slower passage is refused; the smoothed track may be slower than the one between epochs.
    const double speed_m_s = std::max(normal.dot(velocity), slowest_crossing_m_s);
    return normal.dot(gate.left - position) / speed_m_s;
}

}  // namespace

template <int Axes>
EpochPair reach_around(const Arc<Axes>& arc, EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const double from_s = epochs[window.first].time_s - margin_s;
    const double to_s = epochs[window.last].time_s + margin_s;
    std::size_t first = window.first;
    while (first > 0 && epochs[first - 1].time_s >= from_s)
        --first;
    while (!epochs[first].measurement)
        ++first;
    std::size_t last = window.last;
    while (last + 1 < epochs.size() && epochs[last + 1].time_s <= to_s)
        ++last;
    return {first, last};
}

template <int Axes>
WindowStretch<Axes> cut_stretch(const Arc<Axes>& arc, EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const auto [first, last] = reach_around(arc, window, margin_s);
    WindowStretch<Axes> stretch;
    stretch.epochs.assign(epochs.begin() + static_cast<std::ptrdiff_t>(first),
                          epochs.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    stretch.window = {window.first - first, window.last - first};
    stretch.duration_s = epochs[window.last].time_s - epochs[window.first].time_s;
    stretch.first = first;
    return stretch;
}

template <int Axes>
ArcWithInstants<Axes> with_instants(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                                    ElapsedTime start, ElapsedTime end) {
    ArcWithInstants<Axes> result{.arc = arc, .window = {}};
    std::vector<ElapsedTime> all = times;
    result.window.first = insert_instant(result.arc, all, start);
    result.window.last = insert_instant(result.arc, all, end);
    return result;
}

Eigen::Vector2d along_course(const SurveyedLine& gate) {
    const Eigen::Vector2d across = gate.right - gate.left;
    return Eigen::Vector2d(-across.y(), across.x()).normalized();
}

CrossingTimes smoothed_crossings(const Arc<2>& arc, const std::vector<ElapsedTime>& times,
                                 const EstimationModel& model, const CrossingTimes& straight,
                                 const SurveyedLine& start, const SurveyedLine& finish) {
    CrossingTimes crossings = straight;
    for (int step = 0; step < 3; ++step) {
        const ArcWithInstants<2> both = with_instants(arc, times, crossings.start, crossings.end);
        // The trajectory holds only epochs, and the line is crossed between two of them.
        const Chain<2> smoothed = Chain<2>(both.arc.epochs, model);
        const auto move = [&](ElapsedTime& instant, std::size_t k, const SurveyedLine& gate) {
            instant.nanoseconds += std::llround(1e9 * lateness_s(smoothed, k, gate));
            instant = std::clamp(instant, times.front(), times.back());
        };
        move(crossings.start, both.window.first, start);
        move(crossings.end, both.window.last, finish);
    }
    return crossings;
}

#define RUNCERT_INSTANTIATE(AXES)                                                        \
    template EpochPair reach_around<AXES>(const Arc<AXES>&, EpochPair, double);          \
    template WindowStretch<AXES> cut_stretch<AXES>(const Arc<AXES>&, EpochPair, double); \
    template ArcWithInstants<AXES> with_instants<AXES>(                                  \
        const Arc<AXES>&, const std::vector<ElapsedTime>&, ElapsedTime, ElapsedTime);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
