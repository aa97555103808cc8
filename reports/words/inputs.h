#pragma once

#include <string>
#include <vector>

#include "schemas/verdict/verdict.h"

namespace runcert {

/// What one origin says: "Claimed", and what.
struct InputsOfOrigin {
    std::string label;
    std::string text;
};

/// What the figures of a verdict rest on, by who says it: each input with its value, several of one
/// part of the attempt by their number. Origins that say nothing are left out.
std::vector<InputsOfOrigin> inputs_by_origin(const std::vector<VerdictInput>& inputs);

}  // namespace runcert
