#pragma once

#include <string>

#include "core/geodetic.h"
#include "schemas/common/codec.h"

namespace runcert {

/// The origin of the local frame, in geodetic coordinates.
struct FrameOrigin {
    Geodetic position;
    std::string source;  ///< "attempt" or "first_epoch"
};

template <>
nlohmann::ordered_json members_json(const FrameOrigin& origin);
template <>
FrameOrigin read_members(const YamlValue& origin);

}  // namespace runcert
