#pragma once

#include <optional>

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
};

template <>
nlohmann::ordered_json members_json(const WindowSpan& span);
template <>
WindowSpan read_members(const YamlValue& value);

}  // namespace runcert
