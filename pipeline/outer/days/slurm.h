#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

// A day on a Slurm cluster, by Slurm's own programs: Slurm alone decides what runs where and when,
// and begins again what a failed node left.
//
// The nodes need the program, the day, its output folder and the user's state folder under the same
// paths as here (shared folders), and the tasks this call's PATH, HOME and XDG_STATE_HOME, which
// sbatch hands on.

namespace runcert {

/// How many tasks an array may have, by the output of `scontrol show config`: no more than half of
/// MaxJobCount, because sbatch waits where the cluster's table of jobs is full. Failure if it does
/// not say, or allows none.
std::size_t most_tasks(const std::string& configuration);
/// The same of the cluster at hand. Failure where Slurm's programs are missing (it says what to
/// install), and where its controller does not answer (in its words).
std::size_t most_tasks();

/// How many tasks, at most so many, are to share some runs: one for each of a few hundred; of more
/// so many that a task lasts minutes.
std::size_t tasks_for(std::size_t runs, std::size_t most);

/// What is to be submitted.
struct ArrayJob {
    std::string name;       ///< of letters, digits, - and _: by it the next call finds the job
    std::size_t tasks = 0;  ///< at least 1; see tasks_for
    std::vector<std::string> command = {};  ///< of each task, completed with `--share I/N`
    std::filesystem::path folder = {};      ///< for what the tasks print; absolute, made if missing
    std::vector<std::string> slurm_args =
        {};  ///< the user's; they override all but array and command
};

/// The id of a job of the user's of that name that waits or runs; empty where there is none.
/// Failure if the controller does not answer.
std::string job_at_work(const std::string& name);

/// Submits the array and waits until all tasks have ended, however they did. A task whose node
/// fails is begun again. Failure if Slurm refuses it, in its words.
void run_array(const ArrayJob& job);

/// The words of what the user gave as --slurm-args, e.g. "--partition=lake --comment 'day 1'", as a
/// shell would see them: quotes, $VARIABLES, ~ and patterns of file names; no commands. Failure
/// if quotes do not end, a variable is not set, or the text holds a command or what steers one
/// (`...`, $(...), |, ;, and the like), and where a word says what runcert must say itself: which
/// tasks there are, what they run, how they are found again, and that sbatch waits for them.
std::vector<std::string> split_slurm_args(std::string_view text);

}  // namespace runcert
