#pragma once

#include <string_view>
#include <vector>

#include "files/held_json.h"
#include "files/yaml_input.h"
#include "run/steps.h"

namespace runcert {

/// What of the attempt and its profiles a step uses beside its input files: of a stage that which
/// the fields declare for it, and it gets no more; null for the steps that read whole files.
HeldJson settings_of_step(std::string_view step, const Attempt& attempt,
                          const std::vector<YamlValue>& profiles, const ReportChoice& choice);

}  // namespace runcert
