#pragma once

#include <nlohmann/json.hpp>

#include "schemas/screened/screened.h"

namespace runcert {

/// What the tests of screening rested on, in figures; of the faults of the time stamps the first
/// 20.
nlohmann::ordered_json screening_basis_json(const ScreeningBasis& basis);

/// The same in words: false alarms, noise, accuracy of each fix type, recorded velocities,
/// time stamps and the other receiver.
nlohmann::ordered_json screening_basis_facts(const ScreeningBasis& basis);

}  // namespace runcert
