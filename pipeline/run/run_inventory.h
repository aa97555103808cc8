#pragma once

#include <map>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"

namespace runcert {

/// What a whole run folder holds beside its report.
struct RunInventory {
    std::vector<std::string> claim{};  ///< attempt, rules, series of wind and current
    std::vector<std::string> files{};  ///< these, recordings, stage files
    /// For each stage file those that it is made from at least; its header may name more.
    std::map<std::string, std::vector<std::string>> made_from{};
};

/// The files that the chain makes and keeps of an attempt, by the attempt alone.
RunInventory inventory_of(const Attempt& attempt);

}  // namespace runcert
