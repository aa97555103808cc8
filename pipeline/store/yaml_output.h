#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "store/yaml_node.h"

namespace runcert {

/// Characters beyond ASCII: as they are, where they can be seen and steer no terminal ("±"), or
/// escaped, as the header of a table has it (an ECSV header is ASCII).
enum class YamlLetters { any, ascii };

/// A document as block-style YAML text, the same bytes everywhere: keys in their order, text in
/// double quotes wherever a YAML 1.1 or 1.2 reader could take it for anything but that text,
/// numbers in their shortest form that reads back equal. Failure where a number is not finite.
std::string to_yaml_text(const nlohmann::ordered_json& document,
                         YamlLetters letters = YamlLetters::any);

/// A map that was read, as block-style YAML text: keys in their order, and scalars that were plain
/// stay as they are written.
std::string plain_yaml_text(const YamlNode& map);

/// The document as reading that text would give it, but without places.
YamlNode yaml_node_of(const nlohmann::ordered_json& document);

}  // namespace runcert
