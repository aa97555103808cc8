#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// A day on a Slurm cluster, by Slurm's own programs: Slurm alone decides what runs where and when,
// and begins again what a failed node left.
//
// The nodes need the program, the day, its output folder and the user's state folder under the same
// paths as here (shared folders), and of the environment nothing but PATH.

namespace runcert {

/// What a cluster lets one job array be.
struct ArrayLimits {
    std::int64_t max_array_size = 0;  ///< MaxArraySize: indices are below it; 0 allows none
    std::int64_t max_job_count = 0;   ///< MaxJobCount: jobs known at one time; a task counts as one
    std::optional<std::int64_t> max_array_tasks =
        std::nullopt;  ///< max_array_tasks of SchedulerParameters
};

/// The limits in the output of `scontrol show config`. Failure if they are not in it.
ArrayLimits read_array_limits(std::string_view configuration);
/// The limits of the cluster at hand. Failure where Slurm's programs are missing (it says what to
/// install), and where its controller does not answer (in its words).
ArrayLimits array_limits();

/// How many tasks an array of so many runs has: one for each of a few runs; of many so many that a
/// task lasts minutes, and no more than the limits allow, or half of MaxJobCount, because sbatch
/// waits where the cluster's table of jobs is full. Failure if no arrays are allowed.
std::size_t tasks_for(std::size_t runs, const ArrayLimits& limits);

/// What is to be submitted.
struct ArrayJob {
    std::string name;       ///< shown by squeue, and by which the next call finds it
    std::size_t tasks = 0;  ///< at least 1; see tasks_for
    std::vector<std::string> command = {};  ///< of each task, completed with `--share I/N`
    std::filesystem::path folder = {};      ///< for what the tasks print; absolute, made if missing
    std::vector<std::string> slurm_args =
        {};  ///< the user's; they override all but array and command
};

/// The id of a job of that name that is waiting or running; empty where there is none. Failure if
/// the controller does not answer.
std::string job_at_work(const ArrayJob& job);

/// Submits the array and waits until all tasks have ended, however they did. A task whose node
/// fails is begun again. Failure if Slurm refuses it, in its words.
void run_array(const ArrayJob& job);

/// The words of what the user gave as --slurm-args, e.g. "--partition=lake --comment 'day 1'", as a
/// shell would see them: quotes, $VARIABLES, ~ and patterns of file names; no commands. Failure
/// if quotes do not end, a variable is not set, or the text holds a command or what steers one
/// (`...`, $(...), |, ;, and the like), and where a word says what runcert must say itself: which
/// tasks there are, what they run, and that sbatch waits for them.
std::vector<std::string> split_slurm_args(std::string_view text);

}  // namespace runcert
