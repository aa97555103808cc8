#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace runcert {

/// What the text of a YAML file says that it is: "attempt/1.0", "day/1.0"; empty where it does not
/// say so, or cannot be parsed. Quick: parsed only where the schema does not stand on a line of its
/// own.
std::string written_schema(std::string_view text);

/// The id of an attempt where it stands on a line of its own, once: read without parsing the file,
/// which takes a millisecond. Nothing where that leaves a doubt.
std::optional<std::string> quick_id(std::string_view text);

}  // namespace runcert
