#include "stages/import/vbo/row.h"

#include <fmt/format.h>

#include <cmath>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "stages/import/earth.h"

namespace runcert::vbo {
namespace {

constexpr std::int64_t ns_per_minute = 60 * GpsTime::nanoseconds_per_second;

// What Racelogic adds to the number of satellites.
constexpr std::int64_t satellites_mask = 63;  // 64: the brake trigger is on
constexpr std::int64_t differential_mark = 128;
constexpr std::int64_t largest_mark = 255;

/// "solution type" of the VBOX manuals.
FixType fix_of_solution(const Cell& cell) {
    switch (read_whole(cell, "solution type", -1, largest_mark)) {
        case -1:
        case 0:
            return FixType::none;
        case 1:
            return FixType::single;
        case 2:  // corrections of a base station or a satellite
            return FixType::dgps;
        case 3:
            return FixType::float_ambiguities;
        case 4:
            return FixType::fixed;
        case 6:
            return FixType::dead_reckoning;
        default:
            return FixType::unknown;
    }
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

}  // namespace runcert::vbo
