#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "make/day_attempts.h"
#include "make/progress.h"
#include "make/run_files.h"
#include "make/run_update.h"
#include "store/folder_lock.h"

namespace runcert {

/// How a day's attempts are run on this computer.
struct LocalEngine {
    std::size_t jobs = 1;         ///< runs side by side
    std::stop_token finish = {};  ///< no further run is begun
    std::stop_token stop = {};    ///< what runs is ended
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

/// The lock of the folder of results; nothing if a stop is requested while it waits for it.
/// Failure if another batch has it and `wait` is false.
std::optional<FolderLock> lock_day(const std::filesystem::path& out, LockKind kind, bool wait,
                                   const std::stop_token& stop);

/// Which attempts some patterns of ids choose: all if there are no patterns. Failure if one
/// chooses none: it is mistyped.
std::vector<bool> chosen_of(const Day& day, const std::vector<std::string>& only);

/// Removes what killed programs left half written beside the run folders. The caller holds the
/// day's exclusive lock.
void remove_half_written(const BatchFolders& folders);

/// Runs the attempts of a day that are `selected`, and inspects the others. The outcomes are in the
/// order of the day.
std::vector<AttemptOutcome> run_day(const Day& day, const std::vector<bool>& selected,
                                    const BatchContext& context, const LocalEngine& engine,
                                    const Progress& progress);

/// How all attempts of a day stand, without running any.
std::vector<RunState> inspect_day(const Day& day, const BatchContext& context, std::size_t jobs);

/// The outcome of an attempt whose run was inspected and not made; `otherwise` is the reason where
/// it is neither done nor failed.
AttemptOutcome outcome_of(const DayAttempt& attempt, const RunState& state,
                          const std::string& otherwise);

/// Writes the day's results (day.yaml, day.csv, day.html) by runcert-day, unless they are those of
/// these outcomes already. Failure if they cannot be written.
void make_day_results(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                      const BatchContext& context);

/// Writes the day's results of how its runs stand, and says how many are done, after some words.
/// The exit status: 0 if all attempts are done, else 2.
int write_results_of(const Day& day, const std::vector<RunState>& states,
                     const BatchContext& context, std::string_view words_before = "");

}  // namespace runcert
