#pragma once

#include <nlohmann/json_fwd.hpp>

#include "files/yaml_input.h"

namespace runcert {

/// A struct as a map of a document, and back. What the map does not hold keeps the value that a new
/// struct has: the field table says what may be left out.
template <class Struct>
nlohmann::ordered_json members_json(const Struct& value);
template <class Struct>
Struct read_members(const YamlValue& map);

}  // namespace runcert
