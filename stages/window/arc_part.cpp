#include "stages/window/arc_part.h"

#include <type_traits>

namespace runcert {

template <int Axes>
ArcPart<Axes> part_around(const Arc<Axes>& arc, const std::vector<ElapsedTime>& times,
                          EpochPair window, double margin_s) {
    const auto& epochs = arc.epochs;
    const double from_s = epochs[window.first].time_s - margin_s;
    const double to_s = epochs[window.last].time_s + margin_s;
    std::size_t first = window.first;
    while (first > 0 && epochs[first - 1].time_s >= from_s)
        --first;
    while (!epochs[first].measurement)
        ++first;
    std::size_t end = window.last + 1;
    while (end < epochs.size() && epochs[end].time_s <= to_s)
        ++end;
    const auto cut = [&](const auto& all) {
        return std::remove_cvref_t<decltype(all)>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                                  all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    return {.arc = {.number = arc.number, .rows = cut(arc.rows), .epochs = cut(epochs)},
            .times = cut(times),
            .window = {window.first - first, window.last - first},
            .whole = first == 0 && end == epochs.size()};
}

template ArcPart<1> part_around<1>(const Arc<1>&, const std::vector<ElapsedTime>&, EpochPair,
                                   double);
template ArcPart<2> part_around<2>(const Arc<2>&, const std::vector<ElapsedTime>&, EpochPair,
                                   double);

}  // namespace runcert
