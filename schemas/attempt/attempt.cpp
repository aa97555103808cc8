#include "schemas/attempt/attempt.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/attempt/inputs.h"
#include "schemas/common/document.h"

namespace runcert {

YamlNode attempt_field_table_node();

namespace {

bool is_hexadecimal(const std::string& text, std::size_t digits) {
    return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

/// The parameters of a stage of which it counts that the attempt states them.
std::vector<std::string> stated_before_rule(const Attempt& attempt, std::string_view stage) {
    std::vector<std::string> stated;
    for (const std::string& path : attempt.overrides) {
        const std::string field = "parameters." + path;
        if (attempt_schema().find(field)->before_rule && attempt_schema().is_read_by(field, stage))
            stated.push_back(path);
    }
    return stated;
}

void require_amended(const YamlValue& value, const AmendedReport& amends) {
    if (!is_hexadecimal(amends.report_id, 16))
        value["report_id"].fail("a report id is 16 hexadecimal digits in lower case",
                                "Copy it from the head of the earlier report");
    if (!is_hexadecimal(amends.sha256, 64))
        value["sha256"].fail("a SHA-256 is 64 hexadecimal digits in lower case",
                             "Copy what `sha256sum report.json` prints of the earlier report");
}

/// What of a receiver's description says how its recording is read.
nlohmann::ordered_json reading_of(const YamlValue& entry) {
    nlohmann::ordered_json stated = json_from_yaml(entry);
    for (const char* other :
         {"id", "recording", "base", "navigation", "phase", "imu", "surface", "antenna_height_m",
          "lever_arm_m", "antenna_motion", "rotation_bound_deg", "calibration", "device_deduction",
          "instrument"})
        stated.erase(other);
    return stated;
}

/// The same of what stands beside them under a key ("imu"), but for the names of its files.
void take_beside(const YamlValue& list, const char* key, std::map<std::string, HeldJson>& stated) {
    for (const YamlValue& entry : list.list()) {
        if (!entry[key].exists()) continue;
        nlohmann::ordered_json beside = json_from_yaml(entry[key]);
        for (const char* file : {"file", "triangles"})
            beside.erase(file);
        stated[entry["id"].text()] = beside;
    }
}

void take_all_beside(const YamlValue& list, Attempt& attempt) {
    take_beside(list, "imu", attempt.stated_imus);
    take_beside(list, "surface", attempt.stated_surfaces);
}

/// An uncertainty is of something, and in a unit of that.
void require_sound_calibration(const YamlValue& map, const Calibration& calibration) {
    const bool stated = calibration.expanded_uncertainty.has_value();
    if (stated != map["unit"].exists() || stated != map["of"].exists())
        map.fail("the uncertainty of a calibration, its unit and what it is of belong together",
                 "Give expanded_uncertainty, unit and of, or none of the three");
    if (!stated) return;
    const std::string own = calibration.quantity == "time"       ? "s"
                            : calibration.quantity == "distance" ? "m"
                                                                 : "";
    const bool fits =
        own.empty() ? calibration.unit != "s" && calibration.unit != "m" : calibration.unit == own;
    if (!fits)
        map["unit"].fail(
            fmt::format("\"{}\" is no unit of a {}", calibration.unit, calibration.quantity),
            own.empty() ? "Give km/h, m/s, kn or mph" : "Give " + own);
}

/// The axes of an IMU are three of the craft's, each once, and no mirror image of them.
void require_sound_axes(const YamlValue& map, const ImuAxes& axes) {
    const CraftDirection x = direction_of(axes.x), y = direction_of(axes.y),
                         z = direction_of(axes.z);
    if (x.component == y.component || y.component == z.component || z.component == x.component)
        map.fail("two axes of the IMU point along one axis of the craft",
                 "Give forward, right and down once each, with a minus sign where an axis points "
                 "the other way");
    const bool cyclic = y.component == (x.component + 1) % 3;
    if ((cyclic ? 1.0 : -1.0) * x.sign * y.sign * z.sign < 0.0)
        map.fail("the axes of the IMU are left-handed, a mirror image of those of any IMU",
                 fmt::format("Correct a sign or exchange two axes: with these x and y, z is {}",
                             to_text(static_cast<CraftAxis>(static_cast<int>(axes.z) ^ 1))));
}

void require_sound_imu(const YamlValue& entry, const Receiver& receiver) {
    if (!receiver.imu) return;
    const Imu& imu = *receiver.imu;
    if (receiver.lever_arm)
        entry["lever_arm_m"].fail(
            "the receiver has an IMU, from which places on the craft are counted",
            "Remove lever_arm_m; in imu: give antenna_m, from the IMU to the antenna, and "
            "reference_point_m, from the IMU to the craft's reference point");
    if (imu.axes) require_sound_axes(entry["imu"]["axes"], *imu.axes);
    if (!imu.columns.empty() && !imu.columns.contains("time") && !(imu.rate_hz && imu.start_gps))
        entry["imu"]["columns"].fail("no column has the times of the IMU's samples",
                                     "Name the column of the time; or give rate_hz, and start_gps, "
                                     "the GPS time of the first sample");
}

/// A surface whose file does not say its heights needs them from the attempt.
void require_sound_heights(const YamlValue& map, const Surface& surface) {
    const bool geoid = surface.heights == SurfaceHeights::geoid;
    if (geoid && !surface.undulation)
        map.fail("heights above the geoid need the height of the geoid above the ellipsoid",
                 "Add undulation_m, as a geoid model gives it for the course");
    if (!geoid && surface.undulation)
        map["undulation_m"].fail("an undulation belongs to heights above the geoid",
                                 "Write heights: geoid, or remove undulation_m");
    const bool on_earth = surface.frame && surface.frame->kind != CoordinateFrame::local_plane;
    if (on_earth && !surface.heights)
        map.fail("nothing says what the surface's heights are counted from",
                 "Write heights: ellipsoid; or heights: geoid, with undulation_m");
    if (!on_earth && surface.heights)
        map["heights"].fail("heights in the local frame are counted from its origin",
                            "Remove heights and undulation_m");
}

/// Where a surface lies must be comparable with where the receiver's positions lie.
void require_sound_surface(const YamlValue& entry, const Receiver& receiver, bool has_origin) {
    if (!receiver.surface) return;
    const Surface& surface = *receiver.surface;
    const YamlValue map = entry["surface"];
    if (!receiver.antenna_height_m)
        map.fail(
            "without the antenna's height above the ground, positions cannot be compared "
            "with the surface",
            "Add antenna_height_m to the receiver, as measured by tape");
    require_sound_heights(map, surface);
    if (!surface.frame) return;
    if (surface.frame->kind == CoordinateFrame::ecef)
        map["frame"].fail("a surface has plan coordinates and heights",
                          "Use geodetic, local_plane, or utm: {zone: 55, hemisphere: south}");
    const bool plane = surface.frame->kind == CoordinateFrame::local_plane;
    const bool recorded_plane =
        receiver.frame && receiver.frame->kind == CoordinateFrame::local_plane;
    if (recorded_plane && !plane)
        map["frame"].fail(
            "the recording's coordinates are those of an engineering CRS, and the "
            "surface lies elsewhere on the Earth",
            "Give the surface in the recording's CRS, with frame: local_plane");
    if (plane && !recorded_plane && !has_origin)
        map["frame"].fail("the surface is counted from an origin, and the attempt gives none",
                          "Add origin: {latitude_deg, longitude_deg, height_m}");
}

void require_sound_surfaces(const YamlValue& document, const Attempt& attempt) {
    const std::vector<YamlValue> entries = document["receivers"].list();
    for (std::size_t i = 0; i < entries.size(); ++i)
        require_sound_surface(entries[i], attempt.receivers[i], attempt.origin.has_value());
}

void require_sound(const YamlValue& entry, const Receiver& receiver) {
    require_sound_imu(entry, receiver);
    if (receiver.calibration)
        require_sound_calibration(entry["calibration"], *receiver.calibration);
    if (receiver.antenna_motion && (receiver.lever_arm || receiver.imu))
        entry["antenna_motion"].fail(
            fmt::format("the motion of the antenna is known from {} already",
                        receiver.imu ? "imu" : "lever_arm_m"),
            fmt::format("Remove antenna_motion or {}", receiver.imu ? "imu" : "lever_arm_m"));
    if (receiver.rotation_bound_deg && !receiver.lever_arm && !receiver.imu)
        entry["rotation_bound_deg"].fail(
            "the craft's rotation is bounded, but no lever arm is given for it to act on",
            "Add lever_arm_m: {forward, right, down}, or remove rotation_bound_deg");
    const auto& accuracy = receiver.accuracy;
    if (accuracy && !accuracy->horizontal_m && !accuracy->vertical_m && !accuracy->velocity_m_s)
        entry["accuracy"].fail(
            "the accuracy states nothing",
            "Add horizontal_m, vertical_m or velocity_mps, what the recording leaves out");
}

void require_sound_receivers(const YamlValue& list, Attempt& attempt) {
    const std::vector<Receiver>& receivers = attempt.receivers;
    std::set<std::string> ids;
    const std::vector<YamlValue> entries = list.list();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        require_sound(entries[i], receivers[i]);
        attempt.stated[receivers[i].id] = reading_of(entries[i]);
        if (!ids.insert(receivers[i].id).second)
            entries[i]["id"].fail(fmt::format("two receivers have the id \"{}\"", receivers[i].id),
                                  "Give each receiver an id of its own");
    }
    if (receivers.empty() || receivers.size() > 2)
        list.fail(fmt::format("{} receivers are listed", receivers.size()),
                  "List one receiver, or a primary and a secondary one");
}

/// A typed height is part of every length: within what there is where craft of the class run.
void require_heights(const YamlValue& receivers, const std::string& craft_class) {
    const YamlValue limits =
        attempt_schema().source()["fields"]["receivers[].height_m"]["limits"][craft_class];
    const double lowest_m = limits.list().at(0).real(), highest_m = limits.list().at(1).real();
    for (const YamlValue& entry : receivers.list()) {
        const auto height_m = entry["height_m"].optional_real();
        if (height_m && (*height_m < lowest_m || *height_m > highest_m))
            entry["height_m"].fail(
                fmt::format("no {} runs at a height of {:g} m: it is from {:g} m to {:g} m",
                            craft_class, *height_m, lowest_m, highest_m),
                "Give the course's height above the ellipsoid in metres, from a map or a receiver "
                "that records heights");
    }
}

/// The stages that have parameters, with these resolved.
void add_parameters(const YamlValue& stated, Attempt& attempt, YamlBuilder& builder) {
    const auto names_in = [](const std::string& path) {
        std::vector<std::string> names;
        for (const FieldRule& rule : attempt_schema().fields())
            if (rule.path.starts_with(path + ".") && !rule.path.ends_with("[]") &&
                rule.path.find('.', path.size() + 1) == std::string::npos)
                names.push_back(rule.path.substr(path.size() + 1));
        return names;
    };
    builder.begin(YamlKind::map, stated.node().mark());
    for (const std::string& stage : names_in("parameters")) {
        builder.scalar(stage, false, {});
        builder.begin(YamlKind::map, {});
        for (const std::string& name : names_in("parameters." + stage)) {
            YamlValue value = stated[stage][name];
            const YamlValue& usual =
                attempt_schema().find("parameters." + stage + "." + name)->default_value;
            if (value.exists())
                attempt.overrides.push_back(stage + "." + name);
            else
                value = usual.is_map() ? usual[attempt.craft.kind] : usual;
            if (!value.exists()) continue;
            builder.scalar(name, false, {});
            builder.copy(value.node());
        }
        (void)builder.end();
    }
    (void)builder.end();
}

void resolve_parameters(const YamlValue& document, Attempt& attempt) {
    YamlBuilder builder;
    builder.begin(YamlKind::map, document.node().mark());
    for (const std::string& key : document.keys()) {
        if (key == "parameters") continue;
        builder.scalar(key, false, {});
        builder.copy(document[key].node());
    }
    builder.scalar("parameters", false, {});
    add_parameters(document["parameters"], attempt, builder);
    (void)builder.end();
    attempt.resolved = YamlValue(std::move(builder).take(), document.where());
    attempt.parameters = read_members<Parameters>(attempt.resolved["parameters"]);
}

/// The interval that the correlation time of a time-correlated position error is looked for in.
void require_error_times(const YamlValue& smooth, const SmoothParameters& resolved) {
    const double shortest = resolved.error_time_min_s;
    const double longest = resolved.error_time_max_s;
    if (longest > shortest) return;
    const bool stated = smooth["error_time_max_s"].exists();
    smooth[stated ? "error_time_max_s" : "error_time_min_s"].fail(
        fmt::format("the correlation time is looked for from {} s to {} s", shortest, longest),
        "Give error_time_max_s above error_time_min_s");
}

}  // namespace

std::vector<std::string> claimed_by(const std::string& name) {
    if (name != "gps-speed-sailing" && name != "gps-ice-sailing") return {name};
    std::vector<std::string> all;
    for (const char* const rule :
         {"2s", "10s", "5x10s", "500m", "nautical-mile", "1h", "alpha-500"})
        all.push_back(name + "-" + rule);
    return all;
}

namespace {

std::vector<std::string> read_profiles(const YamlValue& list) {
    std::vector<std::string> profiles;
    std::set<std::string> names;
    for (const YamlValue& entry : list.list()) {
        if (!is_id(profile_name(entry.text())))
            entry.fail(fmt::format("\"{}\" cannot be a profile", escape_for_message(entry.text())),
                       "Give the name of a profile, or a file whose name has letters, digits, - "
                       "and _ and ends in .yaml");
        for (std::string& claimed : claimed_by(entry.text())) {
            if (!names.insert(profile_name(claimed)).second)
                entry.fail("the profile is claimed twice", "Name each profile once");
            profiles.push_back(std::move(claimed));
        }
    }
    if (profiles.empty()) list.fail("no profile is named", "Name at least one, e.g. nalsa");
    return profiles;
}

/// A profile that the attempt claims, by its name or as it is written there.
std::string read_claimed(const YamlValue& name, const Attempt& attempt) {
    const std::string text = name.text();
    for (const std::string& claimed : attempt.profiles)
        if (claimed == text || profile_name(claimed) == text) return profile_name(claimed);
    name.fail(
        fmt::format("the attempt does not claim the profile \"{}\"", escape_for_message(text)),
        "Add it to profiles, or correct the name");
}

void take_records(const YamlValue& list, Attempt& attempt) {
    const std::vector<YamlValue> entries = list.list();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const ProfileRecord& one = attempt.records_by_profile[i];
        const Record record{.speed = one.speed,
                            .unit = one.unit,
                            .source = one.source,
                            .expanded_uncertainty = one.expanded_uncertainty};
        if (!attempt.records.emplace(read_claimed(entries[i]["profile"], attempt), record).second)
            entries[i]["profile"].fail("two records are given for it", "Give one");
    }
}

void require_sound_rules(const YamlValue& list, Attempt& attempt) {
    const std::vector<YamlValue> entries = list.list();
    for (std::size_t i = 0; i < entries.size(); ++i) {
        ReplacedFigure& rule = attempt.rules[i];
        rule.profile = read_claimed(entries[i]["profile"], attempt);
        for (std::size_t k = 0; k < i; ++k)
            if (attempt.rules[k].profile == rule.profile && attempt.rules[k].figure == rule.figure)
                entries[i]["figure"].fail("it is replaced twice", "Replace it once");
    }
}

void require_sound_wheel(const YamlValue& map) {
    if (map["scale"].exists() != map["expanded_uncertainty_scale"].exists())
        map.fail("a wheel's scale and its uncertainty belong together",
                 "Give scale and expanded_uncertainty_scale, or neither");
}

}  // namespace

