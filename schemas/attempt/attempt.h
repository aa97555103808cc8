#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodetic.h"
#include "core/gps_time.h"
#include "files/held_json.h"
#include "schemas/common/header.h"
#include "schemas/common/role_signatures.h"

namespace runcert {

struct Official {
    std::string role;
    std::string name;  ///< empty where not given
    std::string key;   ///< empty where not given
};

/// Coordinates of a CSV recording.
enum class CoordinateFrame { geodetic, ecef, utm, local_plane };
std::string_view to_text(CoordinateFrame frame);

/// Standard deviation of each coordinate (m) or component, as the attempt states it.
struct AttemptAccuracy {
    std::optional<double> horizontal_m = std::nullopt;
    std::optional<double> vertical_m = std::nullopt;
    std::optional<double> velocity_m_s = std::nullopt;  ///< of recorded velocities or speeds
};

struct Receiver {
    std::string id;
    /// As written, relative to the attempt; at least one, each following the one before in time.
    std::vector<std::string> recordings;
    std::string format;                          ///< "auto", "rtklib-pos", "csv", ...
    std::string gpsbabel_type;                   ///< empty where not given
    std::string base;                            ///< of RINEX; empty where not given
    std::vector<std::string> navigation;         ///< of RINEX, and of `phase`
    std::string phase;                           ///< raw measurements; empty where not given
    std::optional<Geodetic> base_position;       ///< of RINEX
    std::string solution_pass;                   ///< of RINEX: "forward", "backward"
    std::optional<CoordinateFrame> frame;        ///< of a CSV
    std::optional<UtmZone> utm_zone;             ///< where frame is utm
    std::map<std::string, std::string> columns;  ///< of a CSV: what -> header name or number
    std::string time_format;  ///< "seconds", "seconds_of_week", "unix", "iso", "time_of_day"
    std::string time_scale;   ///< "gps", "utc", "local"; empty where not given: "gps"
    std::string speed_unit;   ///< "km/h", ...; empty where not given
    std::string delimiter;    ///< "auto", "comma", "tab", ...
    std::optional<double> utc_offset_h;  ///< local time less UTC
    std::string start_date;              ///< UTC date "2023-07-11"; empty where not given
    std::optional<GpsTime> start_gps;
    std::optional<double> height_m;
    std::optional<AttemptAccuracy> accuracy;
    std::string solution;     ///< kind, where the recording does not say; empty where not given
    std::string time_source;  ///< "satellites" where the attempt says so; empty where not given
    std::optional<double> antenna_height_m;
    /// From the antenna to the craft's reference point (m): forward, right, down.
    std::optional<std::array<double, 3>> lever_arm;
    /// Largest change of the craft's attitude, about any axis, between the ends of a window.
    std::optional<double> rotation_bound_deg = std::nullopt;
    /// How the recording is to be read, as the attempt has it: all but the names of receiver and
    /// files, and what is said of the antenna's place on the craft.
    HeldJson stated = {};
    std::string place;  ///< "file:line:column" of this receiver in the attempt, for messages
};

/// Whether raw phases are handed in: in a file of their own, or as a RINEX recording.
inline bool has_phases(const Receiver& receiver) {
    return !receiver.phase.empty() || !receiver.base.empty();
}

/// A speed in the unit it was given in.
struct Record {
    double speed = 0.0;
    std::string unit;  ///< "km/h", "m/s", "kn", "mph"
    std::string source;
    double expanded_uncertainty = 0.0;  ///< k = 2, in that unit; zero where none is given
};

/// A figure of a profile that the attempt replaces.
struct ReplacedFigure {
    std::string profile;
    std::string figure;
    double value = 0.0;  ///< in the profile's unit
    std::string reason;  ///< empty where not given
    std::string place;   ///< "file:line:column", for messages
};

/// A point on the ground: in geodetic coordinates, or in the recording's engineering CRS.
struct CoursePoint {
    std::optional<Geodetic> geodetic;              ///< its height is not known, and zero
    std::optional<std::array<double, 2>> plane_m;  ///< east, north
};

/// A surveyed line across the course, its ends seen along the course.
struct CourseLine {
    CoursePoint left, right;
};

struct Course {
    CourseLine start, finish;
    double length_m = 0.0;
    double length_expanded_uncertainty_m = 0.0;  ///< k = 2
    std::string place;                           ///< "file:line:column", for messages
};

/// A series that the attempt hands in: wind, current, the speed of a wheel, passages of gates.
struct SeriesFile {
    std::string file;
    std::string source;
    double expanded_uncertainty_m_s = 0.0;    ///< of a current, k = 2
    double expanded_uncertainty_m = 0.0;      ///< of the distance of a gate, k = 2
    double expanded_uncertainty_s = 0.0;      ///< of the time of a passage, k = 2
    std::optional<double> scale = {};         ///< of a wheel, as calibrated
    double expanded_uncertainty_scale = 0.0;  ///< of that, relative, k = 2
    std::string place;                        ///< "file:line:column", for messages
};

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

/// The earlier report that the attempt's replaces.
struct AmendedReport {
    std::string report_id;  ///< 16 hexadecimal digits
    std::string sha256;     ///< of its report.json
    std::string reason;
};

/// Something that the attempt says or hands in, and that can change what is certified.
struct AttemptInput {
    std::string name;     ///< "receivers.primary.solution", "records.nalsa.speed"
    std::string profile;  ///< whose it is alone; empty for that of every profile
    FieldOrigin origin;   ///< as its field declares it
    std::string value;    ///< as the attempt has it, with its unit
};

/// An attempt, `schemas/attempt/v1.yaml`.
struct Attempt {
    std::string id;
    std::string craft_name;
    std::string craft_class;
    std::string place;  ///< empty where not given
    std::string date;   ///< empty where not given
    std::vector<Official> officials;
    std::vector<RoleSignatures> signatures;
    std::optional<AmendedReport> amends;
    std::int64_t attempts_made = 1;   ///< of which this one is put forward
    std::vector<Receiver> receivers;  ///< at least one; the first is the one that is judged
    std::optional<Geodetic> origin;
    std::optional<Record> record;
    std::map<std::string, Record> records;  ///< by profile
    std::vector<ReplacedFigure> rules;
    std::optional<Course> course;
    std::optional<SeriesFile> wind;
    std::optional<SeriesFile> current;
    std::optional<SeriesFile> wheel;
    std::optional<SeriesFile> gates;
    std::optional<SecondaryMethod> secondary_method;
    std::vector<std::string> profiles;
    /// For each stage, every parameter resolved: the attempt's figure, or the default of the
    /// craft's class.
    std::map<std::string, HeldJson> parameters;
    /// Paths of the parameters that the attempt sets itself ("smooth.jerk_density").
    std::vector<std::string> overrides;
    /// Everything in it that its fields declare to change something and that is not the default, in
    /// the order of the file. What changes the outcome is stated where its default holds, too.
    std::vector<AttemptInput> inputs;

    /// The record to beat under the profile of that name; null where there is none.
    const Record* record_for(const std::string& profile) const;
};

/// Reads and checks an attempt. Failure with file, line, column and remedy on any deviation from
/// the schema, two receivers with one id, an unusable id, or a bad date.
Attempt read_attempt(std::string_view text, const std::string& where);

const DocumentSchema& attempt_schema();

/// The names of a receiver's recordings, without folders, "a.nmea, b.nmea".
std::string recording_names(const Receiver& receiver);

/// The name by which a profile claimed in an attempt is known in the run folder: "nalsa" of
/// "nalsa", "my-rule" of "rules/my-rule.yaml".
std::string profile_name(const std::string& claimed);

}  // namespace runcert
