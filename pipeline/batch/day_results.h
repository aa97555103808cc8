#pragma once

#include <string>
#include <vector>

#include "batch/day_run.h"

namespace runcert {

/// Writes the day's results (day.yaml, day.csv, day.html) by runcert-day, where they are not
/// already those of these outcomes. Failure where they cannot be written.
void make_day_results(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                      const BatchContext& context);

/// What became of each attempt, as runcert-day reads it.
std::string results_list_text(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                              const std::filesystem::path& out);

}  // namespace runcert
