#include <fmt/format.h>
#include <fmt/ranges.h>

#include <pugixml.hpp>
#include <sstream>

#include "core/plain_text.h"
#include "core/text.h"
#include "reports/export/export.h"
#include "reports/export/window_words.h"

namespace runcert {
namespace {

constexpr std::int64_t nanoseconds_per_millisecond = 1'000'000;

/// Milliseconds, or all nine decimals where they do not hold the time.
std::string time_text(GpsTime instant) {
    return to_utc_iso(instant, instant.nanoseconds() % nanoseconds_per_millisecond == 0 ? 3 : 9);
}

void add_point(pugi::xml_node segment, const TrackPoint& point) {
    pugi::xml_node node = segment.append_child("trkpt");
    node.append_attribute("lat") = format_fixed(point.latitude_deg, degree_decimals).c_str();
    node.append_attribute("lon") = format_fixed(point.longitude_deg, degree_decimals).c_str();
    if (point.height_m)
        node.append_child("ele").text().set(format_fixed(*point.height_m, height_decimals).c_str());
    if (point.instant) node.append_child("time").text().set(time_text(*point.instant).c_str());
}

}  // namespace

std::string gpx_text(const Track& track) {
    pugi::xml_document xml;
    pugi::xml_node declaration = xml.append_child(pugi::node_declaration);
    declaration.append_attribute("version") = "1.0";
    declaration.append_attribute("encoding") = "UTF-8";
    pugi::xml_node gpx = xml.append_child("gpx");
    gpx.append_attribute("version") = "1.1";
    gpx.append_attribute("creator") = "runcert";
    gpx.append_attribute("xmlns") = "http://www.topografix.com/GPX/1/1";
    pugi::xml_node trk = gpx.append_child("trk");
    trk.append_child("name").text().set(plain_text(track.attempt).c_str());
    trk.append_child("desc").text().set(
        plain_text(fmt::format("{}", fmt::join(about(track), " | "))).c_str());
    for (const TrackArc& arc : track.arcs) {
        pugi::xml_node segment = trk.append_child("trkseg");
        for (const TrackPoint& point : arc.points)
            add_point(segment, point);
    }
    std::ostringstream out;
    xml.save(out, "  ", pugi::format_default, pugi::encoding_utf8);
    return out.str();
}

}  // namespace runcert
