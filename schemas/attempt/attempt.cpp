#include "schemas/attempt/attempt.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
#include "schemas/attempt/attempt_id.h"
#include "schemas/attempt/inputs.h"
#include "schemas/attempt/rule_input.h"
#include "schemas/common/document.h"
#include "schemas/common/enum_text.h"

namespace runcert {

YamlNode attempt_field_table_node();

namespace {

constexpr EnumWords<CoordinateFrame, 4> frame_words{
    {{CoordinateFrame::geodetic, "geodetic"},
     {CoordinateFrame::ecef, "ecef"},
     {CoordinateFrame::utm, "utm"},
     {CoordinateFrame::local_plane, "local_plane"}}};

std::string default_text(std::string_view field) {
    return attempt_schema().find(field)->default_value.text();
}

std::string read_id(const YamlValue& value) {
    std::string id = value.text();
    if (!is_id(id))
        value.fail(fmt::format("\"{}\" cannot be an id", escape_for_message(id)),
                   "Use 1 to 64 letters, digits, - and _, not beginning with -");
    return id;
}

void read_frame(const YamlValue& entry, Receiver& receiver) {
    const YamlValue frame = entry["frame"];
    if (!frame.exists()) return;
    if (frame.is_map()) {
        receiver.frame = CoordinateFrame::utm;
        receiver.utm_zone = UtmZone{.zone = static_cast<int>(frame["utm"]["zone"].integer()),
                                    .northern = frame["utm"]["hemisphere"].text() == "north"};
        return;
    }
    CoordinateFrame value{};
    if (!value_of(frame_words, frame.text(), value))
        frame.fail(fmt::format("\"{}\" is not a frame", escape_for_message(frame.text())),
                   "Use geodetic, ecef, local_plane, or utm: {zone: 55, hemisphere: south}");
    if (value == CoordinateFrame::utm)
        frame.fail("UTM coordinates need their zone and hemisphere",
                   "Write frame: {utm: {zone: 55, hemisphere: south}}");
    receiver.frame = value;
}

Geodetic read_geodetic(const YamlValue& map) {
    return {.latitude = Angle::from_degrees(map["latitude_deg"].real()),
            .longitude = Angle::from_degrees(map["longitude_deg"].real()),
            .height_m = map["height_m"].real()};
}

/// The name of a file, or a list of such names.
std::vector<std::string> read_files(const YamlValue& value, const std::string& remedy) {
    std::vector<std::string> files;
    const auto add = [&](const YamlValue& one) {
        files.push_back(one.text());
        if (files.back().empty()) one.fail("is empty", remedy);
    };
    if (value.is_list())
        for (const YamlValue& one : value.list())
            add(one);
    else
        add(value);
    if (files.empty()) value.fail("names no file", remedy);
    return files;
}

bool is_hexadecimal(const std::string& text, std::size_t digits) {
    return text.size() == digits && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::optional<AmendedReport> read_amends(const YamlValue& value) {
    if (!value.exists()) return std::nullopt;
    AmendedReport amends{.report_id = value["report_id"].text(),
                         .sha256 = value["sha256"].text(),
                         .reason = value["reason"].text()};
    if (!is_hexadecimal(amends.report_id, 16))
        value["report_id"].fail("a report id is 16 hexadecimal digits in lower case",
                                "Copy it from the head of the earlier report");
    if (!is_hexadecimal(amends.sha256, 64))
        value["sha256"].fail("a SHA-256 is 64 hexadecimal digits in lower case",
                             "Copy what `sha256sum report.json` prints of the earlier report");
    return amends;
}

std::string read_date(const YamlValue& value) {
    if (!value.exists()) return {};
    std::string date = value.text();
    try {
        if (date.size() != 10 || date[4] != '-') throw Failure("", "", "");
        (void)parse_gps_iso(date + "T00:00:00");
    } catch (const Failure&) {
        value.fail(fmt::format("\"{}\" is not a date", escape_for_message(date)),
                   "Write it as YYYY-MM-DD");
    }
    return date;
}

/// What of a receiver's description says how its recording is read.
nlohmann::ordered_json reading_of(const YamlValue& entry) {
    nlohmann::ordered_json stated = json_from_yaml(entry);
    for (const char* other : {"id", "recording", "base", "navigation", "phase", "antenna_height_m",
                              "lever_arm_m", "rotation_bound_deg"})
        stated.erase(other);
    return stated;
}

/// What the recording leaves out of horizontal coordinates, heights and velocities.
AttemptAccuracy read_accuracy(const YamlValue& entry) {
    const AttemptAccuracy accuracy{.horizontal_m = entry["horizontal_m"].optional_real(),
                                   .vertical_m = entry["vertical_m"].optional_real(),
                                   .velocity_m_s = entry["velocity_mps"].optional_real()};
    if (!accuracy.horizontal_m && !accuracy.vertical_m && !accuracy.velocity_m_s)
        entry.fail("the accuracy states nothing",
                   "Add horizontal_m, vertical_m or velocity_mps, what the recording leaves out");
    return accuracy;
}

Receiver read_receiver(const YamlValue& entry) {
    Receiver receiver;
    receiver.id = read_id(entry["id"]);
    receiver.recordings = read_files(entry["recording"], "Name the recording's file");
    receiver.format = entry["format"].text_or(default_text("receivers[].format"));
    receiver.gpsbabel_type = entry["gpsbabel_type"].text_or("");
    receiver.base = entry["base"].text_or("");
    if (entry["navigation"].exists())
        receiver.navigation = read_files(entry["navigation"], "Name the navigation file");
    receiver.phase = entry["phase"].text_or("");
    if (entry["base_position"].exists())
        receiver.base_position = read_geodetic(entry["base_position"]);
    receiver.solution_pass =
        entry["solution_pass"].text_or(default_text("receivers[].solution_pass"));
    read_frame(entry, receiver);
    for (const std::string& key : entry["columns"].keys())
        if (entry["columns"][key].exists()) receiver.columns[key] = entry["columns"][key].text();
    receiver.time_format = entry["time_format"].text_or(default_text("receivers[].time_format"));
    receiver.time_scale = entry["time_scale"].text_or("");
    receiver.speed_unit = entry["speed_unit"].text_or("");
    receiver.delimiter = entry["delimiter"].text_or(default_text("receivers[].delimiter"));
    receiver.utc_offset_h = entry["utc_offset_h"].optional_real();
    receiver.start_date = read_date(entry["start_date"]);
    receiver.start_gps = read_gps_time(entry["start_gps"]);
    receiver.height_m = entry["height_m"].optional_real();
    if (const YamlValue accuracy = entry["accuracy"]; accuracy.exists())
        receiver.accuracy = read_accuracy(accuracy);
    receiver.solution = entry["solution"].text_or("");
    receiver.time_source = entry["time_source"].text_or("");
    receiver.antenna_height_m = entry["antenna_height_m"].optional_real();
    if (const YamlValue arm = entry["lever_arm_m"]; arm.exists())
        receiver.lever_arm = {arm["forward"].real(), arm["right"].real(), arm["down"].real()};
    receiver.rotation_bound_deg = entry["rotation_bound_deg"].optional_real();
    if (receiver.rotation_bound_deg && !receiver.lever_arm)
        entry["rotation_bound_deg"].fail(
            "the craft's rotation is bounded, but no lever arm is given for it to act on",
            "Add lever_arm_m: {forward, right, down}, or remove rotation_bound_deg");
    receiver.stated = reading_of(entry);
    receiver.place = entry.place();
    return receiver;
}

std::vector<Receiver> read_receivers(const YamlValue& list) {
    std::vector<Receiver> receivers;
    std::set<std::string> ids;
    for (const YamlValue& entry : list.list()) {
        receivers.push_back(read_receiver(entry));
        if (!ids.insert(receivers.back().id).second)
            entry["id"].fail(fmt::format("two receivers have the id \"{}\"", receivers.back().id),
                             "Give each receiver an id of its own");
    }
    if (receivers.empty() || receivers.size() > 2)
        list.fail(fmt::format("{} receivers are listed", receivers.size()),
                  "List one receiver, or a primary and a secondary one");
    return receivers;
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

void resolve_parameters(const YamlValue& document, Attempt& attempt) {
    for (const FieldRule& rule : attempt_schema().fields()) {
        constexpr std::string_view prefix = "parameters.";
        if (!rule.path.starts_with(prefix) || rule.path.ends_with("[]")) continue;
        const std::string path = rule.path.substr(prefix.size());
        const std::size_t point = path.find('.');
        if (point == std::string::npos) continue;
        const std::string stage = path.substr(0, point);
        const std::string name = path.substr(point + 1);
        YamlValue value = document["parameters"][stage][name];
        if (value.exists())
            attempt.overrides.push_back(path);
        else
            value = rule.default_value.is_map() ? rule.default_value[attempt.craft_class]
                                                : rule.default_value;
        attempt.parameters[stage][name] = json_from_yaml(value);
    }
}

/// The interval that the correlation time of a time-correlated position error is looked for in.
void require_error_times(const YamlValue& smooth, const nlohmann::ordered_json& resolved) {
    const double shortest = resolved["error_time_min_s"].get<double>();
    const double longest = resolved["error_time_max_s"].get<double>();
    if (longest > shortest) return;
    const bool stated = smooth["error_time_max_s"].exists();
    smooth[stated ? "error_time_max_s" : "error_time_min_s"].fail(
        fmt::format("the correlation time is looked for from {} s to {} s", shortest, longest),
        "Give error_time_max_s above error_time_min_s");
}

/// What a name claims: itself, or the profiles of one body that are claimed together.
std::vector<std::string> claimed_by(const std::string& name) {
    if (name != "gps-speed-sailing") return {name};
    std::vector<std::string> all;
    for (const char* const rule :
         {"2s", "10s", "5x10s", "500m", "nautical-mile", "1h", "alpha-500"})
        all.push_back(name + "-" + rule);
    return all;
}

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

}  // namespace

bool is_id(std::string_view text) {
    return !text.empty() && text.size() <= 64 && text.front() != '-' &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-' || c == '_';
           });
}

std::string_view to_text(CoordinateFrame frame) {
    return word_of(frame_words, frame);
}

const DocumentSchema& attempt_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(attempt_field_table_node(), "schemas/attempt/v1.yaml");
    return schema;
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

Attempt read_attempt(std::string_view text, const std::string& where) {
    const YamlValue document = read_input(text, where, attempt_schema());
    Attempt attempt;
    attempt.id = read_id(document["id"]);
    attempt.craft_name = document["craft"]["name"].text();
    attempt.craft_class = document["craft"]["class"].text();
    attempt.place = document["place"].text_or("");
    attempt.date = read_date(document["date"]);
    for (const YamlValue& official : document["officials"].list())
        attempt.officials.push_back({.role = official["role"].text(),
                                     .name = official["name"].text_or(""),
                                     .key = official["key"].text_or("")});
    attempt.signatures = read_role_signatures(document["signatures"]);
    attempt.amends = read_amends(document["amends"]);
    attempt.attempts_made = document["attempts_made"].optional_integer().value_or(1);
    attempt.receivers = read_receivers(document["receivers"]);
    require_heights(document["receivers"], attempt.craft_class);
    if (const YamlValue origin = document["origin"]; origin.exists())
        attempt.origin = read_geodetic(origin);
    attempt.profiles = read_profiles(document["profiles"]);
    read_rule_input(document, attempt);
    resolve_parameters(document, attempt);
    require_error_times(document["parameters"]["smooth"], attempt.parameters["smooth"]);
    attempt.inputs = inputs_of(document);
    return attempt;
}

}  // namespace runcert
