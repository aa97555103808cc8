#include "stages/import/csv/head.h"

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/csv/split.h"

namespace runcert::csv {
namespace {

/// No head has more lines.
constexpr std::int64_t lines_looked_at = 1000;
constexpr std::size_t lines_under_at_most = 4;

/// Nothing where its quotation marks do not pair: such a line is no header.
std::vector<Cell> cells_of(const SourceLine& line, const RecordingBytes& recording,
                           char delimiter) {
    try {
        return split(line, recording, delimiter);
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
        head.names = cells_of(*line, recording, head.delimiter);
        if (!head.names.empty() && is_it(head.names, comment)) {
            head.line = line->number;
            head.first_row = line->number + 1;
            return head;
        }
        head.passed_over += comment ? 0 : 1;
    }
    return std::nullopt;
}

void look_at_rows(const Head& head, const RecordingBytes& recording,
                  const std::function<bool(std::span<const Cell> cells)>& look) {
    LineReader lines = head_lines(recording);
    for (auto line = lines.next(); line; line = lines.next()) {
        if (line->number < head.first_row || is_skipped(*line)) continue;
        const std::vector<Cell> cells = cells_of(*line, recording, head.delimiter);
        if (!cells.empty() && look(cells)) return;
    }
}

std::string_view in_first_row(const Head& head, std::size_t column,
                              const RecordingBytes& recording) {
    std::string_view text;
    look_at_rows(head, recording, [&](std::span<const Cell> cells) {
        if (column < cells.size()) text = cells[column].text;
        return true;
    });
    return text;
}

void take_lines_under(Head& head, const RecordingBytes& recording,
                      std::span<const std::size_t> columns) {
    LineReader lines = head_lines(recording);
    std::vector<std::vector<Cell>> under;
    for (auto line = lines.next(); line; line = lines.next()) {
        if (line->number <= head.line || is_skipped(*line)) continue;
        std::vector<Cell> cells = cells_of(*line, recording, head.delimiter);
        if (cells.empty() || holds_number(cells, columns)) {
            head.under = std::move(under);
            head.first_row = line->number;
            return;
        }
        under.push_back(std::move(cells));
        if (under.size() > lines_under_at_most) return;
    }
}

}  // namespace runcert::csv
