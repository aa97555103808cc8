#include "stages/import/csv/date_time.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/layout.h"

namespace runcert::csv {
namespace {

constexpr double least_unix_s = 315'964'800.0;   // 1980-01-06
constexpr double most_unix_s = 4'102'444'800.0;  // 2100-01-01

constexpr std::array orders{DateOrder::year_first, DateOrder::month_first, DateOrder::day_first};

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

/// The days (since 1980-01-06) that a date is in each order; nothing where it is no date.
std::array<std::optional<std::int64_t>, 3> days_of(std::string_view date) {
    std::array<std::optional<std::int64_t>, 3> days;
    const auto with_marks = parted(date);
    for (std::size_t i = 0; i < orders.size(); ++i) {
        const auto parts = with_marks ? with_marks : unparted(date, orders[i]);
        const bool by_points = with_marks && date.find('.') != std::string_view::npos;
        if (parts && !(by_points && orders[i] == DateOrder::month_first))
            days[i] = day_of(*parts, orders[i]);
    }
    return days;
}

/// Finds the order in which a table writes its dates.
class DateOrders {
  public:
    void see(std::string_view date) {
        const auto days = days_of(date);
        std::optional<std::int64_t> any;
        for (std::size_t i = 0; i < days.size(); ++i) {
            if (!days[i]) continue;
            ++count_[i];
            if (!first_[i]) first_[i] = days[i];
            differ_ = differ_ || (any && *any != *days[i]);
            any = days[i];
        }
    }

    /// The order that most of the dates can have; of several, that in which the first date is
    /// within a day of `expected`, or any where all dates are the same days. Nothing where that
    /// leaves several, or there was no date.
    std::optional<DateOrder> order(std::optional<std::int64_t> expected) const {
        const std::size_t most = *std::max_element(count_.begin(), count_.end());
        if (most == 0) return std::nullopt;
        std::optional<DateOrder> found;
        std::size_t left = 0;
        const bool several = std::count(count_.begin(), count_.end(), most) > 1 && differ_;
        for (std::size_t i = 0; i < orders.size(); ++i) {
            const bool is_it = count_[i] == most &&
                               (!several || (expected && std::abs(*first_[i] - *expected) <= 1));
            if (!is_it) continue;
            if (!found) found = orders[i];
            ++left;
        }
        return several && left != 1 ? std::nullopt : found;
    }

