#include "schemas/common/window_span.h"

#include <cmath>

#include "core/decimal_time.h"

namespace runcert {
namespace {

ElapsedTime read_elapsed(const YamlValue& value) {
    (void)value.real();
    const auto nanoseconds = parse_decimal_nanoseconds(value.text());
    // A shortest-form number below 1e-5 is written with an exponent.
    return {nanoseconds ? *nanoseconds : std::llround(value.real() * 1e9)};
}

}  // namespace

nlohmann::ordered_json window_span_json(const WindowSpan& span) {
    nlohmann::ordered_json json;
    json["start_time_s"] = rounded(span.start.seconds(), 9);
    json["duration_s"] = rounded(span.duration.seconds(), 9);
    if (span.start_gps) {
        json["start_gps"] = to_iso(*span.start_gps, 3);
        json["start_utc"] = to_utc_iso(*span.start_gps, 3);
    }
    json["first_epoch"] = span.first_epoch;
    json["last_epoch"] = span.last_epoch;
    return json;
}

WindowSpan read_window_span(const YamlValue& value) {
    WindowSpan span;
    span.first_epoch = value["first_epoch"].integer();
    span.last_epoch = value["last_epoch"].integer();
    span.start = read_elapsed(value["start_time_s"]);
    span.duration = read_elapsed(value["duration_s"]);
    if (value["start_gps"].exists()) span.start_gps = parse_gps_iso(value["start_gps"].text());
    return span;
}

}  // namespace runcert
