#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodesy.h"
#include "core/gps_time.h"
#include "schemas/common/header.h"

namespace runcert {

struct Official {
    std::string role;
    std::string name;  ///< empty where not given
    std::string key;   ///< empty where not given
};

/// Coordinates of a CSV recording.
enum class CoordinateFrame { geodetic, ecef, utm, local_plane };
std::string_view to_text(CoordinateFrame frame);

/// Standard deviation of each coordinate (m), as the attempt states it.
struct AttemptAccuracy {
    double horizontal_m = 0.0;
    std::optional<double> vertical_m;
};

struct Receiver {
    std::string id;
    std::string recording;                       ///< as written, relative to the attempt
    std::string format;                          ///< "auto", "rtklib-pos", "csv"
    std::optional<CoordinateFrame> frame;        ///< of a CSV
    std::optional<UtmZone> utm_zone;             ///< where frame is utm
    std::map<std::string, std::string> columns;  ///< of a CSV: what -> header name or number
    std::string time_format;  ///< "seconds", "seconds_of_week", "unix", "iso", "time_of_day"
    std::string time_scale;   ///< "gps", "utc"
    std::string delimiter;    ///< "comma", "tab", "semicolon", "auto"
    std::optional<GpsTime> start_gps;
    std::optional<double> height_m;
    std::optional<AttemptAccuracy> accuracy;
    std::optional<double> antenna_height_m;
    /// From the antenna to the craft's reference point (m): forward, right, down.
    std::optional<Eigen::Vector3d> lever_arm;
    /// Largest change of the craft's attitude, about any axis, between the ends of a window.
    std::optional<double> rotation_bound_deg = std::nullopt;
    std::string place;  ///< "file:line:column" of this receiver in the attempt, for messages
};

/// A speed in the unit it was given in.
struct Record {
    double speed = 0.0;
    std::string unit;  ///< "km/h", "m/s", "kn", "mph"
    std::string source;
};

/// An attempt, `schemas/attempt/v1.yaml`.
struct Attempt {
    std::string id;
    std::string craft_name;
    std::string craft_class;
    std::string place;  ///< empty where not given
    std::string date;   ///< empty where not given
    std::vector<Official> officials;
    std::vector<Receiver> receivers;  ///< at least one; the first is the one that is judged
    std::optional<Geodetic> origin;
    std::optional<Record> record;
    std::vector<std::string> profiles;
    /// For each stage, every parameter resolved: the attempt's figure, or the default of the
    /// craft's class.
    std::map<std::string, nlohmann::ordered_json> parameters;
    /// Paths of the parameters that the attempt sets itself ("smooth.jerk_density").
    std::vector<std::string> overrides;
};

/// Reads and checks an attempt. Failure with file, line, column and remedy on any deviation from
/// the schema, two receivers with one id, an unusable id, or a bad date.
Attempt read_attempt(std::string_view text, const std::string& where);

const DocumentSchema& attempt_schema();

/// The name by which a profile claimed in an attempt is known in the run folder: "nalsa" of
/// "nalsa", "my-rule" of "rules/my-rule.yaml".
std::string profile_name(const std::string& claimed);

}  // namespace runcert