const DocumentSchema& attempt_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(attempt_field_table_node(), "schemas/attempt/v1.yaml");
    return schema;
}

CraftDirection direction_of(CraftAxis axis) {
    switch (axis) {
        case CraftAxis::forward:
            return {0, 1.0};
        case CraftAxis::backward:
            return {0, -1.0};
        case CraftAxis::right:
            return {1, 1.0};
        case CraftAxis::left:
            return {1, -1.0};
        case CraftAxis::down:
            return {2, 1.0};
        case CraftAxis::up:
            return {2, -1.0};
    }
    return {};
}

std::string recording_names(const Receiver& receiver) {
    std::string names;
    for (const std::string& recording : receiver.recordings)
        names += (names.empty() ? "" : ", ") + recording.substr(recording.find_last_of('/') + 1);
    return names;
}

std::string profile_name(const std::string& claimed) {
    std::string name = claimed.substr(claimed.find_last_of('/') + 1);
    if (name.ends_with(".yaml")) name.resize(name.size() - 5);
    return name;
}

const Record* Attempt::record_for(const std::string& profile) const {
    if (const auto own = records.find(profile); own != records.end()) return &own->second;
    return record ? &*record : nullptr;
}

Attempt part_read_by(const Attempt& attempt, std::string_view stage) {
    const YamlValue document(attempt_schema().part_read_by(attempt.resolved, stage),
                             attempt.resolved.where());
    Attempt part{read_members<AttemptDocument>(document)};
    part.parameters = read_members<Parameters>(document["parameters"]);
    for (const YamlValue& entry : document["receivers"].list())
        part.stated[entry["id"].text()] = reading_of(entry);
    take_all_beside(document["receivers"], part);
    if (!part.profiles.empty()) part.profiles = attempt.profiles;
    if (!part.rules.empty()) part.rules = attempt.rules;
    part.overrides = stated_before_rule(attempt, stage);
    part.resolved = document;
    return part;
}

