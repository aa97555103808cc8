#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "days/day_run.h"
#include "make/maker.h"
#include "make/progress.h"

namespace runcert {

/// A share of the attempts: those whose place, from 0, modulo `of`, is `part`. `of` is at least 1.
struct Share {
    std::size_t part = 0;
    std::size_t of = 1;
};

/// What a batch is asked to do.
struct BatchOrder {
    std::vector<std::filesystem::path> day;  ///< a folder, a day file, or attempt files
    std::filesystem::path out;               ///< run folders are OUT/ID
    MakerOptions making = {};
    ProgressOptions progress = {};
    /// Runs side by side, at least 1.
    std::size_t jobs = 1;
    std::vector<std::string> only = {};  ///< patterns of ids; empty for all
    bool wait = false;                   ///< for another batch on the same folder to end
    /// Writes the day's results into the folder of its runs (reports/day/day_writing.h).
    std::function<void(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                       const std::filesystem::path& out)>
        write_day = {};
};

/// Certifies the attempts of a day on this computer, and writes its results. The exit status: 0
/// if all chosen attempts were processed, 2 if one could not be, or the batch was interrupted.
/// Failure for what concerns the day as a whole.
int run_batch(const BatchOrder& order);

/// Certifies a share of the chosen attempts, and writes no results. Exit status and Failure as for
/// `run_batch`.
int run_share(const BatchOrder& order, const Share& share);

/// Certifies what is to be done on a Slurm cluster, by one array of tasks, waits for it, and writes
/// the results. `task_options` are passed on to the tasks' calls of this program. The exit status:
/// 0 if all chosen attempts are done, else 2. Failure where Slurm refuses, and where the tasks of
/// an earlier call are still at work.
int run_on_cluster(const BatchOrder& order, const std::vector<std::string>& task_options,
                   const std::vector<std::string>& slurm_args);

/// Prints how the day stands: what is done, failed and to do. The exit status: 0 if all attempts
/// are done, else 1.
int say_status(const BatchOrder& order);

}  // namespace runcert
