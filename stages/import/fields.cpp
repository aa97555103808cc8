#include "stages/import/fields.h"

#include <fmt/format.h>

namespace runcert {

std::vector<Cell> split_at(const SourceLine& line, const RecordingBytes& recording,
                           char separator) {
    std::vector<Cell> cells;
    for (std::size_t at = 0;;) {
        const std::size_t end = line.text.find(separator, at);
        cells.push_back({line.text.substr(at, end - at), &recording, line.number, at + 1});
        if (end == std::string_view::npos) return cells;
        at = end + 1;
    }
}

std::vector<Cell> split_words(const SourceLine& line, std::string_view text,
                              const RecordingBytes& recording, char separator,
                              std::string_view blanks) {
    const auto is_blank = [&](char c) { return blanks.find(c) != std::string_view::npos; };
    std::vector<Cell> cells;
    cells.reserve(24);
    const auto offset = static_cast<std::size_t>(text.data() - line.text.data());
    const auto cell = [&](std::size_t from, std::size_t to) {
        return Cell{text.substr(from, to - from), &recording, line.number, offset + from + 1};
    };
    const auto skip_blanks = [&](std::size_t at) {
        while (at < text.size() && is_blank(text[at]) && text[at] != separator)
            ++at;
        return at;
    };
    for (std::size_t at = skip_blanks(0); at < text.size();) {
        if (separator != '\0' && text[at] == separator)
            cell(at, at + 1)
                .fail("a field is empty", "Hand in the recording as the logger wrote it");
        std::size_t end = at;
        while (end < text.size() && !is_blank(text[end]) &&
               (separator == '\0' || text[end] != separator))
            ++end;
        cells.push_back(cell(at, end));
        at = skip_blanks(end);
        if (separator != '\0' && at < text.size() && text[at] == separator)
            at = skip_blanks(at + 1);
    }
    return cells;
}

void require_count(std::size_t count, std::size_t expected, const SourceLine& line,
                   const RecordingBytes& recording, bool last, std::string_view header_has,
                   const std::string& remedy) {
    if (count == expected) return;
    const Cell start{line.text, &recording, line.number, 1};
    if (count < expected && last)
        start.fail(fmt::format("the last line is cut off: it has {} fields of {}", count, expected),
                   "Hand in the whole recording, as the logger wrote it");
    start.fail(fmt::format("the line has {} fields; {} {}", count, header_has, expected), remedy);
}

}  // namespace runcert
