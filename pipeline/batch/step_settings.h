#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>
#include <vector>

#include "files/held_json.h"
#include "run/steps.h"

namespace runcert {

/// What of the attempt and its profiles, given as written, a step uses beside its input files.
///
/// A key of the attempt or of a profile that this function does not know counts as used by every
/// step, so that forgetting one costs time and not a right result.
nlohmann::ordered_json settings_of_step(std::string_view step, const Attempt& attempt,
                                        const nlohmann::ordered_json& attempt_document,
                                        const std::vector<HeldJson>& profiles,
                                        const ReportChoice& choice);

}  // namespace runcert
