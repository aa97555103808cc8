#include "stages/window/speed_by_definition.h"

namespace runcert {

WindowStretch cut_stretch(const Arc<2>& arc, EpochPair window, double margin_s) {
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
    WindowStretch stretch;
    stretch.epochs.assign(epochs.begin() + static_cast<std::ptrdiff_t>(first),
                          epochs.begin() + static_cast<std::ptrdiff_t>(last) + 1);
    stretch.window = {window.first - first, window.last - first};
    stretch.duration_s = epochs[window.last].time_s - epochs[window.first].time_s;
    stretch.first = first;
    return stretch;
}

SpeedEstimate speed_by_definition(const SmoothedArc<2>& smoothed, EpochPair window,
                                  double duration_s, std::string_view definition) {
    if (definition == "path_length")
        return path_speed(smoothed, window.first, window.last, duration_s);
    if (definition == "mean_n_plus_1") return mean_speed(smoothed, window.first, window.last);
    if (definition == "mean_n") return mean_speed(smoothed, window.first + 1, window.last);
    return displacement_speed(smoothed, window.first, window.last, duration_s);
}

}  // namespace runcert
