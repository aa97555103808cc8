#include "stages/import/clock.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr std::int64_t unix_seconds_of_gps_epoch = 315'964'800;

/// The date of "2023-07-11", parted by one of these marks, whether it is in the calendar or not;
/// nothing for another text.
std::optional<CalendarTime> date_in(std::string_view text, std::string_view marks) {
    const auto year = digits_at(text, 0, 4), month = digits_at(text, 5, 2),
               day = digits_at(text, 8, 2);
    if (text.size() != 10 || !year || !month || !day ||
        marks.find(text[4]) == std::string_view::npos || text[7] != text[4])
        return std::nullopt;
    return CalendarTime{.year = *year, .month = *month, .day = *day};
}

void read_time_of_day(const Cell& cell, CalendarTime& calendar) {
    const std::string_view text = cell.text;
    const auto hour = digits_at(text, 0, 2);
    const auto minute = digits_at(text, 3, 2);
    std::optional<std::int64_t> nanoseconds;
    if (text.size() >= 8 && text[2] == ':' && text[5] == ':' && digits_at(text, 6, 2) &&
        (text.size() == 8 || text[8] == '.'))
        nanoseconds = parse_decimal_nanoseconds(text.substr(6));
    if (!hour || !minute || !nanoseconds)
        cell.fail(fmt::format("\"{}\" is not a time of day", escape_for_message(text)),
                  "Export times as 06:04:30.000: two digits each, at most nine decimals");
    calendar.hour = *hour;
    calendar.minute = *minute;
    calendar.second = static_cast<int>(*nanoseconds / GpsTime::nanoseconds_per_second);
    calendar.nanosecond = *nanoseconds % GpsTime::nanoseconds_per_second;
}

GpsTime instant(const CalendarTime& shown, Clock clock) {
    if (clock.is_gps) return GpsTime::from_calendar(shown);
    if (clock == Clock::utc) return gps_from_utc(shown);
    return gps_from_utc(
        GpsTime::from_calendar(shown).plus_nanoseconds(-clock.ahead_of_utc_ns).calendar());
}

GpsTime from_unix(std::int64_t nanoseconds) {
    const GpsTime shown =
        GpsTime::from_nanoseconds(nanoseconds)
            .plus_nanoseconds(-unix_seconds_of_gps_epoch * GpsTime::nanoseconds_per_second);
    return gps_from_utc(shown.calendar());
}

/// Runs a conversion; its failure is one at the cell.
template <class Conversion>
GpsTime at(const Cell& cell, Conversion conversion) {
    try {
        return conversion();
    } catch (const Failure& failure) {
        cell.fail(fmt::format("the time \"{}\" does not exist: {}", escape_for_message(cell.text),
                              failure.problem()),
                  failure.remedy());
    }
}

constexpr std::int64_t day_ns = GpsTime::nanoseconds_per_day;
constexpr std::int64_t most_days = 36'500;
constexpr std::int64_t near_midnight_ns = 60 * GpsTime::nanoseconds_per_second;

/// The letters that a time of day ends in, a name of three or more: "CET".
std::string_view last_name(std::string_view text) {
    std::size_t begin = text.size();
    while (begin > 0 && text[begin - 1] >= 'A' && text[begin - 1] <= 'Z')
        --begin;
    return text.size() - begin < 3 ? std::string_view() : text.substr(begin);
}

/// Minutes ahead of UTC, of names that stand for one zone alone; EST, CST and IST do not.
std::optional<std::int64_t> minutes_of_zone(std::string_view name) {
    struct Zone {
        std::string_view name;
        std::int64_t ahead_min;
    };
    for (const Zone& zone :
         {Zone{"UTC", 0}, {"GMT", 0},    {"WEST", 60},  {"CET", 60},   {"CEST", 120},
          {"MEZ", 60},    {"MESZ", 120}, {"EET", 120},  {"EEST", 180}, {"AWST", 480},
          {"JST", 540},   {"ACST", 570}, {"ACDT", 630}, {"AEST", 600}, {"AEDT", 660},
          {"NZST", 720},  {"NZDT", 780}, {"EDT", -240}, {"MDT", -360}, {"PDT", -420}})
        if (zone.name == name) return zone.ahead_min;
    return std::nullopt;
}

}  // namespace

