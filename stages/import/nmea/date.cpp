#include "stages/import/nmea/date.h"

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
    std::optional<FirstDay> first;
    while (const auto epoch = epochs.next()) {
        const std::int64_t days = count.next(epoch->time_of_day_ns);
        if (!epoch->date) continue;
        const bool fix = has_fix(*epoch);
        if (!first || fix) first = FirstDay{.day = *epoch->date - days, .without_fix = !fix};
        if (fix) break;
    }
    return first;
}

std::optional<std::int64_t> day_of(const Epoch& epoch, const std::optional<FirstDay>& first) {
    if (!epoch.date || !first || !(first->without_fix || has_fix(epoch))) return std::nullopt;
    return *epoch.date;
}

}  // namespace runcert::nmea
