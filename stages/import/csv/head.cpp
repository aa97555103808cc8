#include "stages/import/csv/head.h"

#include <algorithm>
#include <array>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/fields/column.h"

namespace runcert::csv {
namespace {

/// Semicolons first: where they delimit, commas are decimal ones.
constexpr std::array known_delimiters{Delimiter{';', "semicolon"}, Delimiter{'\t', "tab"},
                                      Delimiter{',', "comma"}, Delimiter{' ', "blank"}};

bool is_blank(char c) {
    return c == ' ' || c == '\t';
}

/// Where the quoted field that begins at `at` ends: its closing quotation mark.
std::size_t closing_mark(std::string_view text, std::size_t at, const Cell& start) {
    for (std::size_t i = at + 1; i < text.size(); ++i) {
        if (text[i] != '"') continue;
        if (i + 1 == text.size() || text[i + 1] != '"') return i;
        ++i;
    }
    start.fail("a quotation mark is not closed on its line",
               "Hand in the table as the logger wrote it, or another export");
}

/// No head has more lines.
constexpr std::int64_t lines_looked_at = 1000;
constexpr std::size_t lines_under_at_most = 4;

/// Nothing where its quotation marks do not pair: such a line is no header.
std::vector<Cell> cells_of(const SourceLine& line, const RecordingBytes& recording,
                           const Head& head) {
    try {
        return head.row(line, recording);
    } catch (const Failure&) {
        return {};
    }
}

bool begins_as_time(std::string_view text) {
    return !text.empty() && ((text.front() >= '0' && text.front() <= '9') || text.front() == '-' ||
                             text.front() == '.');
}

bool holds_number(std::span<const Cell> cells, std::span<const std::size_t> columns) {
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (columns[i] >= cells.size()) continue;
        const std::string_view text = cells[columns[i]].text;
        if (i == 0 ? begins_as_time(text) : parse_double(text).has_value()) return true;
    }
    return false;
}

/// The lines of a head, for those who only look: what `passed` would release is still read.
LineReader head_lines(const RecordingBytes& recording) {
    return LineReader(RecordingBytes{.name = recording.name, .bytes = recording.bytes});
}

}  // namespace

std::span<const Delimiter> delimiters() {
    return known_delimiters;
}

char find_delimiter(std::string_view line) {
    for (const Delimiter& delimiter : known_delimiters) {
        bool quoted = false;
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            if (c == delimiter.character && !quoted) return delimiter.character;
        }
    }
    return ',';
}

std::vector<Cell> split(const SourceLine& line, const RecordingBytes& recording, char delimiter) {
    // Where blanks delimit, tabs do so too, and several are one.
    const bool by_blanks = delimiter == ' ';
    const std::string_view text =
        by_blanks ? line.text.substr(0, line.text.find_last_not_of(" \t") + 1) : line.text;
    const auto delimits = [&](std::size_t at) {
        return by_blanks ? is_blank(text[at]) : text[at] == delimiter;
    };
    const auto blank = [&](std::size_t at) { return is_blank(text[at]) && !delimits(at); };
    const auto cell = [&](std::size_t from, std::size_t to) {
        return Cell{text.substr(from, to - from), &recording, line.number, from + 1};
    };
    std::vector<Cell> cells;
    cells.reserve(24);
    for (std::size_t at = 0;; ++at) {
        while (at < text.size() && is_blank(text[at]) && (by_blanks || !delimits(at)))
            ++at;
        if (at < text.size() && text[at] == '"') {
            const std::size_t mark = closing_mark(text, at, cell(at, at + 1));
            cells.push_back(cell(at + 1, mark));
            at = mark + 1;
            while (at < text.size() && blank(at))
                ++at;
            if (at < text.size() && text[at] == '|')
                while (at < text.size() && !delimits(at))
                    ++at;
            if (at < text.size() && !delimits(at))
                cell(at, at + 1)
                    .fail("something follows a closing quotation mark",
                          "Hand in the table as the logger wrote it, or another export");
        } else {
            const std::size_t from = at;
            while (at < text.size() && !delimits(at))
                ++at;
            std::size_t to = at;
            while (to > from && blank(to - 1))
                --to;
            cells.push_back(cell(from, to));
        }
        if (at >= text.size()) return cells;
    }
}

