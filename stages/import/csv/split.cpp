#include "stages/import/csv/split.h"

#include <array>

#include "core/failure.h"

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

}  // namespace runcert::csv
