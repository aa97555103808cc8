#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

// A day on a Slurm cluster, by Slurm's own programs: Slurm alone decides what runs where and when,
// and begins again what a failed node left.
//
// The nodes need the program, the day and its output folder under the same paths as here (a shared
// folder), and of the environment nothing but PATH, to find the programs that render reports.

namespace runcert {

/// A day handed to a cluster: a job array that makes the runs, and a job after it that makes the
/// results. Kept in a file, so that a later call finds them.
struct SlurmJobs {
    std::string array;      ///< id of the job array
    std::string gatherer;   ///< id of the job that makes the results
    std::string cluster;    ///< name, where --clusters chose one; else empty
    std::size_t tasks = 0;  ///< of the array
    std::size_t runs = 0;   ///< that the tasks share

    bool operator==(const SlurmJobs&) const = default;
};

/// Writes the file; Failures as for write_file_atomically.
void write_slurm_jobs(const std::filesystem::path& file, const SlurmJobs& jobs);

/// What write_slurm_jobs wrote; nothing if there is no such file. Failure, which says to remove
/// it, where it holds anything else.
std::optional<SlurmJobs> read_slurm_jobs(const std::filesystem::path& file);

/// How the tasks of a job stand.
struct JobState {
    std::size_t pending = 0;   ///< not begun, or to be begun again; held ones too
    std::size_t running = 0;   ///< begun and not ended
    std::size_t over = 0;      ///< ended, however they did
    std::size_t held = 0;      ///< of the pending: those that wait until someone releases them
    std::size_t requeued = 0;  ///< of the pending and running: begun at least twice, e.g. because a
                               ///< node failed
    std::map<std::string, std::size_t> reasons = {};  ///< of the pending, in Slurm's own words

    bool is_over() const { return pending + running == 0; }
};

/// "submitted job 12, 40 tasks for 200 runs; results by job 13", and how to see and end them: lines
/// for people, each ended.
std::string submission_text(const SlurmJobs& jobs);

/// How both jobs stand; lines for people, each ended.
std::string status_text(const SlurmJobs& jobs, const JobState& array, const JobState& gatherer);

/// Checks that Slurm can be used. Failure if sbatch, squeue, scontrol or scancel is missing (it
/// says what to install) or the cluster's controller does not answer (in its words).
void slurm_ready();

/// What a cluster lets one job array be.
struct ArrayLimits {
    std::int64_t max_array_size = 0;  ///< MaxArraySize: indices are below it; 0 allows none
    std::int64_t max_job_count = 0;   ///< MaxJobCount: jobs known at one time; a task counts as one
    std::optional<std::int64_t> max_array_tasks =
        std::nullopt;  ///< max_array_tasks of SchedulerParameters
};

/// The limits in the output of `scontrol show config`. Failure if they are not in it.
ArrayLimits read_array_limits(std::string_view configuration);
/// The limits of the cluster at hand. Failure if its controller does not answer.
ArrayLimits array_limits();

/// How many tasks an array of so many runs has: one for each run as far as the limits allow, and at
/// most half of MaxJobCount, because sbatch waits for minutes where the cluster's table of jobs is
/// full. Task i of N takes the runs i, i + N, i + 2N, ... Failure if no arrays are allowed.
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
/// Both are begun again if a node fails. Failure if Slurm refuses either, in its words: then
/// nothing is left submitted.
SlurmJobs submit(const ArrayJob& job);

/// How the tasks of a job stand; `tasks` is how many it was submitted with. A job that Slurm no
/// longer knows is over. Failure if the controller does not answer.
JobState job_state(const std::string& id, const std::string& cluster, std::size_t tasks);

/// The words of what the user gave as --slurm-args, e.g. "--partition=lake --comment 'day 1'", as a
/// shell would see them: quotes, $VARIABLES, ~ and patterns of file names; no commands. Failure
/// if quotes do not end, a variable is not set, or the text holds a command or what steers one
/// (`...`, $(...), |, ;, and the like).
std::vector<std::string> split_slurm_args(std::string_view text);

/// Checks that words meant for sbatch leave to runcert what it must say itself: which tasks there
/// are, what they run, and that sbatch returns at once. Failure that names the word and what to use
/// instead; whatever else is wrong with the words, sbatch says.
void check_slurm_args(const std::vector<std::string>& words);

}  // namespace runcert
