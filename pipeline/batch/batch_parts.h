#pragma once

#include <optional>
#include <stop_token>
#include <vector>

#include "batch/batch.h"
#include "batch/day_attempts.h"
#include "files/folder_lock.h"

// What the ways of processing a day have in common.

namespace runcert {

/// The lock of the day's folder; nothing where a stop is requested while it is waited for. Failure
/// where another has it and it is not to be waited for.
std::optional<FolderLock> lock_day(const BatchOrder& order, LockKind kind,
                                   const std::stop_token& stop);

/// Which attempts the order's patterns choose. Failure where one chooses none: it is mistyped.
std::vector<bool> chosen_of(const BatchOrder& order, const Day& day);

/// Writes the day's results of how its runs stand. The number of attempts that are not done.
std::size_t write_results_of(const BatchOrder& order, const Day& day,
                             const std::vector<RunState>& states);

}  // namespace runcert
