#pragma once

#include <optional>
#include <string>

#include "core/gps_time.h"
#include "schemas/common/codec.h"
#include "schemas/common/table.h"

namespace runcert {

/// The stretch between two epochs, both included.
struct WindowSpan {
    std::int64_t first_epoch = 0;
    std::int64_t last_epoch = 0;
    ElapsedTime start;
    ElapsedTime duration;
    std::optional<GpsTime> start_gps;  ///< empty where the recording's time is relative

    bool operator==(const WindowSpan&) const = default;
};

/// "20.100 s": three decimals.
std::string seconds_text(ElapsedTime time);

/// An instant of a recording by time of day, where it is known when it began: "at 14:03:22.1 UTC",
/// "53.8 s after the first epoch".
std::string instant_text(const std::optional<GpsTime>& first_epoch, ElapsedTime time);
/// When a window begins, in the same words.
std::string beginning_text(const WindowSpan& span);

/// Seconds, exact to the nanosecond.
template <>
nlohmann::ordered_json members_json(const ElapsedTime& time);
template <>
ElapsedTime read_members(const YamlValue& value);
template <>
nlohmann::ordered_json members_json(const WindowSpan& span);
template <>
WindowSpan read_members(const YamlValue& value);

}  // namespace runcert
