#pragma once

#include <optional>
#include <string>

#include "core/gps_time.h"
#include "schemas/common/codec.h"
#include "schemas/common/window_span.h"

namespace runcert {

/// What holds for the whole of a recording, and is carried through every table made from it.
struct RecordingFacts {
    std::string receiver;
    std::optional<GpsTime> first_epoch;  ///< empty where the recording's time is relative
    bool georeferenced = true;
    bool vertical_measured = true;
    double nominal_interval_s = 0.0;  ///< median step between epochs
    /// Smallest step that the recording's horizontal coordinates can show, m; empty where unknown.
    std::optional<double> position_resolution_m = std::nullopt;
    /// Smallest step that its time stamps can show, s.
    std::optional<double> time_resolution_s = std::nullopt;
    /// Whose clock made the time stamps: "satellites", which the format says; "attempt", which says
    /// that they are the satellites'; "unknown".
    std::string time_source = "unknown";
};

template <>
nlohmann::ordered_json members_json(const RecordingFacts& facts);
template <>
RecordingFacts read_members(const YamlValue& meta);

/// The stretch between two epochs of a recording.
WindowSpan window_span(const RecordingFacts& facts, std::int64_t first_epoch,
                       std::int64_t last_epoch, ElapsedTime first, ElapsedTime last);

}  // namespace runcert
