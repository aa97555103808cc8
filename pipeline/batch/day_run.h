#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "batch/batch_folders.h"
#include "batch/day_attempts.h"
#include "batch/progress.h"
#include "batch/run_update.h"

namespace runcert {

/// How a day's attempts are run on this computer.
struct LocalEngine {
    std::size_t jobs = 1;            ///< runs side by side
    std::uint64_t memory_bytes = 0;  ///< that they may be expected to need together
    std::stop_token finish = {};     ///< no further run is begun
    std::stop_token stop = {};       ///< what runs is ended
};

/// What the day's results need to know of an attempt.
struct AttemptOutcome {
    std::string state = "not_processed";  ///< "done", "failed", "not_processed"
    std::optional<RunFailure> failure = std::nullopt;
    std::string reason = {};  ///< why it was not processed
    FileHashes files = {};    ///< report, pages and verdict, where done
    std::size_t steps_run = 0, steps_kept = 0;
    bool foreign_record = false;  ///< its record was not this user's
};

/// Takes away what killed programs left half written beside the run folders. Only for who holds the
/// day's lock alone.
void remove_half_written(const BatchFolders& folders);

/// Runs the attempts of a day whose place in `selected` is true, and looks at how the others stand.
/// The outcomes are in the order of the day.
std::vector<AttemptOutcome> run_day(const Day& day, const std::vector<bool>& selected,
                                    const BatchContext& context, const LocalEngine& engine,
                                    Progress& progress);

/// How all attempts of a day stand, without running any.
std::vector<RunState> inspect_day(const Day& day, const BatchContext& context, std::size_t jobs);

/// What the results need of a run that was looked at and not made.
AttemptOutcome outcome_of(const DayAttempt& attempt, const RunState& state,
                          const std::string& otherwise);

}  // namespace runcert
