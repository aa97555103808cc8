#include <fmt/format.h>

#include <algorithm>
#include <pugixml.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/cell.h"
#include "stages/import/surface/raw.h"

namespace runcert::surface {
namespace {

/// Counts the lines up to offsets that ascend.
class LineCounter {
  public:
    explicit LineCounter(const RecordingBytes& file) : file_(file) {}

    SourceLine at(const pugi::xml_node& node) {
        const std::ptrdiff_t offset = node.offset_debug();
        const auto end = offset < 0 ? at_ : static_cast<std::size_t>(offset);
        // What stands before where the last one was is counted anew.
        if (end < at_) {
            at_ = 0;
            line_ = 1;
        }
        line_ += std::count(file_.bytes.begin() + static_cast<std::ptrdiff_t>(at_),
                            file_.bytes.begin() + static_cast<std::ptrdiff_t>(end), '\n');
        at_ = end;
        return {.text = node.text().get(), .number = line_, .byte = static_cast<std::int64_t>(end)};
    }

    std::string place(const pugi::xml_node& node) { return place_in(file_, at(node)); }

  private:
    const RecordingBytes& file_;
    std::size_t at_ = 0;
    std::int64_t line_ = 1;
};

/// The numbers of an element's text, of which there must be three.
template <class Number, class Read>
std::array<Number, 3> three_of(const SourceLine& line, const RecordingBytes& file,
                               std::string_view what, const Read& read) {
    const std::vector<Cell> cells = split_words(line, line.text, file, '\0', " \t\r\n");
    if (cells.size() != 3)
        throw Failure(place_in(file, line),
                      fmt::format("{} has {} numbers where there are three", what, cells.size()),
                      "Export the surface as LandXML 1.2 with triangles");
    return {read(cells[0]), read(cells[1]), read(cells[2])};
}

double metres_of(const std::string& unit, const std::string& place) {
    const std::string name = lower_case(unit);
    if (name == "meter" || name == "metre") return 1.0;
    if (name == "millimeter") return 1e-3;
    if (name == "centimeter") return 1e-2;
    if (name == "kilometer") return 1e3;
    if (name == "foot" || name == "feet") return 0.3048;
    if (name == "ussurveyfoot") return 1200.0 / 3937.0;
    throw Failure(place,
                  fmt::format("\"{}\" is no unit of length known here", escape_for_message(unit)),
                  "Export the surface in metres (linearUnit=\"meter\")");
}

void read_units(const pugi::xml_node& root, LineCounter& lines, RawSurface& raw) {
    const pugi::xml_node unit = root.child("Units").first_child();
    if (!unit || !unit.attribute("linearUnit")) return;
    raw.unit_name = unit.attribute("linearUnit").value();
    raw.unit_m = metres_of(raw.unit_name, lines.place(unit));
    const std::string heights = unit.attribute("elevationUnit").value();
    if (!heights.empty() && metres_of(heights, lines.place(unit)) != *raw.unit_m)
        throw Failure(lines.place(unit),
                      fmt::format("coordinates are in {}, heights in {}",
                                  escape_for_message(raw.unit_name), escape_for_message(heights)),
                      "Export the surface with one unit for both");
}

/// The definition of the one surface that there is.
pugi::xml_node only_surface(const pugi::xml_node& root, const RecordingBytes& file,
                            LineCounter& lines) {
    std::vector<pugi::xml_node> found;
    for (const pugi::xml_node& surfaces : root.children("Surfaces"))
        for (const pugi::xml_node& surface : surfaces.children("Surface"))
            if (surface.child("Definition")) found.push_back(surface);
    if (found.empty())
        throw Failure(file.name, "the LandXML file holds no surface with a definition",
                      "Export the surface itself as triangles (surfType=\"TIN\")");
    if (found.size() > 1)
        throw Failure(
            lines.place(found[1]),
            fmt::format("the file holds {} surfaces, \"{}\" and \"{}\" among them", found.size(),
                        escape_for_message(found[0].attribute("name").value()),
                        escape_for_message(found[1].attribute("name").value())),
            "Export the one that the craft runs on");
    const pugi::xml_node definition = found.front().child("Definition");
    const std::string type = definition.attribute("surfType").value();
    if (type != "TIN")
        throw Failure(lines.place(definition),
                      fmt::format("the surface is of type \"{}\", not of triangles",
                                  escape_for_message(type)),
                      "Export it as triangles (surfType=\"TIN\")");
    return definition;
}

}  // namespace

bool is_landxml(std::string_view bytes) {
    return bytes.substr(0, recognised_by).find("<LandXML") != std::string_view::npos;
}

RawSurface read_landxml(const RecordingBytes& file) {
    pugi::xml_document document;
    const auto parsed = document.load_buffer(file.bytes.data(), file.bytes.size());
    if (!parsed)
        throw Failure(place_in(file, RecordPlace(static_cast<std::size_t>(
                                         std::max<std::ptrdiff_t>(0, parsed.offset)))),
                      fmt::format("the XML cannot be read: {}", lower_case(parsed.description())),
                      "Export the file again");
    const pugi::xml_node root = document.child("LandXML");
    RawSurface raw{.format = "landxml", .north_first = true};
    LineCounter lines(file);
    read_units(root, lines, raw);
    const pugi::xml_node definition = only_surface(root, file, lines);
    VertexNumbers numbers;
    for (const pugi::xml_node& point : definition.child("Pnts").children("P")) {
        const SourceLine line = lines.at(point);
        const auto at = three_of<double>(
            line, file, "a point", [](const Cell& cell) { return read_real(cell, "coordinate"); });
        const auto id = parse_integer(point.attribute("id").value());
        if (!id)
            throw Failure(place_in(file, line), "the point has no number (id)",
                          "Export the surface as LandXML 1.2");
        numbers.add(*id, static_cast<std::uint32_t>(raw.mesh.vertices.size()),
                    place_in(file, line));
        raw.add_vertex({at[0], at[1], at[2]}, line, file);
    }
    for (const pugi::xml_node& faces : definition.children("Faces"))
        for (const pugi::xml_node& face : faces.children("F")) {
            if (face.attribute("i").as_int() == 1) {
                ++raw.invisible;
                continue;
            }
            const SourceLine line = lines.at(face);
            const auto corners =
                three_of<std::uint32_t>(line, file, "a face", [&](const Cell& cell) {
                    return numbers.of(
                        read_whole(cell, "number of a point", -largest_number, largest_number),
                        cell.place());
                });
            raw.add_triangle(corners, line, file);
        }
    return raw;
}

}  // namespace runcert::surface
