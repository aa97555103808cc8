#pragma once

#include <nlohmann/json.hpp>

#include "schemas/screened/screened.h"

namespace runcert {

/// What screening decided: epochs by reason, decisions by hypothesis, and what the tests rested on.
nlohmann::ordered_json screening_json(const ScreenedTable& table);

/// The same as shown, a line for each thing that an official asks.
nlohmann::ordered_json screening_facts(const ScreenedTable& table);

}  // namespace runcert
