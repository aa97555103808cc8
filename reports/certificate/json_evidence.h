#pragma once

#include <nlohmann/json.hpp>

#include "schemas/screened/screened.h"

namespace runcert {

/// What the tests of screening rested on, in figures; of the faults of the time stamps the first
/// 20.
nlohmann::ordered_json evidence_json(const ScreeningEvidence& evidence);

/// The same in words: false alarms, noise, accuracy of each kind of solution, recorded velocities,
/// time stamps and the other receiver.
nlohmann::ordered_json evidence_facts(const ScreeningEvidence& evidence);

}  // namespace runcert
