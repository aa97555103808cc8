#include "stages/import/fields/date_time.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"

namespace runcert {
namespace {

constexpr double least_unix_s = 315'964'800.0;   // 1980-01-06
constexpr double most_unix_s = 4'102'444'800.0;  // 2100-01-01

/// Where year, month and day stand in an order.
std::array<std::size_t, 3> places_of(DateOrder order) {
    if (order == DateOrder::year_first) return {0, 1, 2};
    return order == DateOrder::month_first ? std::array<std::size_t, 3>{2, 0, 1}
                                           : std::array<std::size_t, 3>{2, 1, 0};
}

using Parts = std::array<std::string_view, 3>;

std::optional<Parts> parted(std::string_view date) {
    const std::size_t first = date.find_first_of("/-.");
    if (first == std::string_view::npos) return std::nullopt;
    const std::size_t second = date.find(date[first], first + 1);
    if (second == std::string_view::npos) return std::nullopt;
    return Parts{date.substr(0, first), date.substr(first + 1, second - first - 1),
                 date.substr(second + 1)};
}

/// Six or eight digits in an order.
std::optional<Parts> unparted(std::string_view date, DateOrder order) {
    if (date.size() != 6 && date.size() != 8) return std::nullopt;
    const std::size_t year = date.size() - 4;
    if (order == DateOrder::year_first)
        return Parts{date.substr(0, year), date.substr(year, 2), date.substr(year + 2)};
    return Parts{date.substr(0, 2), date.substr(2, 2), date.substr(4)};
}

std::optional<int> number_of(std::string_view digits) {
    return digits.empty() ? std::nullopt : digits_at(digits, 0, digits.size());
}

std::optional<std::int64_t> day_of(const Parts& parts, DateOrder order) {
    const auto [year_at, month_at, day_at] = places_of(order);
    const std::string_view year = parts[year_at];
    if ((year.size() != 2 && year.size() != 4) || parts[month_at].size() > 2 ||
        parts[day_at].size() > 2)
        return std::nullopt;
    const auto y = number_of(year), m = number_of(parts[month_at]), d = number_of(parts[day_at]);
    if (!y || !m || !d) return std::nullopt;
    return day_number(year.size() == 2 ? 2000 + *y : *y, *m, *d);
}

/// The month of a name of three letters or more, in English and the languages whose short names
/// differ; 0 for another word.
int month_named(std::string_view word) {
    constexpr std::array<std::string_view, 12> names{"jan ene gen",
                                                     "feb fev f\xc3\xa9v",
                                                     "mar mrz m\xc3\xa4r mrt",
                                                     "apr avr abr",
                                                     "may mai mag mei",
                                                     "jun giu",
                                                     "jul lug",
                                                     "aug ago aou ao\xc3\xbb",
                                                     "sep set",
                                                     "oct okt ott out",
                                                     "nov",
                                                     "dec dez dic d\xc3\xa9"
                                                     "c"};
    const std::string lower = lower_case(word);
    if (lower.starts_with("juin")) return 6;
    if (lower.starts_with("juil")) return 7;
    for (std::size_t month = 0; month < names.size(); ++month)
        for (std::string_view left = names[month]; !left.empty();) {
            const std::string_view name = left.substr(0, left.find(' '));
            left.remove_prefix(std::min(name.size() + 1, left.size()));
            if (lower.starts_with(name)) return static_cast<int>(month) + 1;
        }
    return 0;
}

bool is_letter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c & 0x80) != 0;
}

/// Words that may stand beside a date with its month's name.
bool says_nothing_of_date(std::string_view word) {
    const std::string lower = lower_case(word);
    for (const std::string_view day : {"mon", "tue", "wed", "thu", "fri", "sat", "sun"})
        if (lower.starts_with(day)) return true;
    return lower == "am" || lower == "pm" || lower == "gmt" || lower == "utc" || lower == "z";
}

/// The day of a date with its month's name: of the two numbers beside it one of four digits is the
/// year, else the second. Nothing for another text.
std::optional<std::int64_t> day_by_name(std::string_view text) {
    // A name has three letters at least.
    std::size_t letters = 0;
    for (std::size_t i = 0; i < text.size() && letters < 3; ++i)
        letters = is_letter(text[i]) ? letters + 1 : 0;
    if (letters < 3 || text.size() > 60) return std::nullopt;
    int month = 0;
    std::array<std::string_view, 2> numbers;
    std::size_t count = 0;
    for (std::string_view left = text; !left.empty();) {
        // Blanks part what may be a time of day or a zone from the rest.
        const std::string_view chunk = left.substr(0, left.find(' '));
        left.remove_prefix(std::min(chunk.size() + 1, left.size()));
        const bool of_time = chunk.find(':') != std::string_view::npos || chunk.starts_with('+') ||
                             chunk.starts_with('-');
        for (std::size_t at = 0; at < chunk.size() && !of_time;) {
            const std::size_t from = at;
            if (is_digit(chunk[at])) {
                while (at < chunk.size() && is_digit(chunk[at]))
                    ++at;
                if (count == 2) return std::nullopt;
                numbers[count++] = chunk.substr(from, at - from);
            } else if (is_letter(chunk[at])) {
                while (at < chunk.size() && is_letter(chunk[at]))
                    ++at;
                const std::string_view word = chunk.substr(from, at - from);
                const int named = month_named(word);
                if (named == 0 && !says_nothing_of_date(word)) return std::nullopt;
                if (named != 0 && month != 0) return std::nullopt;
                if (named != 0) month = named;
            } else {
                ++at;
            }
        }
    }
    if (month == 0 || count != 2) return std::nullopt;
    if (numbers[0].size() == 4) std::swap(numbers[0], numbers[1]);
    if (numbers[0].size() > 2 || (numbers[1].size() != 2 && numbers[1].size() != 4))
        return std::nullopt;
    const int year = *number_of(numbers[1]);
    return day_number(numbers[1].size() == 2 ? 2000 + year : year, month, *number_of(numbers[0]));
}

