#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <set>
#include <string>

#include "core/text.h"
#include "stages/import/csv/layout.h"

// How the rows of a table write their times: what its first rows show.

namespace runcert::csv {
namespace {

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
        for (std::size_t i = 0; i < date_orders.size(); ++i) {
            const bool is_it = count_[i] == most &&
                               (!several || (expected && std::abs(*first_[i] - *expected) <= 1));
            if (!is_it) continue;
            if (!found) found = date_orders[i];
            ++left;
        }
        return several && left != 1 ? std::nullopt : found;
    }

  private:
    std::array<std::size_t, 3> count_{};
    std::array<std::optional<std::int64_t>, 3> first_;
    bool differ_ = false;  ///< some date is another day in another order
};

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
    visit_rows(layout.head, recording, [&](std::span<const Cell> cells) {
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

/// Whether times are counts of days: as large, and less than a minute apart.
bool settle_days(Layout& layout, Description& description, const RecordingBytes& recording) {
    std::optional<double> before;
    std::size_t close = 0, rows = 0;
    std::optional<DayCountKind> kind;
    visit_rows(layout.head, recording, [&](std::span<const Cell> cells) {
        const std::size_t column = *layout[Column::time];
        const std::string_view text = column < cells.size() ? cells[column].text : "";
        const auto found = day_count_of(text);
        if (!found || (kind && kind->name != found->name)) return true;
        kind = found;
        const double value = *parse_double(text);
        close += before && std::abs(value - *before) < 1.0 / 1440.0 ? 1 : 0;
        before = value;
        return ++rows >= 10;
    });
    if (close < 2 || close + 1 < rows) return false;
    description.days = kind;
    layout.notes.push_back(fmt::format("Times are {}, as their size shows.", kind->name));
    return true;
}

void settle_unix(Layout& layout, Description& description, const RecordingBytes& recording) {
    visit_rows(layout.head, recording, [&](std::span<const Cell> cells) {
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
            if (settle_days(layout, description, recording)) return;
            [[fallthrough]];
        case TimeFormat::time_of_day:
            return settle_dates(layout, description, receiver, recording);
        case TimeFormat::seconds:
            if (settle_days(layout, description, recording))
                layout.head.names[*layout[Column::time]].fail(
                    fmt::format("the times are {}, and the attempt describes seconds",
                                description.days->name),
                    "Write time_format: iso in the receiver, and the time_scale of these days");
            if (const auto unit =
                    unit_of_column(layout.head, *layout[Column::time], Quantity::time);
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
