#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "batch/slurm_jobs.h"

// A day on a Slurm cluster, by Slurm's own programs: Slurm alone decides what runs where and when,
// and begins again what a failed node left.
//
// The nodes need the program, the day and its output folder under the same paths as here (a shared
// folder), and of the environment nothing but PATH, to find the programs that render reports.

namespace runcert {

/// Checks that Slurm can be used. Failure where sbatch, squeue, scontrol or scancel is missing (it
/// says what to install) or the cluster's controller does not answer (in its words).
void slurm_ready();

/// What a cluster lets one job array be.
struct ArrayLimits {
    std::int64_t max_array_size = 0;  ///< MaxArraySize: indices are below it; 0 where none are let
    std::int64_t max_job_count = 0;   ///< MaxJobCount: jobs known at one time; a task counts as one
    std::optional<std::int64_t> max_array_tasks =
        std::nullopt;  ///< max_array_tasks of SchedulerParameters
};

/// The limits in what `scontrol show config` wrote. Failure where they are not in it.
ArrayLimits read_array_limits(std::string_view configuration);
/// The limits of the cluster at hand. Failure where its controller does not answer.
ArrayLimits array_limits();

/// How many tasks an array of so many runs has: one for each run as far as the limits let, and at
/// most half of MaxJobCount, because sbatch waits for minutes where the cluster's table of jobs is
/// full. Task i of N takes the runs i, i + N, i + 2N, ... Failure where no arrays are let.
std::size_t tasks_for(std::size_t runs, const ArrayLimits& limits);

/// `PROGRAM batch DAY... --out OUT` for another machine: the running program and absolute paths.
std::vector<std::string> batch_command(const std::vector<std::filesystem::path>& day,
                                       const std::filesystem::path& out);

/// What is to be submitted.
struct ArrayJob {
    std::string name;         ///< shown by squeue
    std::size_t tasks = 0;    ///< at least 1; see tasks_for
    std::size_t runs = 0;     ///< that they share
    std::size_t at_once = 0;  ///< tasks that run at one time; 0 for as many as there is room for
    std::vector<std::string> command = {};   ///< of each task, completed with `--share I/N`
    std::vector<std::string> gatherer = {};  ///< command of the job that makes the results
    std::filesystem::path folder = {};       ///< for what the jobs print; absolute, made if missing
    std::string memory = {};  ///< of a task, as --mem takes it; empty for the cluster's
    std::vector<std::string> slurm_args =
        {};  ///< the user's; they override all but array and command
};

/// Submits the array, and the job after it that begins when all tasks have ended, however they did.
/// Both are begun again where a node fails. Failure where Slurm refuses either, in its words: then
/// nothing is left submitted.
SlurmJobs submit(const ArrayJob& job);

/// How the tasks of a job stand; `tasks` is how many it was submitted with. A job that Slurm no
/// longer knows is over. Failure where the controller does not answer.
JobState job_state(const std::string& id, const std::string& cluster, std::size_t tasks);

}  // namespace runcert
