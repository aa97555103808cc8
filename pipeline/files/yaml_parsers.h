#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "files/yaml_node.h"

// The two parsers behind parse_yaml; for yaml_input.cpp and tests alone. Both take text in which
// parse_yaml found no byte to refuse.

namespace runcert {

/// Parses any document by yaml-cpp, which finds the words for what is wrong with one. Failures as
/// for parse_yaml.
YamlNode parse_any_yaml(std::string_view text, const std::string& where);

/// Parses by libyaml, some ten times faster, a document in which both parsers are known to see the
/// same: no tabs, tags, anchors, directives, blocks of lines, text that goes on in another line,
/// or empty values. Nothing where it is another, or where anything is wrong with it.
std::optional<YamlNode> parse_common_yaml(std::string_view text);

}  // namespace runcert
