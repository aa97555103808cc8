#include "stages/import/csv/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/failure.h"
#include "core/text.h"

namespace runcert::csv {
namespace {

std::string_view word_of(Quantity quantity) {
    constexpr std::string_view words[] = {"m/s", "metres", "degrees", "seconds"};
    return words[static_cast<std::size_t>(quantity)];
}

}  // namespace

std::optional<Unit> unit_of_column(const Head& head, std::size_t column, Quantity quantity,
                                   bool by_last_words) {
    const Cell& name = head.names[column];
    if (auto unit = by_last_words ? unit_in_name(name.text, quantity)
                                  : unit_in_brackets(name.text, quantity))
        return unit;
    // "Latitude"|"Degrees"|-180.0|180.0|10, as RaceCapture writes it.
    const std::string_view bytes = name.recording->bytes;
    const auto at = static_cast<std::size_t>(name.text.data() + name.text.size() - bytes.data());
    if (constexpr std::string_view mark = "\"|\"";
        bytes.substr(std::min(at, bytes.size())).starts_with(mark)) {
        const std::string_view rest = bytes.substr(at + mark.size());
        return find_unit(rest.substr(0, rest.find('"')), quantity);
    }
    for (const std::vector<Cell>& line : head.under)
        if (column < line.size())
            if (auto unit = find_unit(line[column].text, quantity)) return unit;
    return std::nullopt;
}

void set_units(Layout& layout, const Description& description, const Receiver& receiver) {
    for (std::size_t i = 0; i < layout.place.size(); ++i) {
        const auto column = static_cast<Column>(i);
        const auto quantity = column_kinds[i].quantity;
        if (!layout.place[i] || !quantity) continue;
        // Dates and times of day have no unit, whatever a name says; that of counts is settled
        // later.
        if (column == Column::time && description.time_format != TimeFormat::seconds_of_week &&
            description.time_format != TimeFormat::seconds)
            continue;
        const Cell& name = layout.head.names[*layout.place[i]];
        std::optional<Unit> unit = unit_of_column(layout.head, *layout.place[i], *quantity);
        for (const std::vector<Cell>& line : layout.head.under)
            if (const auto below = *layout.place[i] < line.size()
                                       ? find_unit(line[*layout.place[i]].text, *quantity)
                                       : std::nullopt;
                unit && below && below->factor != unit->factor)
                line[*layout.place[i]].fail(
                    fmt::format("the unit of \"{}\" is {} by its name, and {} by the line below",
                                escape_for_message(name.text), unit->name, below->name),
                    "Hand in an export whose names and units agree");
        const std::string_view unknown = unknown_speed_unit(name.text);
        if (*quantity == Quantity::speed && !unit && !description.speed_unit && !unknown.empty())
            name.fail(fmt::format("the unit \"{}\" of the column \"{}\" is not known",
                                  escape_for_message(unknown), escape_for_message(name.text)),
                      "Units of speed that are read: m/s, km/h, kn, mph, ft/s, cm/s, mm/s; else "
                      "write speed_unit in the receiver, if it is one of its words");
        if (unit && unit->name == "ms" && description.time_format == TimeFormat::seconds) continue;
        if (unit && column_kinds[i].keeps_unit && unit->factor != 1.0)
            name.fail(
                fmt::format("the {} \"{}\" is in {}",
                            column == Column::time ? "time" : "coordinate",
                            escape_for_message(name.text), unit->name),
                fmt::format("Give the recording with {} in {}",
                            column == Column::time ? "times" : "coordinates", word_of(*quantity)));
        if (*quantity == Quantity::speed && description.speed_unit) {
            if (unit && unit->name != description.speed_unit->name)
                name.fail(fmt::format("the header says {}, and the attempt's speed_unit {}",
                                      unit->name, receiver.speed_unit),
                          "Remove speed_unit from the receiver, or write that unit");
            unit = description.speed_unit;
        }
        if ((column == Column::velocity_up || column == Column::up) && counts_down(name.text)) {
            layout.factor[i] = -1.0;
            layout.notes.push_back(fmt::format(
                "The column \"{}\" counts downwards, as its name says, and was turned upwards.",
                escape_for_message(name.text)));
        }
        if (!unit) continue;
        layout.factor[i] *= unit->factor;
        if (unit->factor != 1.0)
            layout.notes.push_back(fmt::format("The column \"{}\" is in {}, and was turned to {}.",
                                               escape_for_message(name.text), unit->name,
                                               word_of(*quantity)));
    }
}

namespace {

/// A column by its number, counted from 1.
std::optional<std::int64_t> column_number(const std::string& source) {
    const auto number = parse_integer(source);
    return number && *number >= 1 ? number : std::nullopt;
}

bool is_numbered(const Receiver& receiver) {
    return std::all_of(receiver.columns.begin(), receiver.columns.end(),
                       [](const auto& column) { return column_number(column.second).has_value(); });
}

/// Whether the cells, of a table whose columns are given by number, are a row, not names: where the
/// time should be stands a number or a date.
bool is_row(const Receiver& receiver, std::span<const Cell> cells) {
    const auto number = static_cast<std::uint64_t>(*column_number(receiver.columns.at("time")));
    if (number > cells.size()) return false;  // said later, with its remedy
    const std::string_view time = cells[number - 1].text;
    return parse_double(time) || (!time.empty() && time.front() >= '0' && time.front() <= '9');
}

/// How many of the names that the attempt gives to columns the cells have.
std::size_t names_in(const Receiver& receiver, std::span<const Cell> cells) {
    return static_cast<std::size_t>(
        std::count_if(receiver.columns.begin(), receiver.columns.end(), [&](const auto& column) {
            return std::any_of(cells.begin(), cells.end(),
                               [&](const Cell& cell) { return cell.text == trim(column.second); });
        }));
}

/// The first line that is no comment. Failure where its quotation marks do not pair.
Head first_line(const Description& description, const RecordingBytes& recording) {
    Head head;
    LineReader lines(recording.bytes);
    auto line = lines.next();
    while (line && is_skipped(*line))
        line = lines.next();
    if (!line) return head;
    head.delimiter = description.delimiter.value_or(find_delimiter(line->text));
    head.names = split(*line, recording, head.delimiter);
    head.line = line->number;
    head.first_row = line->number + 1;
    return head;
}

/// Of a table whose columns are given by number.
Head numbered_head(const Receiver& receiver, const Description& description,
                   const RecordingBytes& recording) {
    std::vector<Cell> above;
    const auto found = [&](std::span<const Cell> cells, bool comment) {
        if (comment) return false;
        if (is_row(receiver, cells)) return true;
        above.assign(cells.begin(), cells.end());
        return false;
    };
    std::optional<Head> head = find_head(recording, description.delimiter, found);
    if (!head) return first_line(description, recording);
    head->first_row = head->line;
    if (above.size() != head->names.size()) return *head;
    // A header line: its names may say units.
    head->names = std::move(above);
    head->passed_over -= head->passed_over > 0 ? 1 : 0;
    return *head;
}

/// Of a table whose columns are given by name: the line with all of them, else the first with most
/// of them, for the message.
Head named_head(const Receiver& receiver, const Description& description,
                const RecordingBytes& recording) {
    std::size_t most = 0;
    const auto all = static_cast<std::size_t>(
        std::count_if(receiver.columns.begin(), receiver.columns.end(),
                      [](const auto& column) { return !column_number(column.second); }));
    const auto has_all = [&](std::span<const Cell> cells, bool) {
        const std::size_t names = names_in(receiver, cells);
        most = std::max(most, names);
        return names >= all;
    };
    if (auto head = find_head(recording, description.delimiter, has_all)) return *head;
    if (most == 0) return first_line(description, recording);
    return *find_head(recording, description.delimiter, [&](std::span<const Cell> cells, bool) {
        return names_in(receiver, cells) == most;
    });
}

[[noreturn]] void refuse_name(const std::string& name, std::string_view meaning,
                              const std::vector<Cell>& cells) {
    std::vector<std::string_view> names;
    for (const Cell& cell : cells)
        names.push_back(cell.text);
    const bool values = std::all_of(names.begin(), names.end(), [](std::string_view text) {
        return text.empty() || parse_double(text);
    });
    if (values)
        cells.front().fail(fmt::format("there is no header line, and so no column \"{}\" (for {})",
                                       escape_for_message(name), meaning),
                           "Give the columns by number, counted from 1");
    cells.front().fail(fmt::format("the header line has no column \"{}\" (for {})",
                                   escape_for_message(name), meaning),
                       fmt::format("Did you mean \"{}\"? Write the header's name in columns",
                                   escape_for_message(nearest(name, names))));
}

/// The index of the column that the attempt names: by its name, else by its number.
std::size_t find_column(const std::string& source, std::string_view meaning,
                        const std::vector<Cell>& cells, bool has_header_line) {
    const auto is_it = [&](const Cell& cell) { return cell.text == trim(source); };
    const auto found = std::find_if(cells.begin(), cells.end(), is_it);
    if (has_header_line && found != cells.end()) {
        if (std::count_if(cells.begin(), cells.end(), is_it) > 1)
            found->fail(fmt::format("two columns have the name \"{}\" (for {})",
                                    escape_for_message(source), meaning),
                        "Give that column by its number, counted from 1");
        return static_cast<std::size_t>(found - cells.begin());
    }
    const auto number = column_number(source);
    if (!number) refuse_name(source, meaning, cells);
    if (static_cast<std::uint64_t>(*number) > cells.size())
        cells.front().fail(fmt::format("there is no column {} (for {}): the line has {}", *number,
                                       meaning, cells.size()),
                           "Columns are counted from 1: write other numbers in columns, or the "
                           "delimiter");
    return static_cast<std::size_t>(*number - 1);
}

}  // namespace

void note_head(Layout& layout) {
    const auto lines = [](std::size_t count) {
        return count == 1 ? std::string("1 line") : fmt::format("{} lines", count);
    };
    if (layout.head.passed_over > 0)
        layout.notes.push_back(fmt::format("{} above the table's header {} no part of the table.",
                                           lines(static_cast<std::size_t>(layout.head.passed_over)),
                                           layout.head.passed_over == 1 ? "is" : "are"));
    if (!layout.head.under.empty())
        layout.notes.push_back(fmt::format("{} under the table's header {} no numbers.",
                                           lines(layout.head.under.size()),
                                           layout.head.under.size() == 1 ? "holds" : "hold"));
}

Layout read_layout(const Receiver& receiver, const Description& description,
                   const RecordingBytes& recording) {
    Layout layout;
    const bool numbered = is_numbered(receiver);
    layout.head = numbered ? numbered_head(receiver, description, recording)
                           : named_head(receiver, description, recording);
    const std::vector<Cell>& cells = layout.head.names;
    layout.fields = cells.size();
    if (cells.empty()) return layout;
    for (std::size_t i = 0; i < layout.place.size(); ++i) {
        const std::string_view meaning = name_of(static_cast<Column>(i));
        const auto found = receiver.columns.find(std::string(meaning));
        if (found != receiver.columns.end())
            layout.place[i] = find_column(found->second, meaning, cells, !numbered);
    }
    layout.both_in_one =
        layout[Column::latitude] && layout[Column::latitude] == layout[Column::longitude];
    if (layout.both_in_one)
        layout.notes.push_back(
            fmt::format("The column \"{}\" holds both coordinates: latitude, then longitude.",
                        escape_for_message(cells[*layout[Column::latitude]].text)));
    if (!numbered) {
        std::vector<std::size_t> columns{*layout[Column::time]};
        for (const auto& place : layout.place)
            if (place) columns.push_back(*place);
        take_lines_under(layout.head, recording, columns);
    }
    set_units(layout, description, receiver);
    note_head(layout);
    find_beside(layout, description, recording);
    return layout;
}

}  // namespace runcert::csv
