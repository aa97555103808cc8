#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"
#include "stages/import/vbo/vbo.h"

namespace runcert::vbo {
namespace {

constexpr std::int64_t ns_per_minute = 60 * GpsTime::nanoseconds_per_second;

// What Racelogic adds to the number of satellites.
constexpr std::int64_t satellites_mask = 63;  // 64: the brake trigger is on
constexpr std::int64_t differential_mark = 128;
constexpr std::int64_t largest_mark = 255;

/// "solution type" of the VBOX manuals, from -1 on; 2 has corrections of a base station or
/// satellite.
FixType fix_of_solution(const Cell& cell) {
    constexpr FixType kinds[] = {FixType::none,
                                 FixType::none,
                                 FixType::single,
                                 FixType::dgps,
                                 FixType::float_ambiguities,
                                 FixType::fixed,
                                 FixType::unknown,
                                 FixType::dead_reckoning};
    const auto index =
        static_cast<std::size_t>(read_whole(cell, "solution type", -1, largest_mark) + 1);
    return index < std::size(kinds) ? kinds[index] : FixType::unknown;
}

void read_quality(const Row& fields, const Layout& layout, EpochQuality& quality) {
    const bool has_solution = fields.has(Column::solution_type);
    if (has_solution) quality.fix = fix_of_solution(fields.cell(Column::solution_type));
    if (!layout[Column::satellites]) return;
    const std::int64_t marked =
        read_whole(fields.cell(Column::satellites), "count of satellites", 0, largest_mark);
    quality.satellites = static_cast<std::int16_t>(marked & satellites_mask);
    if (*quality.satellites == 0 && quality.fix != FixType::dead_reckoning)
        quality.fix = FixType::none;
    else if (!has_solution && (marked & differential_mark) != 0)
        quality.fix = FixType::dgps;
}

/// From 0 to 360 degrees; loggers write some from -180 on.
std::optional<Angle> read_heading(const Row& fields) {
    if (!fields.has(Column::heading)) return std::nullopt;
    const double degrees = fields.real(Column::heading, "heading");
    if (!(std::abs(degrees) <= 360.0))
        fields.cell(Column::heading)
            .fail(fmt::format("a heading of {} degrees is impossible", degrees),
                  "Take the recording as the logger wrote it");
    return Angle::from_degrees(degrees < 0.0 ? degrees + 360.0 : degrees);
}

void read_velocity(const Row& fields, const Layout& layout, RecordedVelocity& velocity) {
    if (layout.vertical_velocity_m_s)
        velocity.recorded_velocity_up_m_s =
            fields.real(Column::vertical_velocity, "vertical velocity") *
            *layout.vertical_velocity_m_s;
    if (!layout.velocity_m_s) return;
    const double speed = fields.real(Column::velocity, "velocity");
    if (speed < 0.0)
        fields.cell(Column::velocity)
            .fail(fmt::format("a velocity of {} is impossible", speed),
                  "Take the recording as the logger wrote it");
    set_speed(velocity, speed * *layout.velocity_m_s, read_heading(fields));
}

double coordinate(const Row& fields, const Layout& layout, Column column,
                  std::string_view meaning) {
    const auto degrees = degrees_of(fields.real(column, meaning), layout.coordinates);
    if (!degrees)
        fields.cell(column).fail(fmt::format("the {} \"{}\" has 60 minutes or more", meaning,
                                             escape_for_message(fields.text(column))),
                                 "Take the recording as the logger wrote it");
    return *degrees;
}

constexpr double ns_per_hour = 3600e9;
constexpr double largest_offset_h = 14.0;
constexpr unsigned first_year = 1990;

/// The header's date and time.
struct Created {
    std::int64_t day = 0;                 ///< since 1980-01-06
    std::optional<std::int64_t> time_ns;  ///< since midnight
};

/// Takes a whole number of at most four digits off the text; nothing where none begins it.
std::optional<unsigned> take_number(std::string_view& text) {
    unsigned value = 0;
    std::size_t size = 0;
    for (; size < text.size() && size < 4 && text[size] >= '0' && text[size] <= '9'; ++size)
        value = value * 10 + static_cast<unsigned>(text[size] - '0');
    text.remove_prefix(size);
    if (size == 0) return std::nullopt;
    return value;
}

/// Drops everything before the next digit.
void skip_to_digit(std::string_view& text) {
    text.remove_prefix(std::min(text.find_first_of("0123456789"), text.size()));
}

std::optional<std::int64_t> take_time_ns(std::string_view& text) {
    std::int64_t seconds = 0;
    constexpr unsigned limits[] = {24, 60, 60};
    for (int part = 0; part < 3; ++part) {
        if (part > 0 && text.starts_with(':')) text.remove_prefix(1);
        const auto value = take_number(text);
        if (!value && part == 2) {  // "08:21"
            seconds *= 60;
            continue;
        }
        if (!value || *value >= limits[part]) return std::nullopt;
        seconds = seconds * 60 + *value;
    }
    return seconds * GpsTime::nanoseconds_per_second;
}

/// "01/08/2025 @ 14:00:12", "07/12/2014 09:02:23", "15/04/2004 at 08:21".
std::optional<Created> read_created(std::string_view text) {
    const auto day = take_number(text);
    skip_to_digit(text);
    const auto month = take_number(text);
    skip_to_digit(text);
    const auto year = take_number(text);
    if (!day || !month || !year || *year < first_year) return std::nullopt;
    const auto date =
        day_number(static_cast<int>(*year), static_cast<int>(*month), static_cast<int>(*day));
    if (!date) return std::nullopt;
    skip_to_digit(text);
    return Created{*date, take_time_ns(text)};
}

std::string to_text(std::int64_t day) {
    const CalendarTime date =
        GpsTime::from_nanoseconds(day * GpsTime::nanoseconds_per_day).calendar();
    return fmt::format("{:04}-{:02}-{:02}", date.year, date.month, date.day);
}

/// "5 h behind", "10 h 30 min ahead of" UTC, to the quarter of an hour.
std::string offset_text(double offset_h) {
    const auto quarters = static_cast<int>(std::lround(std::abs(offset_h) * 4.0));
    if (quarters == 0) return "equal to";
    const std::string minutes =
        quarters % 4 == 0 ? std::string() : fmt::format(" {} min", quarters % 4 * 15);
    return fmt::format("about {} h{} {}", quarters / 4, minutes,
                       offset_h < 0.0 ? "behind" : "ahead of");
}

FirstDay by_created(const Receiver& receiver, const Created& created, std::string_view text,
                    std::int64_t time_of_day_ns, std::optional<double> longitude_deg) {
    const double expected_h =
        receiver.utc_offset_h.value_or(longitude_deg ? *longitude_deg / 15.0 : 0.0);
    if (!created.time_ns)
        return {created.day, fmt::format("The recording gives times of day in UTC; its date is "
                                         "that of its header (\"{}\").",
                                         escape_for_message(text))};
    FirstDay best;
    double best_h = 0.0, least_h = std::numeric_limits<double>::infinity();
    for (const int shift : {0, -1, 1}) {
        const double offset_h =
            static_cast<double>(*created.time_ns - time_of_day_ns) / ns_per_hour - 24.0 * shift;
        if (std::abs(offset_h) > largest_offset_h || std::abs(offset_h - expected_h) >= least_h)
            continue;
        least_h = std::abs(offset_h - expected_h);
        best_h = offset_h;
        best.utc = created.day + shift;
    }
    best.note = fmt::format(
        "The recording gives times of day in UTC, and in its header the local date and time at "
        "which it was begun (\"{}\"): its first epoch is taken to be on {}, UTC, local time being "
        "{} UTC.",
        escape_for_message(text), to_text(*best.utc), offset_text(best_h));
    return best;
}

/// The UTC day by which a time of day is nearest to an instant.
std::int64_t day_nearest_to(GpsTime instant, std::int64_t time_of_day_ns) {
    const CalendarTime utc = utc_from_gps(instant).time;
    DayCount count;
    count.next((std::int64_t{3600} * utc.hour + std::int64_t{60} * utc.minute + utc.second) *
               GpsTime::nanoseconds_per_second);
    return *day_number(utc.year, utc.month, utc.day) + count.next(time_of_day_ns);
}

}  // namespace

std::optional<std::int64_t> time_of_day_ns(std::string_view text) {
    std::array<char, 6> digits{'0', '0', '0', '0', '0', '0'};
    const std::size_t point = std::min(text.find('.'), text.size());
    std::size_t left = digits.size();
    const bool colons = point == 8 && text[2] == ':' && text[5] == ':';
    for (std::size_t i = point; i-- > 0;) {
        if (colons && (i == 2 || i == 5)) continue;
        if (text[i] < '0' || text[i] > '9' || left == 0) return std::nullopt;
        digits[--left] = text[i];
    }
    if (point == 0) return std::nullopt;
    const auto pair = [&](std::size_t at) {
        return std::int64_t{10} * (digits[at] - '0') + (digits[at + 1] - '0');
    };
    const std::int64_t hour = pair(0), minute = pair(2), second = pair(4);
    const bool end_of_day = hour == 23 && minute == 59;
    if (hour > 23 || minute > 59 || second > (end_of_day ? 60 : 59)) return std::nullopt;
    std::int64_t fraction_ns = 0;
    if (point < text.size()) {
        const std::string_view decimals = text.substr(point);
        const auto value = decimals.size() == 1 ? 0 : parse_decimal_nanoseconds(decimals);
        if (!value) return std::nullopt;
        fraction_ns = *value;
    }
    return (60 * hour + minute) * ns_per_minute + second * GpsTime::nanoseconds_per_second +
           fraction_ns;
}

TimedRow read_row(const Row& fields, const Layout& layout, bool east_positive) {
    TimedRow row;
    row.written.time = fields.text(Column::time);
    read_quality(fields, layout, row.observation);
    if (row.observation.fix == FixType::none) return row;
    const double latitude_deg = coordinate(fields, layout, Column::latitude, "latitude");
    const double longitude_deg =
        (east_positive ? 1.0 : -1.0) * coordinate(fields, layout, Column::longitude, "longitude");
    if (latitude_deg == 0.0 && longitude_deg == 0.0) {
        row.observation.fix = FixType::none;
        return row;
    }
    const bool has_height = fields.has(Column::height);
    const Geodetic position =
        checked_geodetic({.latitude = Angle::from_degrees(latitude_deg),
                          .longitude = Angle::from_degrees(longitude_deg),
                          .height_m = has_height ? fields.real(Column::height, "height") : 0.0},
                         fields.cell(Column::latitude), fields.cell(Column::longitude),
                         fields.cell(has_height ? Column::height : Column::latitude));
    set_position(row.observation, position);
    if (!has_height) row.observation.height_m.reset();
    row.written.unit = layout.coordinates == Coordinates::degrees ? CoordinateUnit::degree
                                                                  : CoordinateUnit::arc_minute;
    row.written.coordinates = {fields.text(Column::latitude), fields.text(Column::longitude)};
    read_velocity(fields, layout, row.observation);
    return row;
}

FirstDay find_first_day(const Receiver& receiver, std::string_view created_text,
                        std::int64_t time_of_day_ns, std::optional<double> longitude_deg) {
    if (const auto start = attempted_day(receiver))
        return {start, "The date of the first epoch is the attempt's start_date."};
    if (const auto created = read_created(created_text))
        return by_created(receiver, *created, created_text, time_of_day_ns, longitude_deg);
    const std::string no_date =
        created_text.empty()
            ? "The recording gives times of day and no date"
            : fmt::format(
                  "The recording gives times of day, and the date in its header (\"{}\") "
                  "is not written as 31/12/2023 12:30:00",
                  escape_for_message(created_text));
    if (receiver.start_gps)
        return {.utc = day_nearest_to(*receiver.start_gps, time_of_day_ns),
                .note = no_date + "; the date is that of the attempt's start_gps.",
                .by_start_gps = true};
    return {std::nullopt, no_date +
                              ": its time is relative until start_date in the receiver says "
                              "the UTC date of the first epoch."};
}

}  // namespace runcert::vbo