std::optional<WrittenZone> zone_of(std::string_view text) {
    const std::size_t seconds = text.find(':');  // what stands before is no zone
    if (text.ends_with('Z') && text.size() > 1) return WrittenZone{text.size() - 1};
    const std::size_t sign = text.find_last_of("+-");
    std::size_t begin = text.size();
    std::int64_t ahead_min = 0;
    if (sign != std::string_view::npos && seconds != std::string_view::npos && sign > seconds &&
        text[sign - 1] != '.') {
        const std::string_view digits = text.substr(sign + 1);
        const bool colon = digits.size() == 5 && digits[2] == ':';
        const auto hours = digits_at(digits, 0, 2);
        const auto minutes =
            digits.size() == 2 ? std::optional(0) : digits_at(digits, colon ? 3 : 2, 2);
        if (!colon && digits.size() != 4 && digits.size() != 2) return std::nullopt;
        if (!hours || !minutes || *hours > 14 || *minutes > 59) return std::nullopt;
        ahead_min = (text[sign] == '-' ? -1 : 1) * (*hours * 60 + *minutes);
        begin = sign;
    }
    std::string_view head = text.substr(0, begin);
    while (head.ends_with(' '))
        head.remove_suffix(1);
    const std::string_view name = last_name(head);
    const auto of_name = minutes_of_zone(name);
    if (of_name && (*of_name == 0 || begin == text.size())) {
        begin = head.size() - name.size();
        ahead_min += *of_name;
    } else if (begin == text.size()) {
        return std::nullopt;
    }
    return WrittenZone{begin, ahead_min};
}

Clock clock_at(const Cell& time_of_day, Clock stated, std::string_view& text) {
    const auto zone = zone_of(text);
    // A sign behind the minutes begins an offset; ".-002" is a FlySight's.
    std::size_t sign = std::string_view::npos;
    const std::size_t colon = std::min(text.find(':'), text.size());
    for (std::size_t i = colon; i < text.size() && sign == std::string_view::npos; ++i)
        if (text[i] == '+' || text[i] == '-') sign = i;
    if (sign != std::string_view::npos && text[sign - 1] != '.' && (!zone || zone->begin > sign)) {
        Cell offset = time_of_day;
        offset.text = text.substr(sign);
        offset.column += sign;
        offset.fail(
            fmt::format("\"{}\" is not an offset from UTC", escape_for_message(offset.text)),
            "Offsets are read as +02:00, +0200 or Z, at most 14 hours: hand in another export");
    }
    if (const std::string_view name = last_name(text); !zone && !name.empty())
        time_of_day.fail(
            fmt::format("\"{}\" ends in \"{}\", no zone that is read, or the name of several",
                        escape_for_message(time_of_day.text), name),
            "Export the times in UTC or with their offset from it, as +02:00");
    if (!zone) return stated;
    const Clock said{false, zone->ahead_of_utc_min * 60 * GpsTime::nanoseconds_per_second};
    const bool is_z = text.ends_with('Z');
    if (stated != said && stated != Clock::utc)
        time_of_day.fail(
            fmt::format("\"{}\" ends in {}, but the attempt says {} time", escape_for_message(text),
                        is_z ? std::string("Z, which is UTC")
                             : fmt::format("its zone, \"{}\"",
                                           escape_for_message(text.substr(zone->begin))),
                        stated.is_gps ? "GPS" : "local"),
            "Write time_scale: utc in the attempt");
    text = text.substr(0, zone->begin);
    while (text.ends_with(' '))
        text.remove_suffix(1);
    return said;
}

GpsTime read_calendar(const Cell& date, const Cell& time_of_day, Clock clock) {
    auto calendar = date_in(date.text, "-/");
    if (!calendar)
        date.fail(fmt::format("\"{}\" is not a date", escape_for_message(date.text)),
                  "Export dates as 2023-07-11 or 2023/07/11: year, month, day");
    Cell shown = time_of_day;
    const Clock by = clock_at(time_of_day, clock, shown.text);
    read_time_of_day(shown, *calendar);
    return instant_of(*calendar, by, time_of_day);
}

GpsTime read_iso(const Cell& cell, Clock clock) {
    std::string_view text = cell.text;
    if (text.size() < 11 || (text[10] != 'T' && text[10] != ' '))
        cell.fail(fmt::format("\"{}\" is not a date and time", escape_for_message(text)),
                  "Export them as 2023-07-11T06:04:30.000");
    Cell date = cell, time_of_day = cell;
    date.text = text.substr(0, 10);
    time_of_day.text = text.substr(11);
    time_of_day.column += 11;
    return read_calendar(date, time_of_day, clock);
}

GpsTime read_week_time(const Cell& week, const Cell& seconds_of_week, Clock clock, int shift) {
    const auto week_number = static_cast<int>(read_whole(week, "GPS week", 0, 9999));
    const std::int64_t nanoseconds = read_nanoseconds(seconds_of_week, "time of week", shift);
    return at(seconds_of_week, [&] {
        const GpsTime shown = GpsTime::from_week(week_number, nanoseconds);
        return clock.is_gps ? shown : instant(shown.calendar(), clock);
    });
}

GpsTime instant_of_record(const RecordingBytes& recording, const RecordPlace& place,
                          const std::function<GpsTime()>& find) {
    try {
        return find();
    } catch (const Failure& failure) {
        throw Failure(place_in(recording, place),
                      fmt::format("the record's time does not exist: {}", failure.problem()),
                      "The record is damaged; take the recording as the receiver wrote it");
    }
}

