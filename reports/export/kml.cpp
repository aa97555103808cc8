#include <fmt/format.h>

#include <pugixml.hpp>
#include <sstream>

#include "core/plain_text.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/export/html_text.h"
#include "reports/export/window_words.h"

namespace runcert {
namespace {

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(plain_text(text).c_str());
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

void add_placemark(pugi::xml_node folder, const MapFeature& feature,
                   const std::vector<TrackPoint>& points) {
    if (points.empty()) return;
    pugi::xml_node placemark = folder.append_child("Placemark");
    add_text(placemark, "name", feature.name);
    std::string description;  // programs take it for HTML
    for (const MapFact& fact : feature.facts)
        if (!fact.label.empty())
            description += fmt::format("{}: {}<br/>\n", fact.label, html_text(fact.value));
    placemark.append_child("description").text().set(description.c_str());
    pugi::xml_node line = placemark.append_child("Style").append_child("LineStyle");
    add_text(line, "color", kml_colour(feature.style.rgb));
    add_text(line, "width", std::to_string(feature.style.width));
    const bool single = points.size() == 1;
    pugi::xml_node geometry = placemark.append_child(single ? "Point" : "LineString");
    if (!single) add_text(geometry, "tessellate", "1");
    add_text(geometry, "altitudeMode", "clampToGround");
    geometry.append_child("coordinates").text().set(coordinates(points).c_str());
}

pugi::xml_node add_folder(pugi::xml_node document, const char* name) {
    pugi::xml_node folder = document.append_child("Folder");
    add_text(folder, "name", name);
    return folder;
}

}  // namespace

std::string kml_text(const Track& track) {
    pugi::xml_document xml;
    pugi::xml_node declaration = xml.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node kml = xml.append_child("kml");
    kml.append_attribute("xmlns") = "http://www.opengis.net/kml/2.2";
    pugi::xml_node document = kml.append_child("Document");
    add_text(document, "name", track.attempt);
    std::string description;
    for (const std::string& line : about(track))
        description += html_text(line) + "<br/>\n";
    document.append_child("description").text().set(description.c_str());
    if (!track.windows.empty()) {
        pugi::xml_node windows = add_folder(document, "windows");
        for (const TrackWindow& window : track.windows)
            add_placemark(windows, {name_of(window), style_of(window), facts_of(window)},
                          window.points);
    }
    if (!track.gates.empty()) {
        pugi::xml_node gates = add_folder(document, "course");
        for (const TrackGate& gate : track.gates)
            add_placemark(gates, {name_of(gate), gate_style, {}}, {gate.left, gate.right});
    }
    pugi::xml_node arcs = add_folder(document, "track");
    for (const TrackArc& arc : track.arcs)
        add_placemark(arcs, {name_of(arc), track_style, facts_of(arc)}, arc.points);
    std::ostringstream out;
    xml.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

}  // namespace runcert
