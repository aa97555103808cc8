#include <fmt/format.h>

#include <array>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/surface/raw.h"

namespace runcert::surface {
namespace {

std::string_view keyword_of(std::string_view line) {
    const std::string_view text = trim(line);
    return text.substr(0, text.find_first_of(" \t"));
}

/// What says nothing of the ground: normals, textures, groups, materials, lines.
bool is_passed_over(std::string_view keyword) {
    constexpr std::array<std::string_view, 12> others{"vn", "vt",     "vp",     "g", "o", "s",
                                                      "mg", "mtllib", "usemtl", "l", "p", "#"};
    return keyword.empty() || keyword.front() == '#' || std::ranges::count(others, keyword) > 0;
}

/// The vertex of "7", "7/1", "7//3" or "-1", which counts back from the last.
std::uint32_t vertex_of(Cell cell, std::size_t count) {
    cell.text = cell.text.substr(0, cell.text.find('/'));
    const std::int64_t number =
        read_whole(cell, "number of a vertex", -2'000'000'000, 2'000'000'000);
    const std::int64_t index = number < 0 ? static_cast<std::int64_t>(count) + number : number - 1;
    if (number == 0 || index < 0 || index >= static_cast<std::int64_t>(count))
        cell.fail(
            fmt::format("the triangle names vertex {}; {} are listed before it", number, count),
            "Export the surface whole, with all its vertices");
    return static_cast<std::uint32_t>(index);
}

}  // namespace

bool is_obj(std::string_view bytes) {
    LineReader lines(bytes.substr(0, recognised_by));
    while (const auto line = lines.next()) {
        const std::string_view keyword = keyword_of(line->text);
        if (keyword == "v") return true;
        if (!is_passed_over(keyword)) return false;
    }
    return false;
}

RawSurface read_obj(const RecordingBytes& file) {
    RawSurface raw{.format = "obj"};
    LineReader lines(file);
    while (const auto line = lines.next()) {
        const std::string_view keyword = keyword_of(line->text);
        if (is_passed_over(keyword)) continue;
        const std::vector<Cell> cells = split_words(*line, line->text, file);
        if (keyword == "v") {
            require_count(std::min<std::size_t>(cells.size(), 4), 4, *line, file, lines.at_end(),
                          "a vertex has v and three coordinates: ", "Export the surface again");
            raw.add_vertex({read_real(cells[1], "coordinate"), read_real(cells[2], "coordinate"),
                            read_real(cells[3], "coordinate")},
                           *line, file);
        } else if (keyword == "f") {
            if (cells.size() != 4)
                cells.front().fail(fmt::format("a face has {} corners", cells.size() - 1),
                                   "Export the surface as triangles");
            const std::size_t count = raw.mesh.vertices.size();
            raw.add_triangle({vertex_of(cells[1], count), vertex_of(cells[2], count),
                              vertex_of(cells[3], count)},
                             *line, file);
        } else {
            cells.front().fail(
                fmt::format("\"{}\" is no line of a surface in OBJ", escape_for_message(keyword)),
                "Export the surface as polygons: lines v and f");
        }
    }
    return raw;
}

}  // namespace runcert::surface
