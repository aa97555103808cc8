#include "stages/import/nmea/date.h"

#include "stages/import/clock.h"
#include "stages/import/nmea/row.h"

namespace runcert::nmea {
namespace {

constexpr std::int64_t day_ns = GpsTime::nanoseconds_per_day;

}  // namespace

std::int64_t DayCarry::days_since_first(std::int64_t time_of_day_ns) {
    if (last_ns_ && time_of_day_ns < *last_ns_ - day_ns / 2) ++days_;
    if (last_ns_ && time_of_day_ns > *last_ns_ + day_ns / 2) --days_;
    last_ns_ = time_of_day_ns;
    return days_;
}

std::optional<FirstDay> find_first_day(const RecordingBytes& recording) {
    const auto absent = [&](std::string_view what) {
        return recording.bytes.find(what) == std::string_view::npos;
    };
    if (absent("RMC,") && absent("ZDA,")) return std::nullopt;
    EpochReader epochs(recording, nullptr);
    DayCarry carry;
    std::optional<FirstDay> first;
    while (const auto epoch = epochs.next()) {
        const std::int64_t days = carry.days_since_first(epoch->time_of_day_ns);
        if (!epoch->date) continue;
        const bool fix = has_fix(*epoch);
        if (!first || fix) first = FirstDay{.day = *epoch->date - days, .without_fix = !fix};
        if (fix) break;
    }
    return first;
}

GpsTime Dating::start_of_day(std::int64_t day, const RecordingBytes& recording,
                             const RecordPlace& place) {
    if (started_day_ != day) {
        const CalendarTime midnight = GpsTime::from_nanoseconds(day * day_ns).calendar();
        start_ = instant_of_utc(midnight, recording, place);
        started_day_ = day;
    }
    return start_;
}

GpsTime Dating::instant(const Epoch& epoch, const RecordingBytes& recording) {
    const std::int64_t carried = carry_.days_since_first(epoch.time_of_day_ns);
    if (!first_) return GpsTime::from_nanoseconds(carried * day_ns + epoch.time_of_day_ns);
    const std::int64_t expected = first_->day + shift_days_ + carried;
    if (epoch.date && (first_->without_fix || has_fix(epoch)))
        shift_days_ += *epoch.date - expected;
    const std::int64_t day = first_->day + shift_days_ + carried;
    const RecordPlace place = place_of(epoch);
    const GpsTime instant =
        start_of_day(day, recording, place).plus_nanoseconds(epoch.time_of_day_ns);
    if (epoch.time_of_day_ns >= day_ns) {
        CalendarTime second_60 = GpsTime::from_nanoseconds(day * day_ns).calendar();
        second_60.hour = 23;
        second_60.minute = 59;
        second_60.second = 60;
        return instant_of_utc(second_60, recording, place)
            .plus_nanoseconds(epoch.time_of_day_ns - day_ns);
    }
    return instant;
}

}  // namespace runcert::nmea
