#pragma once

#include <vector>

#include "make/day_run.h"

namespace runcert {

/// Marks in the folder of results the runs that an earlier batch of this user published and this
/// one could not make again: `not_current_file` in the run folder says why. Its report still holds
/// for what it names, but is no result of this day, and `verify` says so. Takes the mark from runs
/// that are done. Returns the ids of runs here that no attempt of the day makes, in order.
/// Failure if a mark cannot be written or removed.
std::vector<std::string> mark_runs(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                                   const BatchContext& context);

}  // namespace runcert
