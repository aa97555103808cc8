#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <sstream>
#include <utility>

#include "core/text.h"
#include "reports/export/export.h"
#include "store/ecsv.h"

namespace runcert {
namespace {

using Json = nlohmann::ordered_json;

/// The number whose shortest text has no more than so many decimals.
double written(double value, int decimals) {
    return parse_double(format_fixed(value, decimals)).value();
}

Json position(const TrackPoint& point) {
    Json json{written(point.longitude_deg, degree_decimals),
              written(point.latitude_deg, degree_decimals)};
    if (point.height_m) json.push_back(written(*point.height_m, height_decimals));
    return json;
}

Json geometry(const std::vector<TrackPoint>& points) {
    if (points.size() == 1) return {{"type", "Point"}, {"coordinates", position(points.front())}};
    Json coordinates = Json::array();
    for (const TrackPoint& point : points)
        coordinates.push_back(position(point));
    return {{"type", "LineString"}, {"coordinates", std::move(coordinates)}};
}

/// What a fact is for programs: a number where its text is one, and its name says a unit or count.
Json fact_value(const MapFact& fact) {
    const bool number = fact.name.ends_with("_m_s") || fact.name.ends_with("_s") ||
                        fact.name.ends_with("_epoch") || fact.name == "arc";
    if (!number) return plain_text(fact.value);
    if (const auto whole = parse_integer(fact.value)) return *whole;
    if (const auto real = parse_double(fact.value)) return *real;
    return plain_text(fact.value);
}

void add_feature(Json& features, const MapFeature& feature) {
    Json properties{{"name", plain_text(feature.name)}};
    for (const MapFact& fact : feature.facts)
        properties[fact.name] = fact_value(fact);
    properties["stroke"] = "#" + feature.style.rgb;
    properties["stroke-width"] = feature.style.width;
    features.push_back({{"type", "Feature"},
                        {"properties", std::move(properties)},
                        {"geometry", geometry(feature.points)}});
}

/// Milliseconds, or all nine decimals where they do not hold the time.
std::string time_text(GpsTime instant) {
    constexpr std::int64_t nanoseconds_per_millisecond = 1'000'000;
    return to_utc_iso(instant, instant.nanoseconds() % nanoseconds_per_millisecond == 0 ? 3 : 9);
}

void add_text(pugi::xml_node parent, const char* name, const std::string& text) {
    parent.append_child(name).text().set(plain_text(text).c_str());
}

void add_point(pugi::xml_node segment, const TrackPoint& point) {
    pugi::xml_node node = segment.append_child("trkpt");
    node.append_attribute("lat") = format_fixed(point.latitude_deg, degree_decimals).c_str();
    node.append_attribute("lon") = format_fixed(point.longitude_deg, degree_decimals).c_str();
    if (point.height_m) add_text(node, "ele", format_fixed(*point.height_m, height_decimals));
    if (point.instant) add_text(node, "time", time_text(*point.instant));
}

pugi::xml_node begin_xml(pugi::xml_document& xml, const char* root) {
    pugi::xml_node declaration = xml.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    return xml.append_child(root);
}

std::string text_of(const pugi::xml_document& xml) {
    std::ostringstream out;
    xml.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

/// Text from outside for what others show as HTML: plain, with &, <, > and quotes as entities.
std::string html_text(std::string_view text) {
    constexpr std::pair<char, std::string_view> entities[] = {
        {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
    std::string html;
    for (const char c : plain_text(text)) {
        const auto* const entity =
            std::ranges::find_if(entities, [c](const auto& one) { return one.first == c; });
        html += entity == std::end(entities) ? std::string_view(&c, 1) : entity->second;
    }
    return html;
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
        if (!fact.label.empty())
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

std::string geojson_text(const Track& track) {
    Json features = Json::array();
    for (const MapFeature::Kind kind :
         {MapFeature::Kind::track, MapFeature::Kind::course, MapFeature::Kind::windows})
        for (const MapFeature& feature : features_of(track, kind))
            add_feature(features, feature);
    Json lines = Json::array();
    for (const std::string& line : about(track))
        lines.push_back(plain_text(line));
    const Json collection{{"type", "FeatureCollection"},
                          {"name", plain_text(track.attempt)},
                          {"about", std::move(lines)},
                          {"features", std::move(features)}};
    return collection.dump(1) + "\n";
}

std::string gpx_text(const Track& track) {
    pugi::xml_document xml;
    pugi::xml_node gpx = begin_xml(xml, "gpx");
    gpx.append_attribute("version") = "1.1";
    gpx.append_attribute("creator") = "runcert";
    gpx.append_attribute("xmlns") = "http://www.topografix.com/GPX/1/1";
    pugi::xml_node trk = gpx.append_child("trk");
    add_text(trk, "name", track.attempt);
    add_text(trk, "desc", fmt::format("{}", fmt::join(about(track), " | ")));
    for (const TrackArc& arc : track.arcs) {
        pugi::xml_node segment = trk.append_child("trkseg");
        for (const TrackPoint& point : arc.points)
            add_point(segment, point);
    }
    return text_of(xml);
}

std::string kml_text(const Track& track) {
    pugi::xml_document xml;
    pugi::xml_node kml = begin_xml(xml, "kml");
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
    return text_of(xml);
}

}  // namespace runcert
