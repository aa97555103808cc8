#pragma once

#include "store/yaml_input.h"

namespace runcert {

/// A rule's document without `extends` and `leaves_out`, with what it has from the rules that it
/// extends. `document` was parsed of a file; what comes from another rule has the place of its
/// `extends`. Failure, with that place, for an unknown rule, one that extends itself, or an id of
/// `leaves_out` that the other rule does not have.
YamlValue extended(const YamlValue& document);

}  // namespace runcert
