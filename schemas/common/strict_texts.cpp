#include "schemas/common/strict_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/satellite.h"
#include "core/text.h"
#include "schemas/common/codec.h"

namespace runcert {

bool is_role(std::string_view text) {
    return !text.empty() && text.size() <= 64 && has_only(text, "-_");
}

bool is_id(std::string_view text) {
    return is_role(text) && text.front() != '-';
}

std::string read_role(const YamlValue& value) {
    if (!is_role(value.text()))
        value.fail("a role is letters, digits, - and _, at most 64 of them",
                   "Write it so, \"measurer\": signatures name it");
    return value.text();
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

namespace {

constexpr int earliest_offset_minutes = -12 * 60, latest_offset_minutes = 14 * 60;

bool is_offset(std::optional<int> minutes) {
    return minutes && *minutes >= earliest_offset_minutes && *minutes <= latest_offset_minutes &&
           *minutes % 15 == 0;
}

/// "+10:30" for 630.
std::string offset_text(int minutes) {
    return fmt::format("{}{:02}:{:02}", minutes < 0 ? '-' : '+', std::abs(minutes) / 60,
                       std::abs(minutes) % 60);
}

/// Minutes of a text of that form, whatever they are; nothing for another form. "-00:00" stands for
/// an offset that is not known, and is none.
std::optional<int> minutes_of(std::string_view text) {
    const auto digit = [&](std::size_t at) { return text[at] >= '0' && text[at] <= '9'; };
    if (text.size() != 6 || (text[0] != '+' && text[0] != '-') || text[3] != ':' || !digit(1) ||
        !digit(2) || !digit(4) || !digit(5) || text == "-00:00")
        return std::nullopt;
    const auto number = [&](std::size_t at) { return 10 * (text[at] - '0') + text[at + 1] - '0'; };
    if (number(4) > 59) return std::nullopt;
    return (text[0] == '-' ? -1 : 1) * (60 * number(1) + number(4));
}

/// The offset that was meant by a number: some programs that write YAML take 10:30 for a number
/// to the base 60, of minutes (630) or, with its seconds, of seconds (37800).
std::optional<int> meant_by(std::string_view text) {
    const auto number = parse_integer(text);
    if (!number || std::abs(*number) < 60 || std::abs(*number) > 24 * 3600) return std::nullopt;
    const int whole = static_cast<int>(*number);
    if (is_offset(whole)) return whole;
    if (whole % 60 == 0 && is_offset(whole / 60)) return whole / 60;
    return std::nullopt;
}

}  // namespace

std::optional<int> read_utc_offset(const YamlValue& value) {
    if (!value.exists()) return std::nullopt;
    const std::string text = value.text();
    if (text == "Z") return 0;
    const std::optional<int> minutes = minutes_of(text);
    if (is_offset(minutes)) return minutes;
    const std::string shown = escape_for_message(text);
    if (minutes)
        value.fail(fmt::format("no local time is {} from UTC", shown),
                   "Give quarters of an hour from -12:00 to +14:00");
    if (const auto meant = meant_by(text))
        value.fail(
            fmt::format("\"{}\" is not an offset from UTC; some programs write {} so, as a number "
                        "to the base 60",
                        shown, offset_text(*meant)),
            fmt::format("Write it in quotes: \"{}\"", offset_text(*meant)));
    value.fail(
        fmt::format("\"{}\" is not an offset from UTC", shown),
        is_offset(minutes_of("+" + text))
            ? fmt::format("Write it with its sign: \"+{}\" where local time is ahead of UTC", shown)
            : "Write local time less UTC as \"+10:30\", \"-03:00\" or \"Z\"");
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
nlohmann::ordered_json members_json(const Geodetic& position) {
    return {{"latitude_deg", position.latitude.degrees()},
            {"longitude_deg", position.longitude.degrees()},
            {"height_m", position.height_m}};
}

template <>
Geodetic read_members(const YamlValue& map) {
    return {.latitude = Angle::from_degrees(map["latitude_deg"].real()),
            .longitude = Angle::from_degrees(map["longitude_deg"].real()),
            .height_m = map["height_m"].real()};
}

}  // namespace runcert
