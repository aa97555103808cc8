#pragma once

#include "schemas/attempt/attempt.h"

namespace runcert {

/// What an attempt says or hands in, `Attempt::inputs`: `document` was checked by the schema.
std::vector<AttemptInput> inputs_of(const YamlValue& document);

}  // namespace runcert
