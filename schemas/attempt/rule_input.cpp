#include "schemas/attempt/rule_input.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/failure.h"
#include "core/speed_unit.h"
#include "core/text.h"

namespace runcert {
namespace {

/// A profile that the attempt claims, by its name or as it is written there.
std::string read_claimed(const YamlValue& name, const Attempt& attempt) {
    const std::string text = name.text();
    for (const std::string& claimed : attempt.profiles)
        if (claimed == text || profile_name(claimed) == text) return profile_name(claimed);
    name.fail(
        fmt::format("the attempt does not claim the profile \"{}\"", escape_for_message(text)),
        "Add it to profiles, or correct the name");
}

Record read_record(const YamlValue& record) {
    return {.speed = record["speed"].real(),
            .unit = record["unit"].text(),
            .source = record["source"].text(),
            .expanded_uncertainty = record["expanded_uncertainty"].optional_real().value_or(0.0)};
}

void read_records(const YamlValue& list, Attempt& attempt) {
    if (!list.exists()) return;
    for (const YamlValue& entry : list.list())
        if (!attempt.records.emplace(read_claimed(entry["profile"], attempt), read_record(entry))
                 .second)
            entry["profile"].fail("two records are given for it", "Give one");
}

void read_rules(const YamlValue& list, Attempt& attempt) {
    if (!list.exists()) return;
    for (const YamlValue& entry : list.list()) {
        attempt.rules.push_back({.profile = read_claimed(entry["profile"], attempt),
                                 .figure = entry["figure"].text(),
                                 .value = entry["value"].real(),
                                 .reason = entry["reason"].text_or(""),
                                 .place = entry["figure"].place()});
        for (std::size_t i = 0; i + 1 < attempt.rules.size(); ++i)
            if (attempt.rules[i].profile == attempt.rules.back().profile &&
                attempt.rules[i].figure == attempt.rules.back().figure)
                entry["figure"].fail("it is replaced twice", "Replace it once");
    }
}

CoursePoint read_point(const YamlValue& map) {
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

Course read_course(const YamlValue& map) {
    const auto line = [](const YamlValue& ends) {
        return CourseLine{.left = read_point(ends["left"]), .right = read_point(ends["right"])};
    };
    return {.start = line(map["start"]),
            .finish = line(map["finish"]),
            .length_m = map["length_m"].real(),
            .length_expanded_uncertainty_m = map["length_expanded_uncertainty_m"].real(),
            .place = map.place()};
}

std::optional<SeriesFile> read_series_file(const YamlValue& map) {
    if (!map.exists()) return std::nullopt;
    if (map["scale"].exists() != map["expanded_uncertainty_scale"].exists())
        map.fail("a wheel's scale and its uncertainty belong together",
                 "Give scale and expanded_uncertainty_scale, or neither");
    return SeriesFile{
        .file = map["file"].text(),
        .source = map["source"].text(),
        .expanded_uncertainty_m_s = map["expanded_uncertainty_m_s"].optional_real().value_or(0.0),
        .expanded_uncertainty_m = map["expanded_uncertainty_m"].optional_real().value_or(0.0),
        .expanded_uncertainty_s = map["expanded_uncertainty_s"].optional_real().value_or(0.0),
        .scale = map["scale"].optional_real(),
        .expanded_uncertainty_scale =
            map["expanded_uncertainty_scale"].optional_real().value_or(0.0),
        .place = map["file"].place()};
}

GpsTime read_utc_time(const YamlValue& value) {
    const std::string text = value.text();
    try {
        const bool zone = text.ends_with('Z');
        return gps_from_utc(
            parse_gps_iso(zone ? text.substr(0, text.size() - 1) : text).calendar());
    } catch (const Failure& failure) {
        value.fail(failure.problem(), failure.remedy());
    }
}

std::optional<SecondaryMethod> read_secondary(const YamlValue& map) {
    if (!map.exists()) return std::nullopt;
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

}  // namespace

void read_rule_input(const YamlValue& document, Attempt& attempt) {
    if (const YamlValue record = document["record"]; record.exists())
        attempt.record = read_record(record);
    read_records(document["records"], attempt);
    read_rules(document["rules"], attempt);
    if (const YamlValue course = document["course"]; course.exists())
        attempt.course = read_course(course);
    attempt.wind = read_series_file(document["wind"]);
    attempt.current = read_series_file(document["current"]);
    attempt.wheel = read_series_file(document["wheel"]);
    attempt.gates = read_series_file(document["gates"]);
    attempt.secondary_method = read_secondary(document["secondary"]);
}

const Record* Attempt::record_for(const std::string& profile) const {
    if (const auto own = records.find(profile); own != records.end()) return &own->second;
    return record ? &*record : nullptr;
}

}  // namespace runcert
