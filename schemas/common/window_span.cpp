#include "schemas/common/window_span.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/decimal.h"
#include "core/figures.h"
#include "core/rounding.h"

namespace runcert {
namespace {

std::string after_first_epoch(ElapsedTime time) {
    return format_fixed(time.seconds(), 1) + " s after the first epoch";
}

}  // namespace

std::string seconds_text(ElapsedTime time) {
    return format_fixed(time.seconds(), 3) + " s";
}

std::string instant_text(const std::optional<GpsTime>& first_epoch, ElapsedTime time) {
    return first_epoch ? time_of_day_text(first_epoch->plus_nanoseconds(time.nanoseconds))
                       : after_first_epoch(time);
}

std::string beginning_text(const WindowSpan& span) {
    return span.start_gps ? time_of_day_text(*span.start_gps) : after_first_epoch(span.start);
}

template <>
nlohmann::ordered_json members_json(const ElapsedTime& time) {
    return rounded(time.seconds(), 9);
}

template <>
ElapsedTime read_members(const YamlValue& value) {
    const double seconds = value.real();
    if (const auto nanoseconds = parse_decimal_nanoseconds(value.text())) return {*nanoseconds};
    // The shortest form of a number below 0.0001 has an exponent.
    if (std::abs(seconds) >= 1e-4)
        value.fail("is not a time in seconds with at most nine decimals", take_the_original);
    return {std::llround(seconds * 1e9)};
}

template <>
nlohmann::ordered_json members_json(const WindowSpan& span) {
    nlohmann::ordered_json json;
    json["start_time_s"] = members_json(span.start);
    json["duration_s"] = members_json(span.duration);
    if (span.start_gps) {
        json["start_gps"] = to_iso(*span.start_gps, 3);
        json["start_utc"] = to_utc_iso(*span.start_gps, 3);
    }
    json["first_epoch"] = span.first_epoch;
    json["last_epoch"] = span.last_epoch;
    return json;
}

template <>
WindowSpan read_members(const YamlValue& value) {
    WindowSpan span;
    span.first_epoch = value["first_epoch"].integer();
    span.last_epoch = value["last_epoch"].integer();
    span.start = read_members<ElapsedTime>(value["start_time_s"]);
    span.duration = read_members<ElapsedTime>(value["duration_s"]);
    span.start_gps = read_gps_time(value["start_gps"]);
    return span;
}

}  // namespace runcert
