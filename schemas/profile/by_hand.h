#pragma once

#include <map>
#include <string>

#include "schemas/common/codec.h"
#include "schemas/common/role_signatures.h"

// The part of a profile that a declaration cannot say.
namespace runcert {

/// Smallest standard deviation of a time-correlated position error (m), by fix type.
using ErrorFloors = std::map<std::string, double>;
template <>
ErrorFloors read_members(const YamlValue& map);

}  // namespace runcert
