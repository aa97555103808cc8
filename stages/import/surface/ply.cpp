#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/surface/raw.h"

namespace runcert::surface {
namespace {

/// An element of the header: "vertex", how many there are, and the names of its properties, a list
/// marked by a star.
struct PlyElement {
    std::string name;
    std::int64_t count = 0;
    std::vector<std::string> properties;
};

std::vector<Cell> next_words(LineReader& lines, SourceLine& line, const RecordingBytes& file) {
    const auto next = lines.next();
    if (!next)
        throw Failure(file.name, "the PLY file ends before all that its header announces",
                      "Copy or export the file again, whole");
    line = *next;
    return split_words(line, line.text, file);
}

std::vector<PlyElement> read_header(LineReader& lines, const RecordingBytes& file) {
    std::vector<PlyElement> elements;
    bool has_format = false;
    for (SourceLine line;;) {
        const std::vector<Cell> words = next_words(lines, line, file);
        if (words.empty()) continue;
        const std::string_view keyword = words.front().text;
        const auto needs = [&](std::size_t count) {
            if (words.size() < count)
                words.front().fail(fmt::format("the header's line \"{}\" is not whole", keyword),
                                   "Export the surface again");
        };
        if (keyword == "end_header") break;
        if (keyword == "format") {
            needs(3);
            has_format = true;
            if (words[1].text != "ascii")
                words[1].fail("the PLY file is binary", "Export it as PLY ascii");
        } else if (keyword == "element") {
            needs(3);
            elements.push_back({std::string(words[1].text),
                                read_whole(words[2], "number of elements", 0, most_elements),
                                {}});
        } else if (keyword == "property") {
            needs(words.size() > 1 && words[1].text == "list" ? 5 : 3);
            if (elements.empty())
                words.front().fail("a property belongs to no element", "Export the surface again");
            const bool list = words[1].text == "list";
            elements.back().properties.push_back((list ? "*" : "") +
                                                 std::string(words.back().text));
        } else if (keyword != "ply" && keyword != "comment" && keyword != "obj_info") {
            words.front().fail(
                fmt::format("\"{}\" is no line of a PLY header", escape_for_message(keyword)),
                "Export the surface as PLY 1.0, ascii");
        }
    }
    if (!has_format)
        throw Failure(file.name, "the PLY header does not say its format",
                      "Export the surface as PLY 1.0, ascii");
    return elements;
}

void read_vertices(const PlyElement& element, LineReader& lines, const RecordingBytes& file,
                   RawSurface& raw) {
    const auto place = [&](const char* name) {
        const auto found = std::ranges::find(element.properties, name);
        const bool after_list = std::any_of(element.properties.begin(), found,
                                            [](const std::string& p) { return p[0] == '*'; });
        if (found == element.properties.end() || after_list)
            throw Failure(file.name, fmt::format("the vertices have no property {}", name),
                          "Export the surface with vertices x, y and z");
        return static_cast<std::size_t>(found - element.properties.begin());
    };
    const std::size_t x = place("x"), y = place("y"), z = place("z");
    SourceLine line;
    for (std::int64_t i = 0; i < element.count; ++i) {
        const std::vector<Cell> cells = next_words(lines, line, file);
        require_count(cells.size(), element.properties.size(), line, file, lines.at_end(),
                      "its header names", "Export the surface again");
        raw.add_vertex({read_real(cells[x], "coordinate"), read_real(cells[y], "coordinate"),
                        read_real(cells[z], "coordinate")},
                       line, file);
    }
}

void read_faces(const PlyElement& element, LineReader& lines, const RecordingBytes& file,
                RawSurface& raw) {
    if (element.properties.empty() || element.properties.front()[0] != '*')
        throw Failure(file.name, "the faces do not begin with the list of their vertices",
                      "Export the surface with property list uchar int vertex_indices");
    SourceLine line;
    const std::int64_t last = std::ssize(raw.mesh.vertices) - 1;
    for (std::int64_t i = 0; i < element.count; ++i) {
        const std::vector<Cell> cells = next_words(lines, line, file);
        if (cells.size() < 4 || cells.front().text != "3")
            throw Failure(place_in(file, line), "the face is no triangle",
                          "Export the surface as triangles");
        Corners corners{};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::int64_t vertex =
                read_whole(cells[k + 1], "number of a vertex", INT32_MIN, INT32_MAX);
            if (vertex < 0 || vertex > last)
                cells[k + 1].fail(
                    fmt::format("the triangle names vertex {}; they are 0 to {}", vertex, last),
                    "Export the surface whole, with all its vertices");
            corners[k] = static_cast<std::uint32_t>(vertex);
        }
        raw.add_triangle(corners, line, file);
    }
}

}  // namespace

bool is_ply(std::string_view bytes) {
    return bytes.starts_with("ply\n") || bytes.starts_with("ply\r");
}

RawSurface read_ply(const RecordingBytes& file) {
    RawSurface raw{.format = "ply"};
    LineReader lines(file);
    for (const PlyElement& element : read_header(lines, file)) {
        if (element.name == "vertex")
            read_vertices(element, lines, file, raw);
        else if (element.name == "face")
            read_faces(element, lines, file, raw);
        else
            for (std::int64_t i = 0; i < element.count && !lines.at_end(); ++i)
                (void)lines.next();
    }
    return raw;
}

}  // namespace runcert::surface