std::vector<Cell> Head::row(const SourceLine& source, const RecordingBytes& recording) const {
    std::vector<Cell> cells = split(source, recording, delimiter);
    for (const std::size_t column : in_three) {
        if (column + 2 >= cells.size()) continue;
        Cell& first = cells[column];
        const std::string_view last = cells[column + 2].text;
        first.text = {first.text.data(),
                      static_cast<std::size_t>(last.data() + last.size() - first.text.data())};
        cells.erase(cells.begin() + static_cast<std::ptrdiff_t>(column) + 1,
                    cells.begin() + static_cast<std::ptrdiff_t>(column) + 3);
    }
    return cells;
}

void find_in_three(Head& head, std::span<const Cell> cells) {
    if (head.delimiter != ' ' || !head.in_three.empty() || cells.size() != head.names.size() + 4)
        return;
    for (std::size_t i = 0; i < head.names.size(); ++i)
        for (const Column column : {Column::latitude, Column::longitude})
            if (is_named(head.names[i].text, column)) head.in_three.push_back(i);
    if (head.in_three.size() != 2) head.in_three.clear();
}

bool is_skipped(const SourceLine& line) {
    return line.text.starts_with('#') || trim(line.text).empty();
}

std::optional<Head> find_head(const RecordingBytes& recording, std::optional<char> delimiter,
                              const IsHead& is_it) {
    Head head;
    LineReader lines = head_lines(recording);
    for (auto line = lines.next(); line && line->number <= lines_looked_at; line = lines.next()) {
        const bool comment = is_skipped(*line);
        if (comment)
            line->text.remove_prefix(
                std::min(line->text.find_first_not_of("# "), line->text.size()));
        if (line->text.empty()) continue;
        head.delimiter = delimiter.value_or(find_delimiter(line->text));
        head.names = cells_of(*line, recording, head);
        if (!head.names.empty() && is_it(head.names, comment)) {
            head.line = line->number;
            head.first_row = line->number + 1;
            return head;
        }
        head.passed_over += comment ? 0 : 1;
    }
    return std::nullopt;
}

void visit_rows(const Head& head, const RecordingBytes& recording,
                const std::function<bool(std::span<const Cell> cells)>& look) {
    LineReader lines = head_lines(recording);
    for (auto line = lines.next(); line; line = lines.next()) {
        if (line->number < head.first_row || is_skipped(*line)) continue;
        const std::vector<Cell> cells = cells_of(*line, recording, head);
        if (!cells.empty() && look(cells)) return;
    }
}

std::string_view in_first_row(const Head& head, std::size_t column,
                              const RecordingBytes& recording) {
    std::string_view text;
    visit_rows(head, recording, [&](std::span<const Cell> cells) {
        if (column < cells.size()) text = cells[column].text;
        return true;
    });
    return text;
}

void take_lines_under(Head& head, const RecordingBytes& recording,
                      std::span<const std::size_t> columns) {
    LineReader lines = head_lines(recording);
    std::vector<SourceLine> under;
    for (auto line = lines.next(); line; line = lines.next()) {
        if (line->number <= head.line || is_skipped(*line)) continue;
        const std::vector<Cell> cells = cells_of(*line, recording, head);
        if (cells.empty() || holds_number(cells, columns)) {
            find_in_three(head, cells);
            for (const SourceLine& one : under)
                head.under.push_back(cells_of(one, recording, head));
            head.first_row = line->number;
            return;
        }
        under.push_back(*line);
        if (under.size() > lines_under_at_most) return;
    }
}

}  // namespace runcert::csv
