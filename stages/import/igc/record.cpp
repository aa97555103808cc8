#include "stages/import/igc/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/speed_unit.h"
#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"

namespace runcert::igc {
namespace {

/// What is recorded in an extension.
struct Kind {
    std::string_view code;
    std::size_t whole;  ///< digits before the decimal point; of decimals none
    std::string_view meaning;
};

constexpr std::array<Kind, extensions> kinds{{// In the order of Extension.
                                              {"FXA", 3, "fix accuracy"},
                                              {"VXA", 3, "vertical accuracy"},
                                              {"SIU", 9, "satellites in use"},
                                              {"TDS", 0, "decimals of the second"},
                                              {"LAD", 0, "latitude"},
                                              {"LOD", 0, "longitude"},
                                              {"GSP", 3, "ground speed"},
                                              {"TRT", 3, "true track"}}};
constexpr int first_extension = 36;  ///< byte of a B record, counted from 1
constexpr int most_digits = 9;       ///< so that they are a number below 2^31

void add_extension(Layout& layout, const Cell& record, std::size_t at) {
    const auto from = digits_at(record.text, at, 2);
    const auto to = digits_at(record.text, at + 2, 2);
    const std::string_view code = record.text.substr(at + 4, 3);
    if (!from || !to || *from < first_extension || *to < *from)
        record.fail(fmt::format("\"{}\" is no place of an extension of the B records",
                                escape_for_message(record.text.substr(at, 7))),
                    take_whole);
    const auto known = std::ranges::find(kinds, code, &Kind::code);
    if (known == kinds.end()) return;
    const int size = *to - *from + 1;
    if (size > most_digits)
        record.fail(fmt::format("the extension {} has {} digits", code, size), take_whole);
    layout.spans[static_cast<std::size_t>(known - kinds.begin())] = {
        static_cast<std::size_t>(*from - 1), static_cast<std::size_t>(size)};
    layout.record_bytes = std::max(layout.record_bytes, static_cast<std::size_t>(*to));
}

/// Where the fixed part of a B record has its fields, counted from 0.
constexpr std::size_t time_at = 1, latitude_at = 7, longitude_at = 15, validity_at = 24,
                      gnss_altitude_at = 30, altitude_size = 5;

/// A circular normal error is within sqrt(-2 ln(1 - p)) standard deviations with probability p,
/// here erf(sqrt 2) = 95.45 %: "EPE figure in metres for the individual fix concerned, to a 2-sigma
/// (95.45%) probability" (Technical Specification, appendix A, FXA).
const double radius_of_2_sigma = std::sqrt(-2.0 * std::log(std::erfc(std::sqrt(2.0))));

constexpr std::array<std::int64_t, 10> powers_of_ten{
    1, 10, 100, 1'000, 10'000, 100'000, 1'000'000, 10'000'000, 100'000'000, 1'000'000'000};

bool are_digits(std::string_view text) {
    return std::ranges::all_of(text, is_digit);
}

/// The record from a byte on, counted from 0, for messages.
Cell from_byte(const Cell& record, std::size_t at) {
    Cell cell = record;
    cell.column += at;
    return cell;
}

/// The number of at most nine digits.
std::int64_t digits(const Cell& record, std::size_t at, std::size_t size,
                    std::string_view meaning) {
    std::int64_t value = 0;
    for (std::size_t i = at; i < at + size; ++i) {
        if (i >= record.text.size() || !is_digit(record.text[i]))
            from_byte(record, at)
                .fail(fmt::format("the {} \"{}\" is not {} digits", meaning,
                                  escape_for_message(
                                      record.text.substr(std::min(at, record.text.size()), size)),
                                  size),
                      take_whole);
        value = value * 10 + (record.text[i] - '0');
    }
    return value;
}

/// The number that a recorder adds to a B record; nothing where it is not recorded, or blank. Some
/// write more digits than the specification has: those behind the whole ones are decimals.
std::optional<double> extension(const Cell& record, const Layout& layout, Extension which) {
    const Layout::Span& span = layout.of(which);
    const Kind& kind = kinds[static_cast<std::size_t>(which)];
    if (span.size == 0) return std::nullopt;
    const std::string_view text =
        record.text.substr(std::min(span.begin, record.text.size()), span.size);
    if (trim(text).empty() || text.find_first_not_of('-') == std::string_view::npos)
        return std::nullopt;
    const std::int64_t value = digits(record, span.begin, span.size, kind.meaning);
    const std::size_t decimals = span.size > kind.whole ? span.size - kind.whole : 0;
    return static_cast<double>(value) / static_cast<double>(powers_of_ten[decimals]);
}

/// An accuracy; nothing where it is zero or its digits are all nines, which mean not known.
std::optional<double> accuracy_m(const Cell& record, const Layout& layout, Extension which) {
    const auto value = extension(record, layout, which);
    const Layout::Span& span = layout.of(which);
    if (!value || *value == 0.0 ||
        record.text.substr(span.begin, span.size).find_first_not_of('9') == std::string_view::npos)
        return std::nullopt;
    return value;
}

/// Further decimals of what the fixed part holds; 0 where none are recorded.
std::int64_t further_decimals(const Cell& record, const Layout& layout, Extension which) {
    const Layout::Span& span = layout.of(which);
    return span.size == 0 ? 0
                          : digits(record, span.begin, span.size,
                                   kinds[static_cast<std::size_t>(which)].meaning);
}

/// An angle of `degrees` digits, five of minutes times 1000, further decimals, and its hemisphere.
struct Coordinate {
    double degrees = 0.0;
    std::size_t decimals = 3;  ///< of the minutes
};
Coordinate read_coordinate(const Cell& record, std::size_t at, std::size_t degree_digits,
                           const Layout& layout, Extension more, char negative) {
    const std::string_view meaning = kinds[static_cast<std::size_t>(more)].meaning;
    const std::int64_t whole = digits(record, at, degree_digits, meaning);
    const std::int64_t minutes = digits(record, at + degree_digits, 5, meaning);
    if (minutes >= 60'000)
        from_byte(record, at + degree_digits)
            .fail(fmt::format("the {} has {} thousandths of minutes", meaning, minutes),
                  take_whole);
    const std::size_t decimals = layout.of(more).size;
    const std::int64_t scale = powers_of_ten[decimals];
    const double in_minutes =
        static_cast<double>(minutes * scale + further_decimals(record, layout, more)) /
        (1000.0 * static_cast<double>(scale));
    const double angle = static_cast<double>(whole) + in_minutes / 60.0;
    return {record.text[at + degree_digits + 5] == negative ? -angle : angle, 3 + decimals};
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
    const auto radius_m = accuracy_m(record, layout, Extension::fix_accuracy);
    if (radius_m) row.sigma_east_m = row.sigma_north_m = *radius_m / radius_of_2_sigma;
    const auto vertical_m = accuracy_m(record, layout, Extension::vertical_accuracy);
    if (vertical_m && row.height_m) row.sigma_up_m = *vertical_m / 2.0;
}

void read_velocity(const Cell& record, const Layout& layout, Observation& row) {
    const auto speed_kmh = extension(record, layout, Extension::speed);
    const auto track_deg = extension(record, layout, Extension::track);
    if (speed_kmh) set_speed(row, *speed_kmh / km_h_per_m_s, course_of(track_deg));
}

}  // namespace

Layout read_extensions(const Cell& record) {
    const std::string_view text = trim(record.text);
    const auto count = digits_at(text, 1, 2);
    if (!count || text.size() != 3 + 7 * static_cast<std::size_t>(*count))
        record.fail(fmt::format("the I record \"{}\" does not hold as many extensions as it says",
                                escape_for_message(text)),
                    take_whole);
    Layout layout;
    for (std::size_t at = 3; at < text.size(); at += 7)
        add_extension(layout, record, at);
    return layout;
}

std::string_view header_code(std::string_view record) {
    if (record.size() < 5 || record[0] != 'H') return {};
    return record.substr(2, 3);
}

std::string_view header_text(std::string_view record) {
    const std::size_t colon = record.find(':');
    return trim(record.substr(
        colon == std::string_view::npos ? std::min(record.size(), std::size_t{5}) : colon + 1));
}

std::optional<std::int64_t> read_date(const Cell& record) {
    if (header_code(record.text) != "DTE") return std::nullopt;
    std::string_view text = header_text(record.text);
    if (text.starts_with("DATE")) text.remove_prefix(4);
    const auto day = digits_at(text, 0, 2);
    const auto month = digits_at(text, 2, 2);
    const auto year = digits_at(text, 4, 2);
    const bool ended = text.size() == 6 || (text.size() > 6 && !is_digit(text[6]));
    const auto found = day && month && year && ended
                           ? day_number(*year + (*year >= 80 ? 1900 : 2000), *month, *day)
                           : std::nullopt;
    if (!found)
        record.fail(fmt::format("\"{}\" is not a date", escape_for_message(record.text)),
                    "Dates are written HFDTE160701 or HFDTEDATE:160701,01: day, month, year");
    return found;
}

AltitudeReference read_altitude_reference(std::string_view record) {
    const std::string_view text = header_text(record);
    if (text.starts_with("ELL")) return AltitudeReference::ellipsoid;
    if (text.starts_with("GEO") || text.starts_with("MSL")) return AltitudeReference::geoid;
    if (text.starts_with("NIL")) return AltitudeReference::none;
    return AltitudeReference::not_stated;
}

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
    const std::string_view written = record.text.substr(time_at, 6);
    const auto whole_ns = nanoseconds_of_day(written);
    if (!whole_ns)
        from_byte(record, time_at)
            .fail(fmt::format("\"{}\" is not a time of day", escape_for_message(written)),
                  take_whole);
    const Extension decimals = Extension::decimal_seconds;
    return *whole_ns +
           further_decimals(record, layout, decimals) * powers_of_ten[9 - layout.of(decimals).size];
}

TimedRow read_fix(const Cell& record, const Layout& layout, AltitudeReference reference) {
    TimedRow row;
    row.written.time = written_with(layout.of(Extension::decimal_seconds).size);
    const Coordinate latitude =
        read_coordinate(record, latitude_at, 2, layout, Extension::latitude_digits, 'S');
    const Coordinate longitude =
        read_coordinate(record, longitude_at, 3, layout, Extension::longitude_digits, 'W');
    const bool in_space = record.text[validity_at] == 'A';
    const auto satellites = extension(record, layout, Extension::satellites);
    if (satellites && *satellites <= 1000)
        row.observation.satellites = static_cast<std::int16_t>(*satellites);
    row.observation.fix = in_space ? FixType::single : FixType::unknown;
    if ((latitude.degrees == 0.0 && longitude.degrees == 0.0) ||
        (!in_space && satellites && *satellites < 3)) {
        row.observation.fix = FixType::none;
        return row;
    }
    const bool has_height = in_space && reference != AltitudeReference::none;
    set_position(row.observation,
                 checked_geodetic(
                     {Angle::from_degrees(latitude.degrees), Angle::from_degrees(longitude.degrees),
                      has_height ? read_altitude(record) : 0.0},
                     from_byte(record, latitude_at), from_byte(record, longitude_at),
                     from_byte(record, gnss_altitude_at)));
    if (!has_height) row.observation.height_m.reset();
    row.written.unit = CoordinateUnit::arc_minute;
    row.written.coordinates = {written_with(latitude.decimals), written_with(longitude.decimals)};
    read_accuracy(record, layout, row.observation);
    read_velocity(record, layout, row.observation);
    return row;
}

}  // namespace runcert::igc
