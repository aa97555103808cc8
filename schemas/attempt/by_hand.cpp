#include "schemas/attempt/by_hand.h"

#include <fmt/format.h>

#include "core/speed_unit.h"
#include "core/text.h"

namespace runcert {
template <>
StatedFrame read_members(const YamlValue& frame) {
    if (frame.is_map())
        return {.kind = CoordinateFrame::utm,
                .utm_zone = UtmZone{.zone = static_cast<int>(frame["utm"]["zone"].integer()),
                                    .northern = frame["utm"]["hemisphere"].text() == "north"}};
    StatedFrame stated;
    if (!from_text(frame.text(), stated.kind))
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
    if (map["east_m"].exists())
        return {.geodetic = std::nullopt,
                .plane_m = std::array{map["east_m"].real(), map["north_m"].real()}};
    return {.geodetic = Geodetic{.latitude = Angle::from_degrees(map["latitude_deg"].real()),
                                 .longitude = Angle::from_degrees(map["longitude_deg"].real()),
                                 .height_m = 0.0},
            .plane_m = std::nullopt};
}

template <>
SecondaryMethod read_members(const YamlValue& map) {
    SecondaryMethod secondary{.method = map["method"].text(),
                              .source = map["source"].text(),
                              .speed = std::nullopt,
                              .times = std::nullopt};
    if (map["speed"].exists()) {
        const double unit = metres_per_second(map["unit"].text());
        secondary.speed = {.speed_m_s = map["speed"].real() * unit,
                           .expanded_uncertainty_m_s = map["expanded_uncertainty"].real() * unit};
    }
    if (map["start_utc"].exists())
        secondary.times = {.start = read_utc_time(map["start_utc"]),
                           .finish = read_utc_time(map["finish_utc"]),
                           .expanded_uncertainty_s = map["time_expanded_uncertainty_s"].real()};
    return secondary;
}

}  // namespace runcert
