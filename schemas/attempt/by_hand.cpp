#include "schemas/attempt/by_hand.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/speed_unit.h"
#include "core/text.h"
#include "schemas/common/enum_text.h"

namespace runcert {
namespace {

constexpr EnumWords<CoordinateFrame, 4> frame_words{
    {{CoordinateFrame::geodetic, "geodetic"},
     {CoordinateFrame::ecef, "ecef"},
     {CoordinateFrame::utm, "utm"},
     {CoordinateFrame::local_plane, "local_plane"}}};

}  // namespace

std::string_view to_text(CoordinateFrame frame) {
    return word_of(frame_words, frame);
}

template <>
StatedFrame read_members(const YamlValue& frame) {
    if (frame.is_map())
        return {.kind = CoordinateFrame::utm,
                .utm_zone = UtmZone{.zone = static_cast<int>(frame["utm"]["zone"].integer()),
                                    .northern = frame["utm"]["hemisphere"].text() == "north"}};
    StatedFrame stated;
    if (!value_of(frame_words, frame.text(), stated.kind))
        frame.fail(fmt::format("\"{}\" is not a frame", escape_for_message(frame.text())),
                   "Use geodetic, ecef, local_plane, or utm: {zone: 55, hemisphere: south}");
    if (stated.kind == CoordinateFrame::utm)
        frame.fail("UTM coordinates need their zone and hemisphere",
                   "Write frame: {utm: {zone: 55, hemisphere: south}}");
    return stated;
}

template <>
CsvColumns read_members(const YamlValue& map) {
    CsvColumns columns;
    for (const std::string& key : map.keys())
        if (map[key].exists()) columns[key] = map[key].text();
    return columns;
}

template <>
CoursePoint read_members(const YamlValue& map) {
    const bool on_earth = map["latitude_deg"].exists() && map["longitude_deg"].exists();
    const bool in_plane = map["east_m"].exists() && map["north_m"].exists();
    if (on_earth == in_plane || map.keys().size() != 2)
        map.fail("a point has two coordinates",
                 "Give latitude_deg and longitude_deg, or east_m and north_m");
    if (in_plane)
        return {.geodetic = std::nullopt,
                .plane_m = std::array{map["east_m"].real(), map["north_m"].real()}};
    return {.geodetic = Geodetic{.latitude = Angle::from_degrees(map["latitude_deg"].real()),
                                 .longitude = Angle::from_degrees(map["longitude_deg"].real()),
                                 .height_m = 0.0},
            .plane_m = std::nullopt};
}

template <>
StatedPart read_members(const YamlValue& map) {
    StatedPart part{.from = read_utc_time(map["from_utc"]),
                    .to = read_utc_time(map["to_utc"]),
                    .source = map["source"].text()};
    if (!(part.to > part.from))
        map["to_utc"].fail("the part that counts ends before it begins", "Correct the times");
    return part;
}

template <>
SecondaryMethod read_members(const YamlValue& map) {
    const auto all_of = [&map](std::initializer_list<const char*> keys) {
        const auto given = std::count_if(keys.begin(), keys.end(),
                                         [&map](const char* key) { return map[key].exists(); });
        if (given != 0 && given != std::ssize(keys))
            map.fail(fmt::format("{} belong together", fmt::join(keys, ", ")), "Give all of them");
        return given != 0;
    };
    SecondaryMethod secondary{.method = map["method"].text(),
                              .source = map["source"].text(),
                              .speed = std::nullopt,
                              .times = std::nullopt};
    if (all_of({"speed", "unit", "expanded_uncertainty"})) {
        const double unit = metres_per_second(map["unit"].text());
        secondary.speed = {.speed_m_s = map["speed"].real() * unit,
                           .expanded_uncertainty_m_s = map["expanded_uncertainty"].real() * unit};
    }
    if (all_of({"start_utc", "finish_utc", "time_expanded_uncertainty_s"}))
        secondary.times = {.start = read_utc_time(map["start_utc"]),
                           .finish = read_utc_time(map["finish_utc"]),
                           .expanded_uncertainty_s = map["time_expanded_uncertainty_s"].real()};
    if (secondary.speed.has_value() == secondary.times.has_value())
        map.fail("a second method says a speed, or two times",
                 "Give speed, unit and expanded_uncertainty; or start_utc, finish_utc and "
                 "time_expanded_uncertainty_s");
    if (secondary.times && !(secondary.times->finish > secondary.times->start))
        map["finish_utc"].fail("the finish is not after the start", "Correct the times");
    return secondary;
}

}  // namespace runcert
