#include <fmt/format.h>

#include <kainjow/mustache.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <utility>

#include "core/text.h"
#include "reports/export/export.h"
#include "store/ecsv.h"

namespace runcert {
namespace {

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(plain_text(text).c_str());
}

/// Text from outside for what others show as HTML.
std::string html_text(std::string_view text) {
    return kainjow::mustache::html_escape(plain_text(text));
}

/// KML's colours are opacity, blue, green, red.
std::string kml_colour(const std::string& rgb) {
    return "ff" + rgb.substr(4, 2) + rgb.substr(2, 2) + rgb.substr(0, 2);
}

std::string coordinates(const std::vector<TrackPoint>& points) {
    std::string text;
    for (const TrackPoint& point : points) {
        if (!text.empty()) text += ' ';
        text += format_fixed(point.longitude_deg, degree_decimals) + ',' +
                format_fixed(point.latitude_deg, degree_decimals);
        if (point.height_m) text += ',' + format_fixed(*point.height_m, height_decimals);
    }
    return text;
}

void add_placemark(pugi::xml_node folder, const MapFeature& feature) {
    pugi::xml_node placemark = folder.append_child("Placemark");
    add_text(placemark, "name", feature.name);
    std::string description;  // programs take it for HTML
    for (const MapFact& fact : feature.facts)
        description += fmt::format("{}: {}<br/>\n", fact.label, html_text(fact.value));
    placemark.append_child("description").text().set(description.c_str());
    pugi::xml_node line = placemark.append_child("Style").append_child("LineStyle");
    add_text(line, "color", kml_colour(feature.style.rgb));
    add_text(line, "width", std::to_string(feature.style.width));
    const bool single = feature.points.size() == 1;
    pugi::xml_node geometry = placemark.append_child(single ? "Point" : "LineString");
    if (!single) add_text(geometry, "tessellate", "1");
    add_text(geometry, "altitudeMode", "clampToGround");
    geometry.append_child("coordinates").text().set(coordinates(feature.points).c_str());
}

}  // namespace

std::string csv_text(std::string_view table, const std::string& where) {
    EcsvReader reader(table, where);
    const std::vector<EcsvColumn>& columns = reader.columns();
    std::string csv;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (i > 0) csv += ',';
        csv += csv_cell(columns[i].name);
    }
    csv += '\n';
    while (reader.next_row()) {
        for (std::size_t i = 0; i < columns.size(); ++i) {
            if (i > 0) csv += ',';
            if (reader.is_missing(i)) continue;
            const std::string& text = reader.text(i);
            csv += columns[i].type == CellType::text ? csv_cell(text) : text;
        }
        csv += '\n';
    }
    return csv;
}

std::string kml_text(const Track& track) {
    pugi::xml_document xml;
    pugi::xml_node kml = xml.append_child("kml");
    kml.append_attribute("xmlns") = "http://www.opengis.net/kml/2.2";
    pugi::xml_node document = kml.append_child("Document");
    add_text(document, "name", track.attempt);
    std::string description;
    for (const std::string& line : about(track))
        description += html_text(line) + "<br/>\n";
    document.append_child("description").text().set(description.c_str());
    for (const auto& [kind, name] : {std::pair{MapFeature::Kind::windows, "windows"},
                                     std::pair{MapFeature::Kind::course, "course"},
                                     std::pair{MapFeature::Kind::track, "track"}}) {
        const std::vector<MapFeature> features = features_of(track, kind);
        if (features.empty() && kind != MapFeature::Kind::track) continue;
        pugi::xml_node folder = document.append_child("Folder");
        add_text(folder, "name", name);
        for (const MapFeature& feature : features)
            add_placemark(folder, feature);
    }
    std::ostringstream out;
    xml.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

}  // namespace runcert