enum class HalfDay { none, morning, afternoon };

/// Takes AM or PM, also "p.m.", off the end.
HalfDay take_half_day(std::string_view& text) {
    std::string letters =
        lower_case(text.substr(text.size() - std::min<std::size_t>(4, text.size())));
    for (const std::string_view ending : {"a.m.", "p.m.", "am", "pm"}) {
        if (!letters.ends_with(ending)) continue;
        text.remove_suffix(ending.size());
        text = trim(text);
        return ending.front() == 'a' ? HalfDay::morning : HalfDay::afternoon;
    }
    return HalfDay::none;
}

/// Hours, minutes and seconds, as written.
std::optional<Parts> clock_parts(std::string_view text) {
    const std::size_t first = text.find(':');
    if (first == std::string_view::npos) {
        const std::size_t whole = std::min(text.find('.'), text.size());
        if (whole != 6) return std::nullopt;
        return Parts{text.substr(0, 2), text.substr(2, 2), text.substr(4)};
    }
    const std::size_t second = text.find(':', first + 1);
    if (second == std::string_view::npos)
        return Parts{text.substr(0, first), text.substr(first + 1), "0"};
    return Parts{text.substr(0, first), text.substr(first + 1, second - first - 1),
                 text.substr(second + 1)};
}

/// Fills in the time of day; false where the text is none.
bool set_time_of_day(std::string_view text, CalendarTime& calendar) {
    const HalfDay half = take_half_day(text);
    const auto parts = clock_parts(text);
    if (!parts || (*parts)[0].size() > 2 || (*parts)[1].size() != 2) return false;
    const auto hour = number_of((*parts)[0]), minute = number_of((*parts)[1]);
    const auto nanoseconds = parse_decimal_nanoseconds((*parts)[2]);
    if (!hour || !minute || !nanoseconds || *nanoseconds < 0 ||
        *nanoseconds >= 61 * GpsTime::nanoseconds_per_second)
        return false;
    if (half != HalfDay::none && (*hour < 1 || *hour > 12)) return false;
    calendar.hour =
        half == HalfDay::none ? *hour : *hour % 12 + (half == HalfDay::afternoon ? 12 : 0);
    calendar.minute = *minute;
    calendar.second = static_cast<int>(*nanoseconds / GpsTime::nanoseconds_per_second);
    calendar.nanosecond = *nanoseconds % GpsTime::nanoseconds_per_second;
    return true;
}

}  // namespace

std::array<std::optional<std::int64_t>, 3> days_of(std::string_view date) {
    std::array<std::optional<std::int64_t>, 3> days;
    if (const auto named = day_by_name(date)) {
        days.fill(named);
        return days;
    }
    const auto with_marks = parted(date);
    for (std::size_t i = 0; i < date_orders.size(); ++i) {
        const auto parts = with_marks ? with_marks : unparted(date, date_orders[i]);
        const bool by_points = with_marks && date.find('.') != std::string_view::npos;
        if (parts && !(by_points && date_orders[i] == DateOrder::month_first))
            days[i] = day_of(*parts, date_orders[i]);
    }
    return days;
}

bool is_date(std::string_view text) {
    const auto days = days_of(text);
    return days[0] || days[1] || days[2];
}

std::array<Cell, 2> split_date_time(const Cell& cell) {
    Cell date = cell, time_of_day = cell;
    const auto part = [&](std::size_t begin, std::size_t end) {
        time_of_day.text = trim(cell.text.substr(begin, end - begin));
        time_of_day.column += begin;
    };
    const std::size_t colon = cell.text.find(':');
    if (day_by_name(cell.text)) {
        if (colon == std::string_view::npos)
            return {date, Cell{{}, cell.recording, cell.line, cell.column}};
        const std::size_t begin = cell.text.find_last_of(" \t", colon) + 1;
        // Behind it a year may stand: four digits without a sign.
        std::size_t end = cell.text.size();
        const std::size_t blank = cell.text.find_last_of(" \t");
        if (blank != std::string_view::npos && blank > colon && blank + 5 == end &&
            digits_at(cell.text, blank + 1, 4))
            end = blank;
        part(begin, end);
        return {date, time_of_day};
    }
    const std::size_t end = std::min(cell.text.find_first_of("T \t"), cell.text.size());
    date.text = cell.text.substr(0, end);
    part(std::min(cell.text.find_first_not_of(" \t", std::min(end + 1, cell.text.size())),
                  cell.text.size()),
         cell.text.size());
    return {date, time_of_day};
}

