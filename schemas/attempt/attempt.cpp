#include "schemas/attempt/attempt.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/failure.h"
#include "core/text.h"
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

/// A typed height is part of every length: within what there is where craft of the class run.
void require_heights(const YamlValue& document, const std::string& craft_class) {
    const YamlValue limits =
        attempt_schema().source()["fields"]["receivers[].height_m"]["limits"][craft_class];
    for (const YamlValue& height : values_at(document, "receivers[].height_m")) {
        if (!limits.exists()) return;
        const double lowest_m = limits.list()[0].real(), highest_m = limits.list()[1].real();
        if (height.real() < lowest_m || height.real() > highest_m)
            height.fail(
                fmt::format("no {} runs at a height of {:g} m: it is from {:g} m to {:g} m",
                            craft_class, height.real(), lowest_m, highest_m),
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

}  // namespace

std::vector<std::string> claimed_by(const std::string& name) {
    if (name != "gps-speed-sailing" && name != "gps-ice-sailing") return {name};
    std::vector<std::string> all;
    for (const char* const rule :
         {"2s", "10s", "5x10s", "500m", "nautical-mile", "1h", "alpha-500"})
        all.push_back(name + "-" + rule);
    return all;
}

const DocumentSchema& attempt_schema() {
    static const DocumentSchema schema =
        DocumentSchema::read(attempt_field_table_node(), "schemas/attempt/v1.yaml");
    return schema;
}

CraftDirection direction_of(CraftAxis axis) {
    // As they are declared: forward, backward, right, left, down, up.
    const auto place = static_cast<std::size_t>(axis);
    return {place / 2, place % 2 == 0 ? 1.0 : -1.0};
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

YamlValue Attempt::written(const std::string& receiver) const {
    for (const YamlValue& entry : resolved["receivers"].list())
        if (entry["id"].text() == receiver) return entry;
    return {YamlNode(), resolved.where()};
}

OpaqueJson reading_of(const YamlValue& receiver, std::string_view beside) {
    const auto read_in = [](const YamlValue& map, const std::string& path) {
        const DocumentSchema& schema = attempt_schema();
        auto read = nlohmann::ordered_json::object();
        for (const std::string& key : map.keys()) {
            const std::string below = path + "." + key;
            if (key != "id" && !schema.find(below)->names_file && !schema.find(below + ".file") &&
                schema.is_read_by(below, "import"))
                read[key] = json_from_yaml(map[key]);
        }
        return read;
    };
    auto read = read_in(receiver, "receivers[]");
    if (const std::string key(beside); !key.empty())
        read[key] = read_in(receiver[key], "receivers[]." + key);
    return read;
}

std::vector<NamedFile> named_files(const YamlValue& keys) {
    std::vector<NamedFile> files;
    for (const FieldRule& rule : attempt_schema().fields()) {
        if (!rule.names_file) continue;
        const std::string key = rule.path.substr(rule.path.find_last_of('.') + 1);
        for (const YamlValue& value : values_at(keys, rule.path))
            for (const YamlValue& one : value.is_list() ? value.list() : std::vector{value})
                if (one.node().is_scalar())
                    files.push_back({.key = key, .name = std::string(one.node().scalar())});
    }
    return files;
}

Attempt part_read_by(const Attempt& attempt, std::string_view stage) {
    const YamlValue document(attempt_schema().part_read_by(attempt.resolved, stage),
                             attempt.resolved.where());
    Attempt part{read_members<AttemptDocument>(document)};
    part.parameters = read_members<Parameters>(document["parameters"]);
    if (!part.profiles.empty()) part.profiles = attempt.profiles;
    if (!part.rules.empty()) part.rules = attempt.rules;
    part.overrides = stated_before_rule(attempt, stage);
    part.resolved = document;
    return part;
}

OpaqueJson settings_of(const Attempt& attempt, std::string_view stage) {
    auto settings = json_from_yaml(YamlValue(attempt_schema().part_read_by(attempt.resolved, stage),
                                             attempt.resolved.where()));
    if (const auto stated = stated_before_rule(attempt, stage); !stated.empty())
        settings["stated"] = stated;
    return settings;
}

OpaqueJson parameters_of(const Attempt& attempt, const std::string& stage) {
    const YamlValue own = attempt.resolved["parameters"][stage];
    return own.exists() ? OpaqueJson(json_from_yaml(own)) : OpaqueJson();
}

Attempt read_attempt(std::string_view text, const std::string& where, Completeness completeness) {
    const YamlValue document = read_input(text, where, attempt_schema(), completeness);
    Attempt attempt{read_members<AttemptDocument>(document)};
    attempt.utc_offset_minutes = read_utc_offset(document["utc_offset"]);
    if (attempt.amends) require_amended(document["amends"], *attempt.amends);
    for (const YamlValue& axes : values_at(document, "receivers[].imu.axes"))
        require_sound_axes(axes, read_members<ImuAxes>(axes));
    require_heights(document, attempt.craft.kind);
    attempt.profiles = read_profiles(document["profiles"]);
    take_records(document["records"], attempt);
    require_sound_rules(document["rules"], attempt);
    resolve_parameters(document, attempt);
    attempt.inputs = inputs_of(document);
    return attempt;
}

}  // namespace runcert
