#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "make/progress.h"
#include "make/run_update.h"

namespace runcert {

/// A share of the attempts: those whose place, from 0, modulo `of`, is `part`. `of` is at least 1.
struct Share {
    std::size_t part = 0;
    std::size_t of = 1;
};

/// What a batch is asked to do.
struct BatchOrder {
    std::vector<std::filesystem::path> day;  ///< a folder, a day file, or attempt files
    BatchContext context;
    ProgressOptions progress = {};
    /// Runs side by side, at least 1.
    std::size_t jobs = 1;
    std::vector<std::string> only = {};  ///< patterns of ids; empty for all
    bool wait = false;                   ///< for another batch on the same folder to end
    /// A sentence if the secret that seals records holds for this call alone; else empty.
    std::string passing_key = {};
};

/// Certifies the attempts of a day on this computer, and writes its results. The exit status: 0
/// if all chosen attempts were processed, 2 if one could not be, or the batch was interrupted.
/// Failure for what concerns the day as a whole.
int run_batch(const BatchOrder& order);

/// Certifies a share of the attempts whose ids `pending` lists, one a line, and writes no results.
/// Exit status and Failure as for `run_batch`.
int run_share(const BatchOrder& order, const Share& share, const std::filesystem::path& pending);

/// Writes the day's results of the runs that are there. First makes those few of the runs listed in
/// `pending` (ids, one a line; empty for none) that their tasks on a cluster left unfinished. The
/// exit status: 0 if all attempts of the day are done, else 2.
int gather_day(const BatchOrder& order, const std::filesystem::path& pending);

/// Submits what is to be done to a Slurm cluster: an array job, and one after it that gathers the
/// results. `task_options` are passed on to their calls. Where nothing is to be done, gathers at
/// once; where earlier jobs are still under way, says how they stand. The exit status: 0, or 2
/// where it gathers and an attempt is not done, or is interrupted while it waits.
int submit_day(const BatchOrder& order, const std::vector<std::string>& task_options,
               const std::vector<std::string>& slurm_args);

/// Prints how the day stands: what is done, failed and to do, and the state of its jobs on a
/// cluster. The exit status: 0 if all attempts are done, else 1.
int say_status(const BatchOrder& order);

}  // namespace runcert
