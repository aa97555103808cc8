#include "motion/sections.h"

#include <algorithm>

namespace runcert {

template <int Axes>
std::vector<ArcSection> sections_of(std::span<const ArcEpoch<Axes>> epochs, double memory_s,
                                    std::size_t section_epochs) {
    constexpr std::size_t reach = 300;
    constexpr std::size_t every = 10;
    const std::size_t count = epochs.size();
    if (count <= section_epochs + section_epochs / 2) return {{0, count, 0, count}};
    std::vector<ArcSection> sections;
    for (std::size_t first = 0; first < count; first += section_epochs) {
        ArcSection section{.first = first,
                           .end = std::min(first + section_epochs, count),
                           .used_first = first - std::min(first, reach),
                           .used_end = 0};
        section.used_end = std::min(section.end + reach, count);
        const double from_s = epochs[first].time_s - memory_s;
        const double to_s = epochs[section.end - 1].time_s + memory_s;
        std::size_t& from = section.used_first;
        while (from > 0 && epochs[from - 1].time_s >= from_s)
            --from;
        from -= from % every;
        while (!epochs[from].measurement && from > 0)
            from -= every;
        std::size_t& to = section.used_end;
        while (to < count && (epochs[to - 1].time_s < to_s || !epochs[to - 1].measurement))
            ++to;
        sections.push_back(section);
    }
    return sections;
}

template std::vector<ArcSection> sections_of<1>(std::span<const ArcEpoch<1>>, double, std::size_t);
template std::vector<ArcSection> sections_of<2>(std::span<const ArcEpoch<2>>, double, std::size_t);

}  // namespace runcert
