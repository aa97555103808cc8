#include "schemas/observations/recording_facts.h"

#include <nlohmann/json.hpp>

#include "schemas/common/document.h"

namespace runcert {

template <>
nlohmann::ordered_json members_json(const RecordingFacts& facts) {
    nlohmann::ordered_json json;
    json["receiver"] = facts.receiver;
    if (facts.first_epoch) {
        json["first_epoch_gps"] = to_iso(*facts.first_epoch, 9);
        json["first_epoch_utc"] = to_utc_iso(*facts.first_epoch, 9);
    }
    json["georeferenced"] = facts.georeferenced;
    json["vertical_measured"] = facts.vertical_measured;
    json["nominal_interval_s"] = facts.nominal_interval_s;
    set_optional(json, "position_resolution_m", facts.position_resolution_m);
    set_optional(json, "time_resolution_s", facts.time_resolution_s);
    json["time_source"] = facts.time_source;
    return json;
}

template <>
RecordingFacts read_members(const YamlValue& meta) {
    RecordingFacts facts;
    facts.receiver = meta["receiver"].text();
    facts.first_epoch = read_gps_time(meta["first_epoch_gps"]);
    facts.georeferenced = meta["georeferenced"].boolean();
    facts.vertical_measured = meta["vertical_measured"].boolean();
    facts.nominal_interval_s = meta["nominal_interval_s"].real();
    facts.position_resolution_m = meta["position_resolution_m"].optional_real();
    facts.time_resolution_s = meta["time_resolution_s"].optional_real();
    facts.time_source = meta["time_source"].text_or("unknown");
    return facts;
}

WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last) {
    WindowSpan span{.first_epoch = first_epoch,
                    .last_epoch = last_epoch,
                    .start = first,
                    .duration = {last.nanoseconds - first.nanoseconds},
                    .start_gps = std::nullopt};
    if (facts.first_epoch) span.start_gps = facts.first_epoch->plus_nanoseconds(first.nanoseconds);
    return span;
}

}  // namespace runcert
