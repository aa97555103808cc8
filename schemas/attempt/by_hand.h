#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/geodetic.h"
#include "core/gps_time.h"
#include "schemas/common/codec.h"
#include "schemas/common/on_craft.h"
#include "schemas/common/role_signatures.h"

// Parts of an attempt that a declaration cannot say: their structs, and their readers.
namespace runcert {

struct StatedFrame {
    CoordinateFrame kind = CoordinateFrame::geodetic;
    std::optional<UtmZone> utm_zone = std::nullopt;  ///< where kind is utm
};
template <>
StatedFrame read_members(const YamlValue& text_or_map);

/// Of a CSV: what -> header name or number.
using CsvColumns = std::map<std::string, std::string>;
template <>
CsvColumns read_members(const YamlValue& map);

/// Of the table of an IMU, the same.
using ImuColumns = CsvColumns;

/// A point on the ground: in geodetic coordinates, or in the recording's engineering CRS.
struct CoursePoint {
    std::optional<Geodetic> geodetic;              ///< its height is not known, and zero
    std::optional<std::array<double, 2>> plane_m;  ///< east, north
};
template <>
CoursePoint read_members(const YamlValue& map);

/// What a second method says of the window: one of the two is given.
struct SecondaryMethod {
    std::string method;
    std::string source;
    struct Speed {
        double speed_m_s = 0.0;
        double expanded_uncertainty_m_s = 0.0;  ///< k = 2
    };
    struct LineTimes {
        GpsTime start, finish;
        double expanded_uncertainty_s = 0.0;  ///< of each, k = 2
    };
    std::optional<Speed> speed;
    std::optional<LineTimes> times;
};
template <>
SecondaryMethod read_members(const YamlValue& map);

}  // namespace runcert
