#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/text.h"
#include "make/batch.h"
#include "make/day_run.h"
#include "make/interrupts.h"
#include "make/run_files.h"
#include "make/slurm.h"
#include "store/atomic_file.h"

namespace runcert {

namespace {

namespace fs = std::filesystem;

fs::path jobs_file(const BatchFolders& folders) {
    return folders.slurm() / "job.json";
}

/// How the jobs of an earlier call stand; nothing if there are none, or they are over.
std::optional<std::string> jobs_under_way(const BatchFolders& folders) {
    const auto jobs = read_slurm_jobs(jobs_file(folders));
    if (!jobs) return std::nullopt;
    slurm_ready();
    const JobState array = job_state(jobs->array, jobs->cluster, jobs->tasks);
    const JobState gatherer = job_state(jobs->gatherer, jobs->cluster, 1);
    if (array.is_over() && gatherer.is_over()) return std::nullopt;
    return status_text(*jobs, array, gatherer);
}

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The ids of the attempts that are to be made.
std::vector<std::string> to_do(const Day& day, const std::vector<bool>& selected,
                               const std::vector<RunState>& states) {
    std::vector<std::string> ids;
    for (std::size_t i = 0; i < states.size(); ++i)
        if (selected[i] && !day.attempts[i].refused && !states[i].complete)
            ids.push_back(day.attempts[i].id);
    return ids;
}

}  // namespace

int submit_day(const BatchOrder& order, const std::vector<std::string>& task_options,
               const std::vector<std::string>& slurm_args) {
    slurm_ready();
    check_slurm_args(slurm_args);
    const Day day = read_day(order.day, order.context.out);
    const BatchFolders folders(order.context.out);
    const Interrupts interrupts;
    const auto lock =
        lock_day(order.context.out, LockKind::exclusive, order.wait, interrupts.finish());
    if (!lock) return 2;
    if (const auto status = jobs_under_way(folders)) {
        fmt::print("nothing was submitted: the jobs of an earlier call are under way\n{}", *status);
        return 0;
    }
    const std::vector<RunState> states = inspect_day(day, order.context, order.jobs);
    const std::vector<std::string> ids = to_do(day, chosen_of(day, order.only), states);
    if (ids.empty()) return write_results_of(day, states, order.context, "nothing is to be done: ");
    const fs::path pending = folders.slurm() / "pending.txt";
    make_directory(folders.slurm());
    write_file_atomically(pending, fmt::format("{}\n", fmt::join(ids, "\n")));
    const std::vector<std::string> listed{"--pending", fs::absolute(pending).string()};
    const auto command =
        with(with(batch_command(order.day, order.context.out), task_options), listed);
    const SlurmJobs jobs = submit({.name = "runcert-" + day.name,
                                   .tasks = tasks_for(ids.size(), array_limits()),
                                   .runs = ids.size(),
                                   .command = command,
                                   .gatherer = with(command, {"--gather", "--wait"}),
                                   .folder = fs::absolute(folders.slurm()),
                                   .slurm_args = slurm_args});
    write_slurm_jobs(jobs_file(folders), jobs);
    fmt::print("{}", submission_text(jobs));
    return 0;
}

int say_status(const BatchOrder& order) {
    const Day day = read_day(order.day, order.context.out);
    const BatchFolders folders(order.context.out);
    std::size_t done = 0;
    std::vector<std::string> lines;
    const std::vector<RunState> states = inspect_day(day, order.context, order.jobs);
    for (std::size_t i = 0; i < states.size(); ++i) {
        const AttemptOutcome outcome = outcome_of(day.attempts[i], states[i], "");
        if (outcome.state == "done")
            ++done;
        else if (outcome.failure)
            lines.push_back(fmt::format("  failed  {}: {}: {}", day.attempts[i].id,
                                        outcome.failure->step, outcome.failure->problem));
        else
            lines.push_back(fmt::format("  to do   {}: {}", day.attempts[i].id,
                                        states[i].steps.empty()
                                            ? "not begun"
                                            : fmt::format("{}: {}", states[i].steps.back().step,
                                                          states[i].steps.back().reason)));
    }
    fmt::print("{} of {} attempts done\n", done, states.size());
    for (const std::string& line : lines)
        fmt::print("{}\n", plain_text(line));
    if (const auto status = jobs_under_way(folders)) fmt::print("{}", *status);
    return done == states.size() ? 0 : 1;
}

}  // namespace runcert
