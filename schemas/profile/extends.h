#pragma once

#include <string>
#include <string_view>

#include "store/yaml_input.h"

namespace runcert {

/// A rule's document without `extends` and `leaves_out`, with what it has from the rules that it
/// extends. `document` was parsed of a file; what comes from another rule has the place of its
/// `extends`. Failure, with that place, for an unknown rule, one that extends itself, or an id of
/// `leaves_out` that the other rule does not have.
YamlValue extended(const YamlValue& document);

/// A document as block-style YAML text: keys in their order, what was plain stays plain.
std::string plain_yaml_text(const YamlNode& document);

}  // namespace runcert
