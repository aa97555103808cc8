#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/geodetic.h"
#include "core/gps_time.h"
#include "files/yaml_input.h"

// What a field table cannot say of a text: each reader fails at the value's place.
namespace runcert {

/// Whether a text can be an id: 1 to 64 letters, digits, - and _, not beginning with -. An id names
/// files: nothing that a file system or a shell could read otherwise.
bool is_id(std::string_view text);

std::string read_id(const YamlValue& value);

/// "2023-07-11", as it is written, and a day that there is.
std::string read_date(const YamlValue& value);

/// A GPS time of a UTC text.
GpsTime read_utc_time(const YamlValue& value);

/// The name of a file, or a list of such names; at least one, none empty.
std::vector<std::string> read_files(const YamlValue& value);

}  // namespace runcert
