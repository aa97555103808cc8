#include <fmt/format.h>
#include <fmt/ranges.h>

#include <kainjow/mustache.hpp>
#include <pugixml.hpp>
#include <sstream>

#include "core/figures.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/run_speeds/run_speeds.h"
#include "store/ecsv.h"

namespace runcert {
namespace {

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(plain_text(text).c_str());
}

/// Programs take it for HTML, so that text from outside is escaped once more.
void add_description(pugi::xml_node parent, const std::vector<std::string>& lines) {
    std::string text;
    for (const std::string& line : lines)
        text += kainjow::mustache::html_escape(plain_text(line)) + "<br/>\n";
    parent.append_child("description").text().set(text.c_str());
}

void add_placemark(pugi::xml_node folder, const MapLine& drawn) {
    pugi::xml_node placemark = folder.append_child("Placemark");
    add_text(placemark, "name", drawn.name);
    std::vector<std::string> lines;
    for (const Fact& fact : drawn.facts)
        lines.push_back(fact.name + ": " + fact.value);
    add_description(placemark, lines);
    pugi::xml_node style = placemark.append_child("Style").append_child("LineStyle");
    // KML's colours are opacity, blue, green, red.
    add_text(style, "color",
             "ff" + drawn.rgb.substr(4, 2) + drawn.rgb.substr(2, 2) + drawn.rgb.substr(0, 2));
    add_text(style, "width", std::to_string(drawn.width));
    const bool single = drawn.points.size() == 1;
    pugi::xml_node geometry = placemark.append_child(single ? "Point" : "LineString");
    if (!single) add_text(geometry, "tessellate", "1");
    add_text(geometry, "altitudeMode", "clampToGround");
    add_text(geometry, "coordinates", fmt::format("{}", fmt::join(drawn.points, " ")));
}

std::string csv_line(const std::vector<std::string>& cells) {
    return fmt::format("{}\n", fmt::join(cells, ","));
}

std::string speed_cell(const std::optional<double>& speed_m_s) {
    return speed_m_s ? format_fixed(*speed_m_s, speed_decimals_kept) : std::string();
}

}  // namespace

std::string kml_text(const RunMap& map) {
    pugi::xml_document xml;
    pugi::xml_node kml = xml.append_child("kml");
    kml.append_attribute("xmlns") = "http://www.opengis.net/kml/2.2";
    pugi::xml_node document = kml.append_child("Document");
    add_text(document, "name", map.name);
    add_description(document, map.about);
    for (const MapFolder& each : map.folders) {
        pugi::xml_node folder = document.append_child("Folder");
        add_text(folder, "name", each.name);
        for (const MapLine& line : each.lines)
            add_placemark(folder, line);
    }
    std::ostringstream out;
    xml.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

std::string csv_text(std::string_view table, const std::string& where) {
    EcsvReader reader(table, where);
    const std::vector<EcsvColumn>& columns = reader.columns();
    std::vector<std::string> cells;
    for (const EcsvColumn& column : columns)
        cells.push_back(csv_cell(column.name));
    std::string csv = csv_line(cells);
    while (reader.next_row()) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            cells[i] = reader.is_missing(i) ? std::string() : reader.text(i);
            if (columns[i].type == CellType::text) cells[i] = csv_cell(cells[i]);
        }
        csv += csv_line(cells);
    }
    return csv;
}

std::string rule_speeds_csv(const TrajectoryTable& trajectory,
                            const std::vector<Profile>& profiles) {
    const auto& first = trajectory.facts.first_epoch;
    std::vector<std::string> cells{"epoch", "time_s", "utc", "speed_m_s"};
    std::vector<std::vector<std::optional<double>>> columns;
    for (const Profile& profile : profiles) {
        auto speeds = speeds_over_length(trajectory, profile);
        if (speeds.empty()) continue;
        cells.push_back(csv_cell("speed_" + profile.id + "_m_s"));
        columns.push_back(std::move(speeds));
    }
    std::string csv = csv_line(cells);
    for (std::size_t k = 0; k < trajectory.rows.size(); ++k) {
        const TrajectoryEpoch& row = trajectory.rows[k];
        cells = {std::to_string(row.epoch), format_fixed(row.time.seconds(), 9),
                 first ? to_utc_iso(first->plus_nanoseconds(row.time.nanoseconds), 3) : "",
                 speed_cell(row.speed_m_s)};
        for (const auto& column : columns)
            cells.push_back(speed_cell(column[k]));
        csv += csv_line(cells);
    }
    return csv;
}

}  // namespace runcert
