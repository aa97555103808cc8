#include "stages/import/csv/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/split.h"

namespace runcert::csv {
namespace {

/// A column by its number, counted from 1.
std::optional<std::int64_t> column_number(const std::string& source) {
    const auto number = parse_integer(source);
    return number && *number >= 1 ? number : std::nullopt;
}

/// Whether a line is a row, not names: all columns are given by number, and where the time should
/// be stands a number or a date.
bool is_row(const Receiver& receiver, const std::vector<Cell>& cells) {
    const bool numbered =
        std::all_of(receiver.columns.begin(), receiver.columns.end(),
                    [](const auto& column) { return column_number(column.second).has_value(); });
    if (!numbered) return false;
    const auto number = static_cast<std::uint64_t>(*column_number(receiver.columns.at("time")));
    if (number > cells.size()) return false;  // said later, with its remedy
    const std::string_view time = cells[number - 1].text;
    return parse_double(time) || (!time.empty() && time.front() >= '0' && time.front() <= '9');
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
                       fmt::format("Did you mean \"{}\"? Correct columns in the attempt",
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
                           "Columns are counted from 1; correct columns or delimiter in the "
                           "attempt");
    return static_cast<std::size_t>(*number - 1);
}

}  // namespace

Layout read_layout(const Receiver& receiver, const Description& description,
                   const SourceLine& first, const RecordingBytes& recording) {
    Layout layout;
    layout.delimiter = description.delimiter.value_or(find_delimiter(first.text));
    const std::vector<Cell> cells = split(first, recording, layout.delimiter);
    layout.fields = cells.size();
    layout.has_header_line = !is_row(receiver, cells);
    for (std::size_t i = 0; i < layout.place.size(); ++i) {
        const std::string_view meaning = name_of(static_cast<Column>(i));
        const auto found = receiver.columns.find(std::string(meaning));
        if (found != receiver.columns.end())
            layout.place[i] = find_column(found->second, meaning, cells, layout.has_header_line);
    }
    return layout;
}

}  // namespace runcert::csv