  private:
    std::array<std::size_t, 3> count_{};
    std::array<std::optional<std::int64_t>, 3> first_;
    bool differ_ = false;  ///< some date is another day in another order
};

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

std::string date_text(std::int64_t day) {
    return to_iso(GpsTime::from_nanoseconds(day * GpsTime::nanoseconds_per_day)).substr(0, 10);
}

/// What a date is in any order.
std::set<std::string> dates_of(std::string_view date) {
    std::set<std::string> dates;
    for (const auto& day : days_of(date))
        if (day) dates.insert(date_text(*day));
    return dates;
}

[[noreturn]] void refuse_order(const Cell& date) {
    const std::set<std::string> dates = dates_of(date.text);
    date.fail(fmt::format("the date \"{}\" may be {}, and no row shows which",
                          escape_for_message(date.text), fmt::join(dates, " or ")),
              "Write start_date in the receiver, the UTC date of the first epoch");
}

/// Date and time of day in a row; the date is empty where it has none, and the attempt's where no
/// column holds one.
std::array<Cell, 2> date_and_time(std::span<const Cell> cells, const Layout& layout,
                                  const Description& description) {
    const std::size_t time = *layout[Column::time];
    const std::size_t date = layout[Column::date].value_or(time);
    if (time >= cells.size() || date >= cells.size()) return {};
    if (description.time_format == TimeFormat::iso) return split_date_time(cells[time]);
    Cell day = cells[date];
    if (!layout[Column::date]) day.text = description.start_date;
    return {day, cells[time]};
}

/// The dates of a table's rows.
struct SeenDates {
    std::optional<Cell> first;
    DateOrders orders;
    bool iso = false;  ///< the first is ISO 8601, and no other was looked at
};

SeenDates see_dates(const Layout& layout, const Description& description,
                    const RecordingBytes& recording) {
    SeenDates seen;
    look_at_rows(layout.head, recording, [&](std::span<const Cell> cells) {
        const auto [date, time] = date_and_time(cells, layout, description);
        if (date.text.empty() || time.text.empty()) return false;
        if (!seen.first) seen.iso = is_iso(date.text, time.text);
        if (!seen.first) seen.first = date;
        seen.orders.see(date.text);
        return seen.iso;
    });
    return seen;
}

void settle_dates(Layout& layout, Description& description, const Receiver& receiver,
                  const RecordingBytes& recording) {
    const SeenDates seen = see_dates(layout, description, recording);
    if (seen.iso || !seen.first) return;
    if (description.date_order) return;
    description.date_order = seen.orders.order(attempted_day(receiver));
    if (!description.date_order && is_date(seen.first->text)) refuse_order(*seen.first);
    if (description.date_order && *description.date_order != DateOrder::year_first)
        layout.notes.push_back(fmt::format(
            "Dates were read with the {} first, as {} shows.",
            *description.date_order == DateOrder::month_first ? "month" : "day",
            seen.orders.order(std::nullopt) ? "the table" : "the attempt's start_date"));
}

void settle_unix(Layout& layout, Description& description, const RecordingBytes& recording) {
    look_at_rows(layout.head, recording, [&](std::span<const Cell> cells) {
        const std::size_t column = *layout[Column::time];
        const auto shift = column < cells.size() ? unix_shift(cells[column].text) : std::nullopt;
        description.time_shift = shift.value_or(0);
        return shift.has_value();
    });
    if (description.time_shift == 0) return;
    layout.notes.push_back(fmt::format("Times are counts of {} since 1970, as their size shows.",
                                       description.time_shift == 3   ? "milliseconds"
                                       : description.time_shift == 6 ? "microseconds"
                                                                     : "nanoseconds"));
}

}  // namespace

bool is_date(std::string_view text) {
    const auto days = days_of(text);
    return days[0] || days[1] || days[2];
}

std::array<Cell, 2> split_date_time(const Cell& cell) {
    const std::size_t end = std::min(cell.text.find_first_of("T \t"), cell.text.size());
    const std::size_t begin = std::min(
        cell.text.find_first_not_of(" \t", std::min(end + 1, cell.text.size())), cell.text.size());
    Cell date = cell, time_of_day = cell;
    date.text = cell.text.substr(0, end);
    time_of_day.text = cell.text.substr(begin);
    time_of_day.column += begin;
    return {date, time_of_day};
}

bool is_iso(std::string_view date, std::string_view time_of_day) {
    return date.size() == 10 && digits_at(date, 0, 4) && time_of_day.size() >= 8 &&
           digits_at(time_of_day, 0, 2) && time_of_day[2] == ':' && time_of_day[5] == ':' &&
           take_half_day(time_of_day) == HalfDay::none;
}

std::string_view seconds_text(std::string_view time_of_day) {
    const std::size_t end = time_of_day.find_last_of("0123456789");
    if (end == std::string_view::npos) return time_of_day;
    time_of_day = time_of_day.substr(0, end + 1);
    return time_of_day.substr(time_of_day.find_last_of(":T \t") + 1);
}

GpsTime read_date_time(const Cell& date, const Cell& time_of_day, DateOrder order, Clock clock) {
    const auto day = days_of(date.text)[static_cast<std::size_t>(order)];
    if (!day)
        date.fail(fmt::format("\"{}\" is not a date", escape_for_message(date.text)),
                  "Hand in the table as the logger wrote it, or another export");
    CalendarTime calendar =
        GpsTime::from_nanoseconds(*day * GpsTime::nanoseconds_per_day).calendar();
    std::string_view text = trim(time_of_day.text);
    if (text.ends_with('Z')) {
        if (clock != Clock::utc)
            time_of_day.fail(
                fmt::format("\"{}\" ends in Z, which is UTC, but the attempt says {} time",
                            escape_for_message(text), clock.is_gps ? "GPS" : "local"),
                "Write time_scale: utc in the receiver");
        text.remove_suffix(1);
    }
    if (!set_time_of_day(text, calendar))
        time_of_day.fail(
            fmt::format("\"{}\" is not a time of day", escape_for_message(time_of_day.text)),
            "Times are read as 13:00:00.5, 1:00:00.5 PM or 130000.5: hand in another export");
    return instant_of(calendar, clock, time_of_day);
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

std::vector<std::string> dates_in_doubt(const Receiver& receiver, const RecordingBytes& recording) {
    const Description description = describe(receiver);
    const Layout layout = read_layout(receiver, description, recording);
    if (!layout[Column::time]) return {};
    const SeenDates seen = see_dates(layout, description, recording);
    if (seen.iso || !seen.first || seen.orders.order(std::nullopt)) return {};
    const std::set<std::string> dates = dates_of(seen.first->text);
    return {dates.begin(), dates.end()};
}

void settle_times(Layout& layout, Description& description, const Receiver& receiver,
                  const RecordingBytes& recording) {
    if (!layout[Column::time]) return;
    switch (description.time_format) {
        case TimeFormat::unix:
            return settle_unix(layout, description, recording);
        case TimeFormat::iso:
        case TimeFormat::time_of_day:
            return settle_dates(layout, description, receiver, recording);
        case TimeFormat::seconds:
            if (const auto unit = unit_of_column(layout.head, *layout[Column::time]);
                unit && unit->name == "ms") {
                description.time_shift = 3;
                layout.notes.push_back("Times are counts of milliseconds, as the header says.");
            }
            break;
        case TimeFormat::seconds_of_week:
            break;
    }
}

}  // namespace runcert::csv
