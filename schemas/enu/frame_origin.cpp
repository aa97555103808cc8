#include "schemas/enu/frame_origin.h"

#include <nlohmann/json.hpp>

namespace runcert {

template <>
nlohmann::ordered_json members_json(const FrameOrigin& origin) {
    return {{"latitude_deg", origin.position.latitude.degrees()},
            {"longitude_deg", origin.position.longitude.degrees()},
            {"height_m", origin.position.height_m},
            {"source", origin.source}};
}

template <>
FrameOrigin read_members(const YamlValue& origin) {
    return {.position = {.latitude = Angle::from_degrees(origin["latitude_deg"].real()),
                         .longitude = Angle::from_degrees(origin["longitude_deg"].real()),
                         .height_m = origin["height_m"].real()},
            .source = origin["source"].text()};
}

}  // namespace runcert
