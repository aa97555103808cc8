#include "stages/import/nmea/fields.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <optional>

#include "core/failure.h"
#include "core/gps_time.h"
#include "core/text.h"
#include "stages/import/day_clock.h"

namespace runcert::nmea {
namespace {

constexpr const char* as_written = "Take the recording as the receiver wrote it";

/// Nanoseconds of the decimals of a second, from their point on.
std::optional<std::int64_t> fraction_ns(std::string_view text) {
    if (text.empty()) return 0;
    if (text.front() != '.' || text.size() > 10) return std::nullopt;
    std::int64_t value = 0;
    for (std::size_t i = 1; i < 10; ++i) {
        const char c = i < text.size() ? text[i] : '0';
        if (!is_digit(c)) return std::nullopt;
        value = value * 10 + (c - '0');
    }
    return value;
}

/// The whole number and the decimals of a text of digits and one point at most.
struct Decimal {
    std::uint64_t whole = 0;
    std::uint64_t scaled_fraction = 0;  ///< in units of 1 / scale
    double scale = 1.0;
    std::uint64_t scale_integer = 1;
};

std::optional<Decimal> read_decimal(std::string_view text, std::size_t most_whole_digits) {
    /// Further decimals of a minute are less than a picometre.
    constexpr std::size_t decimals_used = 12;
    const std::size_t point = text.find('.');
    const std::string_view whole = text.substr(0, point);
    if (whole.empty() || whole.size() > most_whole_digits) return std::nullopt;
    Decimal decimal;
    for (const char c : whole) {
        if (!is_digit(c)) return std::nullopt;
        decimal.whole = decimal.whole * 10 + static_cast<std::uint64_t>(c - '0');
    }
    if (point == std::string_view::npos) return decimal;
    const std::string_view fraction = text.substr(point + 1);
    for (std::size_t i = 0; i < fraction.size(); ++i) {
        if (!is_digit(fraction[i])) return std::nullopt;
        if (i >= decimals_used) continue;
        decimal.scaled_fraction =
            decimal.scaled_fraction * 10 + static_cast<std::uint64_t>(fraction[i] - '0');
        decimal.scale_integer *= 10;
    }
    decimal.scale = static_cast<double>(decimal.scale_integer);
    return decimal;
}

[[noreturn]] void refuse_date(const Cell& cell) {
    cell.fail(fmt::format("\"{}\" is not a date", escape_for_message(cell.text)), as_written);
}

}  // namespace

std::int64_t read_time_of_day(const Cell& cell) {
    const auto hour = digits_at(cell.text, 0, 2);
    const auto minute = digits_at(cell.text, 2, 2);
    const auto second = digits_at(cell.text, 4, 2);
    const auto fraction =
        cell.text.size() >= 6 ? fraction_ns(cell.text.substr(6)) : std::optional<std::int64_t>();
    if (!hour || !minute || !second || !fraction || *hour > 23 || *minute > 59 ||
        *second > (*hour == 23 && *minute == 59 ? 60 : 59))
        cell.fail(
            fmt::format("\"{}\" is not a time of day, hhmmss.ss", escape_for_message(cell.text)),
            as_written);
    return ((*hour * 60 + *minute) * 60 + *second) * GpsTime::nanoseconds_per_second + *fraction;
}

std::int64_t read_date(const Cell& cell) {
    const auto day = digits_at(cell.text, 0, 2);
    const auto month = digits_at(cell.text, 2, 2);
    const auto year = digits_at(cell.text, 4, 2);
    if (cell.text.size() != 6 || !day || !month || !year) refuse_date(cell);
    const auto found = day_number(*year + (*year >= 80 ? 1900 : 2000), *month, *day);
    if (!found) refuse_date(cell);
    return *found;
}

std::int64_t read_date(const Cell& day, const Cell& month, const Cell& year) {
    const auto found = day_number(static_cast<int>(read_whole(year, "year", 0, 9999)),
                                  static_cast<int>(read_whole(month, "month", 0, 99)),
                                  static_cast<int>(read_whole(day, "day", 0, 99)));
    if (!found) refuse_date(year);
    return *found;
}

Angle read_angle(const Cell& cell, const Cell& hemisphere, char positive, char negative,
                 int most_degrees) {
    const auto decimal = read_decimal(cell.text, most_degrees > 90 ? 5 : 4);
    const std::uint64_t degrees = decimal ? decimal->whole / 100 : 0;
    const std::uint64_t minutes = decimal ? decimal->whole % 100 : 60;
    if (minutes >= 60 || degrees > static_cast<std::uint64_t>(most_degrees))
        cell.fail(fmt::format("\"{}\" is not an angle, degrees and minutes as {}mm.mmmm",
                              escape_for_message(cell.text), most_degrees > 90 ? "ddd" : "dd"),
                  as_written);
    const bool north_or_east = hemisphere.text.size() == 1 && hemisphere.text[0] == positive;
    if (!north_or_east && !(hemisphere.text.size() == 1 && hemisphere.text[0] == negative))
        hemisphere.fail(fmt::format("the hemisphere is \"{}\", not {} or {}",
                                    escape_for_message(hemisphere.text), positive, negative),
                        as_written);
    // A quotient of whole numbers below 2^53, where the minutes have at most eleven decimals.
    const std::uint64_t scaled_minutes =
        (degrees * 60 + minutes) * decimal->scale_integer + decimal->scaled_fraction;
    const double magnitude_deg = static_cast<double>(scaled_minutes) / (60.0 * decimal->scale);
    return Angle::from_degrees(north_or_east ? magnitude_deg : -magnitude_deg);
}

WrittenNumber WrittenNumber::times(double factor) const {
    if (!value) return {};
    return {*value * factor, step * factor};
}

WrittenNumber read_written(const Cell& cell, std::string_view meaning, double least, double most) {
    if (cell.text.empty()) return {};
    const double value = read_real(cell, meaning);
    if (!(value >= least && value <= most))
        cell.fail(fmt::format("the {} {} is not from {} to {}", meaning,
                              escape_for_message(cell.text), least, most),
                  as_written);
    constexpr std::array<double, 10> steps{1.0,  1e-1, 1e-2, 1e-3, 1e-4,
                                           1e-5, 1e-6, 1e-7, 1e-8, 1e-9};
    const std::size_t point = cell.text.find('.');
    const std::size_t decimals = point == std::string_view::npos ? 0 : cell.text.size() - point - 1;
    return {value, steps[std::min(decimals, steps.size() - 1)]};
}

const WrittenNumber& finer(const WrittenNumber& a, const WrittenNumber& b) {
    return b.step < a.step ? b : a;
}

FixType read_quality(const Cell& cell) {
    if (cell.text.empty()) return FixType::unknown;
    switch (read_whole(cell, "quality", 0, 9)) {
        case 0:
            return FixType::none;
        case 1:
        case 3:  // PPS: the precise code, without corrections
            return FixType::single;
        case 2:
            return FixType::dgps;
        case 4:
            return FixType::fixed;
        case 5:
            return FixType::float_ambiguities;
        case 6:
            return FixType::dead_reckoning;
        default:
            return FixType::unknown;
    }
}

FixType fix_of_mode(char mode) {
    switch (mode) {
        case 'N':
            return FixType::none;
        case 'A':
        case 'P':
            return FixType::single;
        case 'D':
            return FixType::dgps;
        case 'R':
            return FixType::fixed;
        case 'F':
            return FixType::float_ambiguities;
        case 'E':
            return FixType::dead_reckoning;
        default:
            return FixType::unknown;
    }
}

}  // namespace runcert::nmea
