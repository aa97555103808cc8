#pragma once

#include <ctime>
#include <string>
#include <vector>

#include "run/chain.h"

namespace runcert {

/// run.yaml: when a run was made, and how long its stages took; no other file depends on it.
std::string run_times_text(std::time_t started, const std::vector<StageDone>& stages);

}  // namespace runcert