GpsTime instant_of_utc(const CalendarTime& utc, const RecordingBytes& recording,
                       const RecordPlace& place) {
    return instant_of_record(recording, place, [&] { return gps_from_utc(utc); });
}

GpsTime instant_of(const CalendarTime& shown, Clock clock, const Cell& cell) {
    return at(cell, [&] { return instant(shown, clock); });
}

GpsTime read_unix(const Cell& cell, int shift) {
    const std::int64_t nanoseconds = read_nanoseconds(cell, "unix time", shift);
    return at(cell, [&] { return from_unix(nanoseconds); });
}

GpsTime instant_of_unix(std::int64_t nanoseconds, const RecordingBytes& recording,
                        const RecordPlace& place) {
    return instant_of_record(recording, place, [&] { return from_unix(nanoseconds); });
}

std::optional<std::int64_t> day_number(int year, int month, int day) {
    using namespace std::chrono;
    const year_month_day date{std::chrono::year{year} /
                              std::chrono::month{static_cast<unsigned>(month)} /
                              std::chrono::day{static_cast<unsigned>(day)}};
    if (!date.ok() || year < 1980 || year > 2200) return std::nullopt;
    constexpr sys_days gps_epoch{std::chrono::year{1980} / 1 / 6};
    return (sys_days{date} - gps_epoch).count();
}

std::optional<std::int64_t> attempted_day(const Receiver& receiver) {
    const std::string_view text = receiver.start_date;
    if (text.empty()) return std::nullopt;
    const auto date = date_in(text, "-");
    const auto found = date ? day_number(date->year, date->month, date->day) : std::nullopt;
    if (!found)
        throw Failure(receiver.place,
                      fmt::format("start_date \"{}\" is not a date", escape_for_message(text)),
                      "Write it as 2023-07-11: year, month, day");
    return found;
}

std::int64_t DayCount::next(std::int64_t time_of_day_ns) {
    if (last_ns_ && time_of_day_ns < *last_ns_ - day_ns / 2) ++days_;
    if (last_ns_ && time_of_day_ns > *last_ns_ + day_ns / 2) --days_;
    last_ns_ = time_of_day_ns;
    return days_;
}

std::optional<std::int64_t> nanoseconds_of_day(std::string_view text) {
    const auto hour = digits_at(text, 0, 2), minute = digits_at(text, 2, 2);
    const auto second = digits_at(text, 4, 2);
    if (!hour || !minute || !second || *hour > 23 || *minute > 59 ||
        *second > (*hour == 23 && *minute == 59 ? 60 : 59))
        return std::nullopt;
    const std::string_view decimals = text.substr(6);
    if (!decimals.empty() && decimals.front() != '.') return std::nullopt;
    const auto fraction_ns = decimals.size() > 1 ? parse_decimal_nanoseconds(decimals) : 0;
    if (!fraction_ns) return std::nullopt;
    return ((*hour * 60 + *minute) * 60 + *second) * GpsTime::nanoseconds_per_second + *fraction_ns;
}

bool is_near_midnight(std::int64_t time_of_day_ns) {
    return time_of_day_ns < near_midnight_ns || time_of_day_ns >= day_ns - near_midnight_ns;
}

void DayClock::set_date(std::int64_t dated, std::int64_t passed, std::int64_t time_of_day_ns) {
    const std::int64_t ahead = first_day_ ? dated - *first_day_ - passed : 0;
    const bool before_midnight = time_of_day_ns > day_ns / 2;
    if (is_near_midnight(time_of_day_ns) && ahead == (before_midnight ? 1 : -1)) return;
    first_day_ = dated - passed;
}

GpsTime DayClock::midnight_of(std::int64_t day) const {
    const GpsTime shown = GpsTime::from_nanoseconds(day * day_ns);
    return first_day_ ? gps_from_utc(shown.calendar()) : shown;
}

GpsTime DayClock::next(std::int64_t time_of_day_ns, std::optional<std::int64_t> dated) {
    DayCount count = count_;
    const std::int64_t passed = count.next(time_of_day_ns);
    if (std::abs(passed) > most_days)
        throw Failure("time", "midnight has passed more often than in a hundred years",
                      "Hand in the recording as the logger wrote it");
    if (dated) set_date(*dated, passed, time_of_day_ns);
    const std::int64_t day = first_day_.value_or(0) + passed;
    if (known_day_ != day) {
        midnight_ = midnight_of(day);
        length_ns_ = midnight_of(day + 1).nanoseconds_since(midnight_);
        known_day_ = day;
    }
    // A day without a date may have had a leap second.
    if (first_day_ && time_of_day_ns >= length_ns_)
        throw Failure("time", "that day had no second 60",
                      "The record is unreadable; hand in the recording as the logger wrote it");
    count_ = count;
    return midnight_.plus_nanoseconds(time_of_day_ns);
}

}  // namespace runcert
