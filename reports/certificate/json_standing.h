#pragma once

#include <nlohmann/json_fwd.hpp>

#include "trust/run_standing.h"

namespace runcert {

/// What a page shows of a standing in place of what report.json says, which was written before the
/// first answer: for each rule the title with its mark and tone, the standing in words, who
/// answered what, and that of each clause; whose roster vouches. Texts alone, which the page
/// carries too: its script puts them in the same places. Empty where nobody answered and no roster
/// was given: the page is then that of report.json.
nlohmann::ordered_json standing_json(const RunStanding& standing);

/// A report's predicate with these texts in their places, and in no others.
nlohmann::ordered_json with_standing(nlohmann::ordered_json predicate,
                                     const nlohmann::ordered_json& standing);

}  // namespace runcert
