#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/geodetic.h"
#include "core/gps_time.h"
#include "store/yaml_input.h"

// Checks of texts that a field table cannot express. Each reader fails at the value's place.
namespace runcert {

/// Whether a text can be an id: 1 to 64 letters, digits, - and _, not beginning with -. Ids are
/// used in file names, so nothing is allowed that a file system or a shell could interpret.
bool is_id(std::string_view text);

/// Reads an id.
std::string read_id(const YamlValue& value);

/// Whether a text can be a role, who signs: as an id, and it may begin with -.
bool is_role(std::string_view text);

/// Reads a role.
std::string read_role(const YamlValue& value);

/// A date written as "2023-07-11", unchanged. It must exist in the calendar.
std::string read_date(const YamlValue& value);

/// Minutes by which a local time is ahead of UTC: "+10:30" is 630, "Z" is 0; quarters of an hour
/// from -12:00 to +14:00. Nothing where the value is absent.
std::optional<int> read_utc_offset(const YamlValue& value);

/// The GPS time of a UTC text.
GpsTime read_utc_time(const YamlValue& value);

/// One or more file names, given as a text or a list. None may be empty.
std::vector<std::string> read_files(const YamlValue& value);

}  // namespace runcert
