#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "days/day_attempts.h"
#include "make/maker.h"
#include "make/progress.h"
#include "store/folder_lock.h"

namespace runcert {

/// What a batch keeps in the folder of results beside the runs and the day's pages.
inline constexpr const char* batch_folder = ".runcert";

/// How a day's attempts are run on this computer.
struct LocalEngine {
    std::size_t jobs = 1;         ///< runs side by side
    bool makes = true;            ///< or only looks how they stand
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
};

/// The lock of the folder of results; nothing if a stop is requested while it waits for it.
/// Failure if another batch has it and `wait` is false.
std::optional<FolderLock> lock_day(const std::filesystem::path& out, LockKind kind, bool wait,
                                   const std::stop_token& stop);

/// Which attempts some patterns of ids choose: all if there are no patterns. Failure if one
/// chooses none: it is mistyped.
std::vector<bool> chosen_of(const Day& day, const std::vector<std::string>& only);

/// Runs the attempts of a day that are `selected`, and inspects the others. The outcomes are in the
/// order of the day.
std::vector<AttemptOutcome> run_day(const Day& day, const std::vector<bool>& selected,
                                    const std::filesystem::path& out, const MakerOptions& making,
                                    const LocalEngine& engine, const Progress& progress);

/// How all attempts of a day stand, without running any.
std::vector<RunState> inspect_day(const Day& day, const std::filesystem::path& out,
                                  const MakerOptions& making, std::size_t jobs);

/// The outcome of an attempt whose run was inspected and not made; `otherwise` is the reason where
/// it is neither done nor failed.
AttemptOutcome outcome_of(const GivenAttempt& attempt, const RunState& state,
                          const std::string& otherwise);

}  // namespace runcert
