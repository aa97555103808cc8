#include "schemas/common/strict_texts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/satellite.h"
#include "core/text.h"
#include "schemas/common/codec.h"

namespace runcert {

bool is_id(std::string_view text) {
    return !text.empty() && text.size() <= 64 && text.front() != '-' &&
           std::all_of(text.begin(), text.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                      c == '-' || c == '_';
           });
}

std::string read_id(const YamlValue& value) {
    std::string id = value.text();
    if (!is_id(id))
        value.fail(fmt::format("\"{}\" cannot be an id", escape_for_message(id)),
                   "Use 1 to 64 letters, digits, - and _, not beginning with -");
    return id;
}

std::string read_date(const YamlValue& value) {
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

std::vector<std::string> read_files(const YamlValue& value) {
    std::vector<std::string> files;
    const std::string remedy = value.path().ends_with("navigation") ? "Name the navigation file"
                                                                    : "Name the recording's file";
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

template <>
Satellite read_members(const YamlValue& value) {
    Satellite satellite;
    if (!from_text(value.text(), satellite))
        value.fail(fmt::format("\"{}\" is no satellite", escape_for_message(value.text())),
                   "Name it as RINEX does: G02, E11");
    return satellite;
}

template <>
Geodetic read_members(const YamlValue& map) {
    return {.latitude = Angle::from_degrees(map["latitude_deg"].real()),
            .longitude = Angle::from_degrees(map["longitude_deg"].real()),
            .height_m = map["height_m"].real()};
}

}  // namespace runcert
