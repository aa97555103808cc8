#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>
#include <span>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/surface/raw.h"

namespace runcert::surface {
namespace {

using Names = std::vector<std::string_view>;

const std::array<Names, 3> names_of_vertices{{{"vertex", "x", "y", "z"},
                                              {"vertex", "east", "north", "up"},
                                              {"vertex", "longitude", "latitude", "height"}}};
const std::array<Names, 1> names_of_triangles{{{"vertex_1", "vertex_2", "vertex_3"}}};

/// Whether the first line that is no comment names all columns of one of the lists.
bool first_line_names(std::string_view bytes, std::span<const Names> choices) {
    std::string_view line;
    do {
        const std::size_t end = std::min(bytes.find('\n'), bytes.size());
        line = trim(bytes.substr(0, end));
        bytes.remove_prefix(std::min(end + 1, bytes.size()));
    } while (!bytes.empty() && (line.empty() || line.front() == '#'));
    constexpr std::size_t longest = 1000;
    if (line.size() > longest) return false;
    std::set<std::string> found;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find_first_of(",;"), line.size());
        found.insert(lower_case(trim(line.substr(0, end))));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return std::ranges::any_of(choices, [&](const Names& names) {
        return std::ranges::all_of(
            names, [&](std::string_view name) { return found.contains(std::string(name)); });
    });
}

/// A table whose columns are found by one of the lists of names; comments begin with #.
class NamedTable {
  public:
    NamedTable(const RecordingBytes& file, std::span<const Names> choices)
        : file_(file), lines_(file) {
        const auto first = next_line();
        if (!first) throw Failure(file.name, "the table is empty", "Export the surface again");
        header_ = *first;
        const std::vector<Cell> names = cells_of(header_);
        width_ = names.size();
        for (const auto& choice : choices) {
            places_.clear();
            for (const std::string_view name : choice)
                for (std::size_t i = 0; i < names.size(); ++i)
                    if (lower_case(trim(names[i].text)) == name) {
                        places_.push_back(i);
                        break;
                    }
            if (places_.size() == choice.size()) return;
        }
        throw Failure(place_in(file, header_),
                      fmt::format("the first line does not name the columns {}",
                                  fmt::join(choices.front(), ", ")),
                      "Write these names in the first line");
    }

    /// The cells of the next row, in the order of the names; nothing at the end.
    std::optional<std::vector<Cell>> next(SourceLine& line) {
        const auto following = next_line();
        if (!following) return std::nullopt;
        line = *following;
        const std::vector<Cell> cells = cells_of(line);
        require_count(cells.size(), width_, line, file_, lines_.at_end(), "its header names",
                      "Export the surface again");
        std::vector<Cell> chosen;
        for (const std::size_t place : places_) {
            chosen.push_back(cells[place]);
            chosen.back().text = trim(chosen.back().text);
        }
        return chosen;
    }

  private:
    std::optional<SourceLine> next_line() {
        while (auto line = lines_.next())
            if (!trim(line->text).empty() && trim(line->text).front() != '#') return line;
        return std::nullopt;
    }
    std::vector<Cell> cells_of(const SourceLine& line) const {
        const bool semicolons = header_.text.find(';') != std::string_view::npos;
        return split_at(line, file_, semicolons ? ';' : ',');
    }

    const RecordingBytes& file_;
    LineReader lines_;
    SourceLine header_;
    std::size_t width_ = 0;
    std::vector<std::size_t> places_;
};

std::int64_t number_in(const Cell& cell) {
    return read_whole(cell, "number of a vertex", -largest_number, largest_number);
}

RawSurface vertices_in(const RecordingBytes& file, VertexNumbers& numbers) {
    RawSurface raw{.format = "csv"};
    NamedTable table(file, names_of_vertices);
    SourceLine line;
    while (const auto cells = table.next(line)) {
        numbers.add(number_in((*cells)[0]), static_cast<std::uint32_t>(raw.mesh.vertices.size()),
                    (*cells)[0].place());
        raw.add_vertex({read_real((*cells)[1], "coordinate"), read_real((*cells)[2], "coordinate"),
                        read_real((*cells)[3], "coordinate")},
                       line, file);
    }
    return raw;
}

}  // namespace

bool is_vertex_table(std::string_view bytes) {
    return first_line_names(bytes, names_of_vertices);
}

bool is_triangle_table(std::string_view bytes) {
    return first_line_names(bytes, names_of_triangles);
}

RawSurface read_vertex_table(const RecordingBytes& file) {
    VertexNumbers numbers;
    return vertices_in(file, numbers);
}

std::int64_t count_triangles(const RecordingBytes& file) {
    NamedTable table(file, names_of_triangles);
    SourceLine line;
    std::int64_t count = 0;
    while (const auto cells = table.next(line)) {
        for (const Cell& cell : *cells)
            (void)number_in(cell);
        ++count;
    }
    return count;
}

RawSurface read_tables(const RecordingBytes& vertices, const RecordingBytes& triangles) {
    VertexNumbers numbers;
    RawSurface raw = vertices_in(vertices, numbers);
    NamedTable faces(triangles, names_of_triangles);
    SourceLine line;
    while (const auto cells = faces.next(line)) {
        Corners corners{};
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = numbers.of(number_in((*cells)[i]), (*cells)[i].place());
        raw.add_triangle(corners, line, triangles);
    }
    return raw;
}

}  // namespace runcert::surface
