#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/layout.h"
#include "stages/import/day_clock.h"

namespace runcert::csv {
namespace {

std::string date_text(std::int64_t day) {
    return to_iso(GpsTime::from_nanoseconds(day * GpsTime::nanoseconds_per_day)).substr(0, 10);
}

[[noreturn]] void refuse_order(const Cell& date) {
    std::set<std::string> dates;
    for (const auto& day : days_of(date.text))
        if (day) dates.insert(date_text(*day));
    date.fail(fmt::format("the date \"{}\" may be {}, and no row shows which",
                          escape_for_message(date.text), fmt::join(dates, " or ")),
              "Write start_date in the receiver, the UTC date of the first epoch");
}

/// Date and time of day in a row; the date is empty where it has none.
std::array<Cell, 2> date_and_time(std::span<const Cell> cells, const Layout& layout,
                                  TimeFormat format) {
    const std::size_t time = *layout[Column::time];
    const std::size_t date = layout[Column::date].value_or(time);
    if (time >= cells.size() || date >= cells.size()) return {};
    if (format == TimeFormat::iso) return split_date_time(cells[time]);
    return {cells[date], cells[time]};
}

void settle_dates(Layout& layout, Description& description, const Receiver& receiver,
                  const RecordingBytes& recording) {
    std::optional<Cell> first;
    DateOrders orders;
    bool iso = false;
    look_at_rows(layout.head, recording, [&](std::span<const Cell> cells) {
        const auto [date, time] = date_and_time(cells, layout, description.time_format);
        if (date.text.empty() || time.text.empty()) return false;
        if (!first) iso = is_iso(date.text, time.text);
        if (!first) first = date;
        orders.see(date.text);
        return iso;
    });
    if (iso || !first) return;
    if (description.date_order) return;
    description.date_order = orders.order(attempted_day(receiver));
    const auto days = days_of(first->text);
    if (!description.date_order && (days[0] || days[1] || days[2])) refuse_order(*first);
    if (description.date_order && *description.date_order != DateOrder::year_first)
        layout.notes.push_back(
            fmt::format("Dates were read with the {} first, as {} shows.",
                        *description.date_order == DateOrder::month_first ? "month" : "day",
                        orders.order(std::nullopt) ? "the table" : "the attempt's start_date"));
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
