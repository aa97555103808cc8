#include <nlohmann/json.hpp>

#include "core/plain_text.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/export/window_words.h"

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
    if (number)
        if (const auto whole = parse_integer(fact.value)) return *whole;
    if (number)
        if (const auto real = parse_double(fact.value)) return *real;
    return plain_text(fact.value);
}

void add_feature(Json& features, const MapFeature& feature, const std::vector<TrackPoint>& points) {
    if (points.empty()) return;
    Json properties{{"name", plain_text(feature.name)}};
    for (const MapFact& fact : feature.facts)
        properties[fact.name] = fact_value(fact);
    properties["stroke"] = "#" + feature.style.rgb;
    properties["stroke-width"] = feature.style.width;
    features.push_back({{"type", "Feature"},
                        {"properties", std::move(properties)},
                        {"geometry", geometry(points)}});
}

}  // namespace

std::string geojson_text(const Track& track) {
    Json features = Json::array();
    for (const TrackArc& arc : track.arcs)
        add_feature(features, {name_of(arc), track_style, facts_of(arc)}, arc.points);
    for (const TrackGate& gate : track.gates)
        add_feature(features, {name_of(gate), gate_style, {{"kind", "", "gate"}}},
                    {gate.left, gate.right});
    for (const TrackWindow& window : track.windows)
        add_feature(features, {name_of(window), style_of(window), facts_of(window)}, window.points);
    Json lines = Json::array();
    for (const std::string& line : about(track))
        lines.push_back(plain_text(line));
    const Json collection{{"type", "FeatureCollection"},
                          {"name", plain_text(track.attempt)},
                          {"about", std::move(lines)},
                          {"features", std::move(features)}};
    return collection.dump(1) + "\n";
}

}  // namespace runcert
