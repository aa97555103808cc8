#pragma once

#include "files/yaml_input.h"
#include "schemas/attempt/attempt.h"

namespace runcert {

/// What the rules need beside the recordings: records to beat, figures replaced, the course, wind
/// and current, a second method. Sets these members; `profiles` must be read before.
void read_rule_input(const YamlValue& document, Attempt& attempt);

}  // namespace runcert
