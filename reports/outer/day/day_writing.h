#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "days/day_run.h"
#include "reports/day/day.h"

namespace runcert {

/// What became of a day's attempts, read from their run folders, in the order of the day; the
/// curves are those that its page draws. Failure where a file of a run is not as its run wrote it,
/// or not of that attempt.
DayResults results_of_day(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                          const std::vector<std::string>& notes, const std::filesystem::path& out,
                          WindowCurves& curves);

/// Writes the day's results (day.yaml, day.csv, day.html) into the folder of its runs, unless they
/// are those of these outcomes already. What is there under these names and was not written so is
/// set aside. Failure where they cannot be written.
void write_day(const Day& day, const std::vector<AttemptOutcome>& outcomes,
               const std::filesystem::path& out);

}  // namespace runcert
