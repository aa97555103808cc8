#include "stages/import/gpx/point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "core/failure.h"
#include "core/text.h"
#include "stages/import/clock.h"
#include "stages/import/earth.h"

namespace runcert::gpx {
namespace {

/// Extensions are not looked for deeper than this.
constexpr int deepest = 8;

std::string_view local_name(pugi::xml_node node) {
    const std::string_view name = node.name();
    const std::size_t colon = name.find(':');
    return colon == std::string_view::npos ? name : name.substr(colon + 1);
}

/// The text of the first speed and the first course among a node's descendants.
void find_motion(pugi::xml_node extensions, const char*& speed, const char*& course) {
    int depth = 0;
    pugi::xml_node node = extensions.first_child();
    while (node) {
        const std::string_view name = local_name(node);
        if (name == "speed" && !speed) speed = node.child_value();
        if (name == "course" && !course) course = node.child_value();
        if (node.first_child() && depth < deepest) {
            node = node.first_child();
            ++depth;
            continue;
        }
        while (node != extensions && !node.next_sibling()) {
            node = node.parent();
            --depth;
        }
        if (node == extensions) return;
        node = node.next_sibling();
    }
}

FixType read_fix(const Cell& cell) {
    if (cell.text == "none") return FixType::none;
    if (cell.text == "2d" || cell.text == "3d" || cell.text == "pps") return FixType::single;
    if (cell.text == "dgps") return FixType::dgps;
    return FixType::unknown;
}

/// Nothing for an empty cell.
std::optional<double> real_unless_empty(const Cell& cell, std::string_view meaning) {
    return cell.text.empty() ? std::nullopt : std::optional(read_real(cell, meaning));
}

}  // namespace

Cell PointReader::cell(const Piece& piece, const char* text) const {
    const std::string_view trimmed = trim(text);
    // Compared as numbers, because the text of an element without one is not in the buffer.
    const std::uintptr_t at = reinterpret_cast<std::uintptr_t>(trimmed.data());
    const std::uintptr_t start = reinterpret_cast<std::uintptr_t>(buffer_.data());
    const std::string_view before =
        piece.text.substr(0, at >= start && at - start < buffer_.size() ? at - start : 0);
    const std::size_t line_end = before.rfind('\n');
    return {.text = trimmed,
            .recording = &recording_,
            .line = *piece.place.line + std::count(before.begin(), before.end(), '\n'),
            .column = line_end == std::string_view::npos ? piece.column + before.size()
                                                         : before.size() - line_end};
}

pugi::xml_node PointReader::parse(const Piece& piece) {
    if (piece.text.size() > longest_piece)
        throw Failure(
            place_in(recording_, piece.place),
            fmt::format("the track point is {} bytes long, and so none", piece.text.size()),
            "Take the recording as the receiver wrote it");
    buffer_.assign(piece.text.begin(), piece.text.end());
    const pugi::xml_parse_result result =
        document_.load_buffer_inplace(buffer_.data(), buffer_.size(),
                                      pugi::parse_escapes | pugi::parse_cdata, pugi::encoding_utf8);
    if (!result)
        throw Failure(
            place_in(recording_, *piece.place.line, piece.column),
            fmt::format("the track point is not well-formed XML: {}", result.description()),
            "Hand in the track as the program wrote it, or another export");
    return document_.first_child();
}

PointReader::Texts PointReader::find_texts(pugi::xml_node point) const {
    Texts texts;
    pugi::xml_node extensions;
    for (const pugi::xml_node child : point.children()) {
        const std::string_view name = local_name(child);
        if (name == "ele") texts.height = child.child_value();
        if (name == "geoidheight") texts.geoid_height = child.child_value();
        if (name == "time") texts.time = child.child_value();
        if (name == "fix") texts.fix = child.child_value();
        if (name == "sat") texts.satellites = child.child_value();
        if (name == "speed") texts.speed = child.child_value();
        if (name == "course") texts.course = child.child_value();
        if (name == "extensions") extensions = child;
    }
    if (extensions) find_motion(extensions, texts.speed, texts.course);
    return texts;
}

void PointReader::read_time(const Piece& piece, const char* text, TimedRow& row) {
    if (!text) {
        ++counts_.without_time;
        throw Failure(place_in(recording_, *piece.place.line, piece.column),
                      "the track point has no time", "Export the track with times");
    }
    const Cell time = cell(piece, text);
    row.written.time = time.text;
    if (!zone_of(time.text)) ++counts_.without_zone;
    row.instant = read_iso(time, Clock::utc);
}

/// Above the ellipsoid, where the geoid's height above it is recorded too.
double PointReader::read_height(const Piece& piece, const Texts& texts) {
    const double height_m = read_real(cell(piece, texts.height), "height");
    std::optional<double> geoid_m;
    if (texts.geoid_height)
        geoid_m = real_unless_empty(cell(piece, texts.geoid_height), "geoid height");
    return height_m + geoid_m.value_or(0.0);
}

void PointReader::read_position(const Piece& piece, pugi::xml_node point, const Texts& texts,
                                TimedRow& row) {
    const pugi::xml_attribute latitude = point.attribute("lat"), longitude = point.attribute("lon");
    if (!latitude || !longitude)
        throw Failure(place_in(recording_, *piece.place.line, piece.column),
                      fmt::format("the track point has no {}", latitude ? "lon" : "lat"),
                      "Hand in the track as the program wrote it, or another export");
    const Cell latitude_cell = cell(piece, latitude.value());
    const Cell longitude_cell = cell(piece, longitude.value());
    const bool has_height = texts.height && !trim(texts.height).empty();
    const Cell height_cell = has_height ? cell(piece, texts.height) : latitude_cell;
    const Geodetic position{Angle::from_degrees(read_real(latitude_cell, "latitude")),
                            Angle::from_degrees(read_real(longitude_cell, "longitude")),
                            has_height ? read_height(piece, texts) : 0.0};
    set_position(row.observation,
                 checked_geodetic(position, latitude_cell, longitude_cell, height_cell));
    if (!has_height) row.observation.height_m.reset();
    row.written.unit = CoordinateUnit::degree;
    row.written.coordinates = {latitude_cell.text, longitude_cell.text};
}

void PointReader::read_velocity(const Piece& piece, const Texts& texts, Observation& row) {
    if (!texts.speed) return;
    const auto speed_m_s = real_unless_empty(cell(piece, texts.speed), "speed");
    if (!speed_m_s) return;
    std::optional<double> course_deg;
    if (texts.course) course_deg = real_unless_empty(cell(piece, texts.course), "course");
    set_speed(row, *speed_m_s, course_of(course_deg));
}

TimedRow PointReader::read(const Piece& piece) {
    const pugi::xml_node point = parse(piece);
    const Texts texts = find_texts(point);
    TimedRow row;
    read_time(piece, texts.time, row);
    if (texts.fix) row.observation.fix = read_fix(cell(piece, texts.fix));
    if (texts.satellites) {
        const Cell count = cell(piece, texts.satellites);
        if (!count.text.empty()) row.observation.satellites = read_satellites(count);
    }
    if (row.observation.fix == FixType::none) return row;
    read_position(piece, point, texts, row);
    read_velocity(piece, texts, row.observation);
    return row;
}

}  // namespace runcert::gpx