bool is_iso(std::string_view date, std::string_view time_of_day) {
    return date.size() == 10 && digits_at(date, 0, 4) && time_of_day.size() >= 8 &&
           digits_at(time_of_day, 0, 2) && time_of_day[2] == ':' && time_of_day[5] == ':' &&
           take_half_day(time_of_day) == HalfDay::none;
}

std::string_view seconds_text(std::string_view text) {
    if (const auto zone = zone_of(text)) text = text.substr(0, zone->begin);
    const std::size_t colon = text.find_last_of(':');
    if (colon != std::string_view::npos)
        text.remove_prefix(colon + 1);
    else if (const std::size_t blank = text.find_last_of("T \t"); blank != std::string_view::npos)
        text.remove_prefix(blank + 1);
    const std::size_t end = text.find_first_not_of("0123456789.");
    return text.substr(0, end);
}

GpsTime read_date_time(const Cell& date, const Cell& time_of_day, DateOrder order, Clock clock) {
    const auto day = days_of(date.text)[static_cast<std::size_t>(order)];
    if (!day)
        date.fail(fmt::format("\"{}\" is not a date", escape_for_message(date.text)),
                  "Hand in the table as the logger wrote it, or another export");
    CalendarTime calendar =
        GpsTime::from_nanoseconds(*day * GpsTime::nanoseconds_per_day).calendar();
    std::string_view text = trim(time_of_day.text);
    const Clock shown = clock_at(time_of_day, clock, text);
    if (!set_time_of_day(text, calendar))
        time_of_day.fail(
            fmt::format("\"{}\" is not a time of day", escape_for_message(time_of_day.text)),
            "Times are read as 13:00:00.5, 1:00:00.5 PM or 130000.5: hand in another export");
    return instant_of(calendar, shown, time_of_day);
}

std::optional<int> unix_shift(std::string_view text) {
    const auto value = parse_double(text);
    if (!value) return std::nullopt;
    for (const int shift : {0, 3, 6, 9}) {
        const double seconds = *value / std::pow(10.0, shift);
        if (seconds >= least_unix_s && seconds <= most_unix_s) return shift;
    }
    return std::nullopt;
}

std::optional<DayCountKind> day_count_of(std::string_view text) {
    constexpr double days_of_40_years = 14'611.0, from_gps_epoch = 7'300.0;  // 2000-01-01
    const std::size_t point = text.find('.');
    const auto value = parse_double(text);
    if (!value || point == std::string_view::npos || text.size() - point - 1 < 4)
        return std::nullopt;
    // Day 0 of each by days since 1980-01-06.
    for (const DayCountKind& kind :
         {DayCountKind{"days of a spreadsheet", -29'226.0},
          DayCountKind{"modified Julian days", -44'244.0},
          DayCountKind{"days of Matlab", -723'186.0}, DayCountKind{"Julian days", -2'444'244.5}}) {
        const double since_2000 = *value + kind.first_day - from_gps_epoch;
        if (since_2000 >= 0.0 && since_2000 < days_of_40_years) return kind;
    }
    return std::nullopt;
}

GpsTime read_days(const Cell& cell, const DayCountKind& kind, Clock clock) {
    // Whole days and the rest apart, so that nothing is rounded by a double of both.
    const double days = read_real(cell, "time");
    const std::size_t point = std::min(cell.text.find('.'), cell.text.size());
    const auto whole_days = parse_double(cell.text.substr(0, point));
    const auto part = parse_double("0" + std::string(cell.text.substr(point)));
    // With an exponent, or without a digit before the point, the two are not its parts.
    if (!whole_days || !part || *whole_days < 0.0 || std::abs(days - *whole_days - *part) > 1e-6)
        cell.fail(fmt::format("\"{}\" is not a count of days", escape_for_message(cell.text)),
                  "Hand in the table as the logger wrote it, or another export");
    const double whole = *whole_days, rest = *part;
    const double begin = std::floor(whole + kind.first_day);
    const double day_ns = static_cast<double>(GpsTime::nanoseconds_per_day);
    const auto in_day_ns = std::llround((rest + whole + kind.first_day - begin) * day_ns);
    return instant_of(
        GpsTime::from_nanoseconds(static_cast<std::int64_t>(begin) * GpsTime::nanoseconds_per_day)
            .plus_nanoseconds(in_day_ns)
            .calendar(),
        clock, cell);
}

}  // namespace runcert
