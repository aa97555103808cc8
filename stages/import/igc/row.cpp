#include "stages/import/igc/row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text.h"
#include "stages/import/earth.h"

namespace runcert::igc {
namespace {

/// Where the fixed part of a B record has its fields, counted from 0.
constexpr std::size_t time_at = 1, latitude_at = 7, longitude_at = 15, validity_at = 24,
                      gnss_altitude_at = 30, altitude_size = 5;

/// A circular normal error is within sqrt(-2 ln(1 - p)) standard deviations with probability p,
/// here erf(sqrt 2) = 95.45 %: "EPE figure in metres for the individual fix concerned, to a 2-sigma
/// (95.45%) probability" (Technical Specification, appendix A, FXA).
const double radius_of_2_sigma = std::sqrt(-2.0 * std::log(std::erfc(std::sqrt(2.0))));

constexpr std::string_view take_whole = "Take the recording as the flight recorder wrote it";

constexpr std::array<std::int64_t, 10> powers_of_ten{
    1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};

bool are_digits(std::string_view text) {
    for (const char c : text)
        if (!is_digit(c)) return false;
    return true;
}

/// The number of at most nine digits.
std::int64_t digits(const Cell& record, std::size_t at, std::size_t size,
                    std::string_view meaning) {
    std::int64_t value = 0;
    for (std::size_t i = at; i < at + size; ++i) {
        if (i >= record.text.size() || !is_digit(record.text[i])) {
            Cell cell = record;
            cell.column += at;
            cell.fail(fmt::format("the {} \"{}\" is not {} digits", meaning,
                                  escape_for_message(
                                      record.text.substr(std::min(at, record.text.size()), size)),
                                  size),
                      std::string(take_whole));
        }
        value = value * 10 + (record.text[i] - '0');
    }
    return value;
}

/// A number whose first `whole` digits stand before the decimal point: some recorders write more of
/// them than the specification has. Nothing where it is not recorded, or blank.
std::optional<double> extension(const Cell& record, const Layout& layout, Extension which,
                                std::size_t whole, std::string_view meaning) {
    const Layout::Span& span = layout.of(which);
    if (span.size == 0) return std::nullopt;
    const std::string_view text =
        record.text.substr(std::min(span.begin, record.text.size()), span.size);
    if (trim(text).empty() || text.find_first_not_of('-') == std::string_view::npos)
        return std::nullopt;
    const std::int64_t value = digits(record, span.begin, span.size, meaning);
    const std::size_t decimals = span.size > whole ? span.size - whole : 0;
    return static_cast<double>(value) / static_cast<double>(powers_of_ten[decimals]);
}

/// An accuracy; nothing where it is zero or its digits are all nines, which mean not known.
std::optional<double> accuracy_m(const Cell& record, const Layout& layout, Extension which,
                                 std::string_view meaning) {
    const auto value = extension(record, layout, which, 3, meaning);
    const Layout::Span& span = layout.of(which);
    if (!value || *value == 0.0 ||
        record.text.substr(span.begin, span.size).find_first_not_of('9') == std::string_view::npos)
        return std::nullopt;
    return value;
}

/// An angle of `degrees` digits, five of minutes times 1000, further decimals, and its hemisphere.
struct Coordinate {
    double degrees = 0.0;
    std::size_t decimals = 3;  ///< of the minutes
};

Coordinate read_coordinate(const Cell& record, std::size_t at, std::size_t degree_digits,
                           const Layout::Span& more, char negative, std::string_view meaning) {
    const std::int64_t whole = digits(record, at, degree_digits, meaning);
    const std::int64_t minutes = digits(record, at + degree_digits, 5, meaning);
    if (minutes >= 60'000) {
        Cell cell = record;
        cell.column += at + degree_digits;
        cell.fail(fmt::format("the {} has {} thousandths of minutes", meaning, minutes),
                  std::string(take_whole));
    }
    const std::int64_t further =
        more.size == 0 ? 0 : digits(record, more.begin, more.size, meaning);
    const std::int64_t scale = powers_of_ten[more.size];
    const double in_minutes =
        static_cast<double>(minutes * scale + further) / (1000.0 * static_cast<double>(scale));
    const double angle = static_cast<double>(whole) + in_minutes / 60.0;
    return {record.text[at + degree_digits + 5] == negative ? -angle : angle, 3 + more.size};
}

/// The GNSS altitude, which may be negative ("-0012").
double read_altitude(const Cell& record) {
    const bool negative = record.text[gnss_altitude_at] == '-';
    const auto value =
        static_cast<double>(digits(record, gnss_altitude_at + (negative ? 1 : 0),
                                   altitude_size - (negative ? 1 : 0), "GNSS altitude"));
    return negative ? -value : value;
}

/// A number written with so many decimals: all that WrittenCells looks at.
std::string_view written_with(std::size_t decimals) {
    constexpr std::string_view pattern = "0.0000000000000";
    return pattern.substr(0, decimals == 0 ? 1 : 2 + std::min(decimals, pattern.size() - 2));
}

void read_accuracy(const Cell& record, const Layout& layout, Observation& row) {
    const auto radius_m = accuracy_m(record, layout, Extension::fix_accuracy, "fix accuracy");
    if (radius_m) row.sigma_east_m = row.sigma_north_m = *radius_m / radius_of_2_sigma;
    const auto vertical_m =
        accuracy_m(record, layout, Extension::vertical_accuracy, "vertical accuracy");
    if (vertical_m && row.height_m) row.sigma_up_m = *vertical_m / 2.0;
}

void read_velocity(const Cell& record, const Layout& layout, Observation& row) {
    const auto speed_kmh = extension(record, layout, Extension::speed, 3, "ground speed");
    const auto track_deg = extension(record, layout, Extension::track, 3, "true track");
    if (speed_kmh) set_speed(row, *speed_kmh / 3.6, course_of(track_deg));
}

}  // namespace

bool is_fix(std::string_view line) {
    if (line.size() < Layout{}.record_bytes || line[0] != 'B') return false;
    const auto one_of = [&](std::size_t at, std::string_view letters) {
        return letters.find(line[at]) != std::string_view::npos;
    };
    return are_digits(line.substr(time_at, 13)) && one_of(14, "NS") &&
           are_digits(line.substr(longitude_at, 8)) && one_of(23, "EW") &&
           one_of(validity_at, "AV");
}

std::int64_t read_time_of_day(const Cell& record, const Layout& layout) {
    const std::int64_t hour = digits(record, time_at, 2, "hour");
    const std::int64_t minute = digits(record, time_at + 2, 2, "minute");
    const std::int64_t second = digits(record, time_at + 4, 2, "second");
    const bool leap = hour == 23 && minute == 59 && second == 60;
    if (hour > 23 || minute > 59 || (second > 59 && !leap)) {
        Cell cell = record;
        cell.column += time_at;
        cell.fail(fmt::format("\"{}\" is not a time of day",
                              escape_for_message(record.text.substr(time_at, 6))),
                  std::string(take_whole));
    }
    const Layout::Span& more = layout.of(Extension::decimal_seconds);
    const std::int64_t further =
        more.size == 0 ? 0 : digits(record, more.begin, more.size, "decimals of the second");
    return ((hour * 60 + minute) * 60 + second) * GpsTime::nanoseconds_per_second +
           further * powers_of_ten[9 - more.size];
}

TimedRow read_fix(const Cell& record, const Layout& layout, AltitudeReference reference) {
    TimedRow row;
    row.written.time = written_with(layout.of(Extension::decimal_seconds).size);
    const Coordinate latitude = read_coordinate(
        record, latitude_at, 2, layout.of(Extension::latitude_digits), 'S', "latitude");
    const Coordinate longitude = read_coordinate(
        record, longitude_at, 3, layout.of(Extension::longitude_digits), 'W', "longitude");
    const bool in_space = record.text[validity_at] == 'A';
    const auto satellites =
        extension(record, layout, Extension::satellites, 9, "satellites in use");
    if (satellites && *satellites <= 1000)
        row.observation.satellites = static_cast<std::int16_t>(*satellites);
    row.observation.fix = in_space ? FixType::single : FixType::unknown;
    if ((latitude.degrees == 0.0 && longitude.degrees == 0.0) ||
        (!in_space && satellites && *satellites < 3)) {
        row.observation.fix = FixType::none;
        return row;
    }
    const bool has_height = in_space && reference != AltitudeReference::none;
    Cell latitude_cell = record, longitude_cell = record, height_cell = record;
    latitude_cell.column += latitude_at;
    longitude_cell.column += longitude_at;
    height_cell.column += gnss_altitude_at;
    set_position(row.observation, checked_geodetic({Angle::from_degrees(latitude.degrees),
                                                    Angle::from_degrees(longitude.degrees),
                                                    has_height ? read_altitude(record) : 0.0},
                                                   latitude_cell, longitude_cell, height_cell));
    if (!has_height) row.observation.height_m.reset();
    row.written.unit = CoordinateUnit::arc_minute;
    row.written.coordinates = {written_with(latitude.decimals), written_with(longitude.decimals)};
    read_accuracy(record, layout, row.observation);
    read_velocity(record, layout, row.observation);
    return row;
}

}  // namespace runcert::igc
