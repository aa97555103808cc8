#pragma once

#include <optional>
#include <string>

#include "stages/check/requirements.h"

namespace runcert {

/// A figure that is compared with a clause's limit, in the limit's unit.
struct Compared {
    std::string name;
    double value = 0.0;
    std::optional<double> expanded_uncertainty;
    std::string note = {};
};

/// Met or not met where the whole interval is on one side of the clause's limit, as its computation
/// compares; to be attested in between.
Finding against_limit(const Compared& figure, const Clause& clause);

/// To be attested, because it is not decidable from the recording.
Finding unknown(std::string why);

}  // namespace runcert
