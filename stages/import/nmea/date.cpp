#include "stages/import/nmea/date.h"

#include <algorithm>
#include <map>

#include "stages/import/day_clock.h"
#include "stages/import/nmea/row.h"

namespace runcert::nmea {

std::optional<FirstDay> find_first_day(const RecordingBytes& recording) {
    const auto absent = [&](std::string_view what) {
        return recording.bytes.find(what) == std::string_view::npos;
    };
    if (absent("RMC,") && absent("ZDA,")) return std::nullopt;
    EpochReader epochs(recording, nullptr);
    DayCount count;
    std::optional<FirstDay> without_fix;
    std::map<std::int64_t, int> first_days;  // by the dated epochs at midnight, which may be wrong
    while (const auto epoch = epochs.next()) {
        const std::int64_t days = count.next(epoch->time_of_day_ns);
        if (!epoch->date) continue;
        const std::int64_t first = *epoch->date - days;
        if (!has_fix(*epoch)) {
            if (!without_fix) without_fix = FirstDay{.day = first, .without_fix = true};
            continue;
        }
        if (!is_near_midnight(epoch->time_of_day_ns)) return FirstDay{.day = first};
        ++first_days[first];
    }
    if (first_days.empty()) return without_fix;
    return FirstDay{
        .day = std::max_element(first_days.begin(), first_days.end(),
                                [](const auto& a, const auto& b) { return a.second < b.second; })
                   ->first};
}

std::optional<std::int64_t> day_of(const Epoch& epoch, const std::optional<FirstDay>& first) {
    if (!epoch.date || !first || !(first->without_fix || has_fix(epoch))) return std::nullopt;
    return *epoch.date;
}

}  // namespace runcert::nmea
