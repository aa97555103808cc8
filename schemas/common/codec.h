#pragma once

#include <nlohmann/json_fwd.hpp>

#include "core/geodetic.h"
#include "store/yaml_input.h"

namespace runcert {

/// Converts a struct to a map of a document, and back. Members that the map lacks keep the value of
/// a default-constructed struct. The field table defines which may be absent.
template <class Struct>
nlohmann::ordered_json members_json(const Struct& value);
template <class Struct>
Struct read_members(const YamlValue& map);

/// The same of geodetic coordinates, as an origin has them.
using OriginPosition = Geodetic;
template <>
nlohmann::ordered_json members_json(const Geodetic& position);
template <>
Geodetic read_members(const YamlValue& map);

}  // namespace runcert