HeldJson settings_of(const Attempt& attempt, std::string_view stage) {
    auto settings = json_from_yaml(YamlValue(attempt_schema().part_read_by(attempt.resolved, stage),
                                             attempt.resolved.where()));
    if (const auto stated = stated_before_rule(attempt, stage); !stated.empty())
        settings["stated"] = stated;
    return settings;
}

HeldJson parameters_of(const Attempt& attempt, const std::string& stage) {
    const YamlValue own = attempt.resolved["parameters"][stage];
    return own.exists() ? HeldJson(json_from_yaml(own)) : HeldJson();
}

Attempt read_attempt(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, attempt_schema());
    Attempt attempt{read_members<AttemptDocument>(document)};
    attempt.utc_offset_minutes = read_utc_offset(document["utc_offset"]);
    attempt.signatures = read_role_signatures(document["signatures"]);
    if (attempt.amends) require_amended(document["amends"], *attempt.amends);
    require_sound_receivers(document["receivers"], attempt);
    take_all_beside(document["receivers"], attempt);
    require_sound_surfaces(document, attempt);
    require_heights(document["receivers"], attempt.craft.kind);
    attempt.profiles = read_profiles(document["profiles"]);
    take_records(document["records"], attempt);
    require_sound_rules(document["rules"], attempt);
    require_sound_wheel(document["wheel"]);
    resolve_parameters(document, attempt);
    require_error_times(document["parameters"]["smooth"], attempt.parameters.smooth);
    attempt.inputs = inputs_of(document);
    return attempt;
}

}  // namespace runcert
