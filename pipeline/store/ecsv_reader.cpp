#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>
#include <utility>

#include "core/decimal.h"
#include "core/failure.h"
#include "core/text.h"
#include "store/ecsv.h"
#include "store/yaml_input.h"

namespace runcert {
namespace {

bool holds_ordered_map(const YamlNode& node) {
    if (node.is_ordered_map()) return true;
    for (std::size_t i = 0; i < node.size(); ++i)
        if (holds_ordered_map(node.is_map() ? node.value(i) : node.item(i))) return true;
    return false;
}

void copy_plain(const YamlNode& node, const std::string& where, YamlBuilder& out) {
    if (node.is_null() || node.is_scalar()) return out.copy(node);
    if (!node.is_ordered_map()) {
        out.begin(node.kind(), node.mark());
        for (std::size_t i = 0; i < node.size(); ++i) {
            if (node.is_map()) out.copy(node.key(i));
            copy_plain(node.is_map() ? node.value(i) : node.item(i), where, out);
        }
        out.end();
        return;
    }
    std::set<std::string_view> keys;
    out.begin(YamlKind::map, {});
    for (std::size_t i = 0; i < node.size(); ++i) {
        const YamlNode item = node.item(i);
        if (!item.is_map() || item.size() != 1 || !keys.insert(item.key(0).scalar()).second)
            throw Failure(yaml_place(where, item),
                          "an !!omap entry is not one new key and its value", take_the_original);
        out.copy(item.key(0));
        copy_plain(item.value(0), where, out);
    }
    out.end();
}

/// astropy writes an ordered map as `!!omap`, a list of maps of one key each: turned into maps,
/// wherever in `node` they stand.
YamlNode plain_map(const YamlNode& node, const std::string& where) {
    if (!holds_ordered_map(node)) return node;
    YamlBuilder out;
    copy_plain(node, where, out);
    return std::move(out).take();
}

/// A header line as the line of YAML it holds. Blanks instead of "# " keep the columns that
/// messages name; the document's marks must stand at the line's beginning.
std::string yaml_line(std::string_view content) {
    const bool is_mark = content.starts_with("---") || content.starts_with("...");
    return (is_mark ? "" : "  ") + std::string(content) + "\n";
}

}  // namespace

EcsvReader::EcsvReader(std::string_view text, std::string where)
    : text_(text), where_(std::move(where)) {
    read_header();
}

void EcsvReader::fail_at(std::size_t line, std::size_t position, const std::string& what,
                         const std::string& remedy) const {
    throw Failure(fmt::format("{}:{}:{}", where_, line, position), what, remedy);
}

void EcsvReader::fail(std::size_t column, const std::string& what,
                      const std::string& remedy) const {
    const std::size_t position = column < cells_.size() ? cells_[column].position : 1;
    fail_at(line_, position, fmt::format("column \"{}\": {}", columns_[column].name, what), remedy);
}

std::optional<std::string_view> EcsvReader::next_line() {
    if (offset_ >= text_.size()) return std::nullopt;
    std::size_t end = text_.find('\n', offset_);
    ++line_;
    if (end == std::string_view::npos)
        fail_at(line_, text_.size() - offset_ + 1, "the last line has no end: the file is cut off",
                take_the_original);
    std::string_view line = text_.substr(offset_, end - offset_);
    offset_ = end + 1;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

void EcsvReader::read_header() {
    if (text_.empty()) throw Failure(where_, "the file is empty", take_the_original);
    const auto first = next_line();
    if (*first != "# %ECSV 1.0")
        fail_at(1, 1,
                fmt::format("expected \"# %ECSV 1.0\", found \"{}\"", escape_for_message(*first)),
                "This is not an ECSV 1.0 table");
    std::string yaml;
    std::optional<std::string_view> line;
    while ((line = next_line()) && line->starts_with('#')) {
        if (line->starts_with("##")) {
            yaml += '\n';
            continue;
        }
        if (!line->starts_with("# "))
            fail_at(line_, 2, "a header line must begin with \"# \"", take_the_original);
        if (!is_printable_ascii(*line))
            fail_at(line_, 1, "a header line holds bytes that are not printable ASCII",
                    take_the_original);
        yaml += yaml_line(line->substr(2));
    }
    if (!line)
        fail_at(line_, 1, "the header is not followed by the line of column names",
                take_the_original);
    // The YAML text starts on line 2 of the file: keep its line numbers.
    const YamlNode header = parse_yaml("\n" + yaml, where_);
    const YamlNode datatype = header["datatype"];
    if (!datatype.is_list())
        fail_at(2, 1, "the header has no list \"datatype\"", take_the_original);
    const YamlNode delimiter = header["delimiter"];
    if (delimiter.scalar() != ",")
        throw Failure(delimiter.is_defined() ? yaml_place(where_, delimiter) : where_ + ":2:1",
                      "the delimiter is not a comma", "Only tables with delimiter ',' are read");
    for (std::size_t i = 0; i < header.size(); ++i) {
        const std::string key(header.key(i).scalar());
        if (key != "datatype" && key != "delimiter" && key != "meta" && key != "schema")
            throw Failure(yaml_place(where_, header.key(i)), "unknown header key \"" + key + "\"",
                          take_the_original);
    }
    columns_.reserve(datatype.size());
    for (std::size_t i = 0; i < datatype.size(); ++i)
        read_column(datatype.item(i), i);
    meta_ = plain_map(header["meta"], where_);
    check_names(*line);
}

void EcsvReader::read_column(const YamlNode& node, std::size_t index) {
    const auto scalar = [&](const char* key) { return std::string(node[key].scalar()); };
    if (!node.is_map() || scalar("name").empty())
        throw Failure(yaml_place(where_, node), fmt::format("column {} has no name", index + 1),
                      take_the_original);
    for (std::size_t i = 0; i < node.size(); ++i) {
        static const std::set<std::string_view> keys{"name",   "unit",        "datatype",
                                                     "format", "description", "meta"};
        if (!keys.contains(node.key(i).scalar()))
            throw Failure(yaml_place(where_, node.key(i)),
                          "unknown column key \"" + std::string(node.key(i).scalar()) + "\"",
                          take_the_original);
    }
    EcsvColumn column;
    column.name = scalar("name");
    column.unit = scalar("unit");
    column.description = scalar("description");
    const std::string type = scalar("datatype");
    static constexpr std::array types{CellType::boolean, CellType::integer, CellType::real,
                                      CellType::text};
    const auto known = std::ranges::find(types, type, ecsv_name);
    if (known == types.end())
        throw Failure(yaml_place(where_, node),
                      fmt::format("column \"{}\" has the type \"{}\"", column.name, type),
                      "Only bool, int64, float64 and string are read");
    column.type = *known;
    const std::string format = scalar("format");
    if (format.starts_with("%.") && format.ends_with("f"))
        column.decimals = static_cast<int>(
            parse_integer(std::string_view(format).substr(2, format.size() - 3)).value_or(0));
    if (std::ranges::count(columns_, column.name, &EcsvColumn::name) > 0)
        throw Failure(yaml_place(where_, node), "two columns are named \"" + column.name + "\"",
                      take_the_original);
    columns_.push_back(std::move(column));
}

void EcsvReader::check_names(std::string_view line) {
    split(line);
    if (!std::ranges::equal(std::span(cells_).first(cell_count_), columns_, {}, &Cell::text,
                            &EcsvColumn::name))
        fail_at(line_, 1, "the line of column names does not equal the header's list of columns",
                take_the_original);
}

std::size_t EcsvReader::split_quoted(std::string_view line, std::size_t at, std::string& text) {
    const std::size_t opened = at;
    for (++at; at < line.size(); ++at) {
        if (line[at] != '"') {
            text += line[at];
        } else if (at + 1 < line.size() && line[at + 1] == '"') {
            text += '"';
            ++at;
        } else {
            if (at + 1 < line.size() && line[at + 1] != ',')
                fail_at(line_, at + 2, "text after a closing quote", take_the_original);
            return at + 1;
        }
    }
    fail_at(line_, opened + 1, "a quote is not closed on its line", take_the_original);
}

void EcsvReader::split(std::string_view line) {
    cell_count_ = 0;
    unquoted_.clear();
    std::size_t at = 0;
    while (true) {
        if (cell_count_ == cells_.size()) cells_.emplace_back();
        Cell& cell = cells_[cell_count_++];
        cell.position = at + 1;
        if (at < line.size() && line[at] == '"') {
            at = split_quoted(line, at, unquoted_.emplace_back());
            cell.text = unquoted_.back();
        } else {
            const std::size_t end = std::min(line.find(',', at), line.size());
            cell.text = line.substr(at, end - at);
            const std::size_t quote = cell.text.find('"');
            if (quote != std::string_view::npos)
                fail_at(line_, at + quote + 1, "a quote inside a cell that is not quoted",
                        take_the_original);
            at = end;
        }
        if (at >= line.size()) return;
        ++at;  // the comma
    }
}

/// Splits a row in one pass over its bytes, as nearly all rows can be: as many cells as there are
/// columns, and in none of them a quote, a blank or what is not printable. False, with nothing
/// done, for any other row, and at the end.
bool EcsvReader::split_plain_row() {
    const char* const begin = text_.data() + offset_;
    const char* const end = text_.data() + text_.size();
    if (begin == end || *begin == '#' || *begin == '\n') return false;
    const char* cell = begin;
    std::size_t count = 0;
    for (const char* at = begin; at != end; ++at) {
        const char c = *at;
        if (c > ',' && c <= '~') continue;
        if (c == ',' || c == '\n') {
            if (count == columns_.size()) return false;
            cells_[count++] = {{cell, static_cast<std::size_t>(at - cell)},
                               static_cast<std::size_t>(cell - begin) + 1};
            cell = at + 1;
            if (c == ',') continue;
            if (count != columns_.size()) return false;
            cell_count_ = count;
            offset_ += static_cast<std::size_t>(cell - begin);
            ++line_;
            return true;
        }
        if (c <= ' ' || c == '"' || c > '~') return false;
    }
    return false;
}

bool EcsvReader::next_row() {
    return split_plain_row() || split_any_row();
}

bool EcsvReader::split_any_row() {
    const auto line = next_line();
    if (!line) return false;
    // Other readers pass over both.
    if (line->empty()) fail_at(line_, 1, "the line is empty", take_the_original);
    if (line->starts_with('#')) fail_at(line_, 1, "a comment among the rows", take_the_original);
    split(*line);
    if (cell_count_ != columns_.size())
        fail_at(line_, 1,
                fmt::format("the row has {} cells, the header has {} columns", cell_count_,
                            columns_.size()),
                take_the_original);
    for (const Cell& cell : std::span(cells_).first(cell_count_)) {
        if (!is_printable_ascii(cell.text))
            fail_at(line_, cell.position, "a cell holds bytes that are not printable ASCII",
                    take_the_original);
        if (cell.text.starts_with(' ') || cell.text.ends_with(' '))
            fail_at(line_, cell.position, "a cell begins or ends with a blank", take_the_original);
    }
    return true;
}

const EcsvReader::Cell& EcsvReader::present(std::size_t column) const {
    if (cells_[column].text.empty())
        fail(column, "the cell is empty but must not be", take_the_original);
    return cells_[column];
}

template <class Parse>
auto EcsvReader::parsed(std::size_t column, Parse parse, std::string_view meaning) const {
    const std::string_view cell = present(column).text;
    const auto value = parse(cell);
    if (!value)
        fail(column, fmt::format("\"{}\" is {}", escape_for_message(cell), meaning),
             take_the_original);
    return *value;
}

bool EcsvReader::boolean(std::size_t column) const {
    const auto parse = [](std::string_view cell) {
        return cell == "True" || cell == "False" ? std::optional(cell == "True") : std::nullopt;
    };
    return parsed(column, parse, "neither True nor False");
}

std::int64_t EcsvReader::integer(std::size_t column) const {
    return parsed(column, parse_integer, "not a whole number");
}

double EcsvReader::real(std::size_t column) const {
    return parsed(column, parse_double, "not a finite number");
}

std::int64_t EcsvReader::seconds(std::size_t column) const {
    return parsed(column, parse_decimal_nanoseconds,
                  "not a time in seconds with at most nine decimals");
}

}  // namespace runcert
