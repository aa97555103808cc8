#include "batch/batch.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "batch/batch_folders.h"
#include "batch/day_results.h"
#include "batch/day_run.h"
#include "batch/interrupts.h"
#include "batch/slurm.h"
#include "batch/slurm_args.h"
#include "core/failure.h"
#include "core/plain_text.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/folder_lock.h"
#include "files/pattern_list.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

/// The lock of the day's folder. Failure where another has it and it is not to be waited for.
std::optional<FolderLock> lock_day(const BatchOrder& order, LockKind kind,
                                   const std::stop_token& stop) {
    const BatchFolders folders(order.context.out);
    make_directory(folders.own());
    if (order.wait)
        return FolderLock::wait_lock(folders.day_lock(), kind, stop, [](const std::string& holder) {
            fmt::print(stderr, "waiting for another batch on this folder: {}\n", holder);
        });
    auto taken = FolderLock::try_lock(folders.day_lock(), kind);
    if (!taken.lock)
        throw Failure(order.context.out.string(),
                      "another batch is at work on this folder: " + taken.holder,
                      "Wait until it has ended (--wait does), or give another --out");
    return std::move(taken.lock);
}

/// Which attempts the patterns choose. Failure where one chooses none: it is mistyped.
std::vector<bool> chosen_by(const std::vector<std::string>& patterns, const Day& day) {
    std::vector<bool> chosen(day.attempts.size(), patterns.empty());
    for (const std::string& pattern : patterns) {
        bool any = false;
        for (std::size_t i = 0; i < chosen.size(); ++i)
            if (matches_pattern(day.attempts[i].id, pattern)) any = chosen[i] = true;
        if (!any)
            throw Failure("--only",
                          fmt::format("no attempt of the day has an id like \"{}\"",
                                      escape_for_message(pattern)),
                          "Ids are letters, digits, - and _; * stands for any of them. "
                          "--status lists those that are not done");
    }
    return chosen;
}

std::set<std::string> lines_in(const fs::path& file) {
    const std::vector<std::string> lines = lines_of(read_file(file));
    return {lines.begin(), lines.end()};
}

std::string interruption_words(Interruption wanted) {
    return wanted == Interruption::finish
               ? "interrupted: what is running is finished first; interrupt again to stop it now"
               : "stopping now: what was running is left as it was";
}

DaySummary summary_of(const std::vector<AttemptOutcome>& outcomes,
                      const std::vector<bool>& selected) {
    DaySummary summary;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        const AttemptOutcome& outcome = outcomes[i];
        if (!selected[i]) continue;
        ++summary.attempts;
        summary.done += outcome.state == "done" ? 1 : 0;
        summary.failed += outcome.state == "failed" ? 1 : 0;
        summary.not_processed += outcome.state == "not_processed" ? 1 : 0;
        summary.steps_run += outcome.steps_run;
        summary.steps_kept += outcome.steps_kept;
    }
    return summary;
}

/// Whether the results are to be written.
enum class Results { written, left };

/// The day's page, or why there is none: to be thrown when the runs have been told of.
struct ResultsWritten {
    std::string page = {};
    std::optional<Failure> trouble = std::nullopt;
};

ResultsWritten results_written(const BatchOrder& order, const Day& day,
                               const std::vector<AttemptOutcome>& outcomes) {
    try {
        make_day_results(day, outcomes, order.context);
        return {.page = (order.context.out / "day.html").string()};
    } catch (const Failure& failure) {
        return {.trouble = failure};
    }
}

int run_selected(const BatchOrder& order, const Day& day, const std::vector<bool>& selected,
                 LockKind lock_kind, Results results) {
    const auto begin = std::chrono::steady_clock::now();
    ProgressOptions options = order.progress;
    options.total = day.attempts.size();
    const auto progress = make_progress(options);
    const Interrupts interrupts(
        [&](Interruption wanted, int) { progress->note(interruption_words(wanted)); });
    const auto lock = lock_day(order, lock_kind, interrupts.finish());
    if (!lock) {
        progress->ends({.closing = {"Interrupted while waiting for another batch."}});
        return 2;
    }
    if (!lock->left_by().empty())
        progress->note("the batch before this one was ended in its midst (" + lock->left_by() +
                       "): going on from there");
    if (lock_kind == LockKind::exclusive) remove_half_written(BatchFolders(order.context.out));
    for (const std::string& note : day.notes)
        progress->note(note);
    const std::vector<AttemptOutcome> outcomes = run_day(day, selected, order.context,
                                                         {.jobs = order.jobs,
                                                          .memory_bytes = order.memory_bytes,
                                                          .finish = interrupts.finish(),
                                                          .stop = interrupts.stop()},
                                                         *progress);
    DaySummary summary = summary_of(outcomes, selected);
    ResultsWritten written;
    if (results == Results::written && !interrupts.stop().stop_requested())
        written = results_written(order, day, outcomes);
    summary.results = written.page;
    if (written.trouble)
        summary.closing.push_back("The day's results could not be written: " +
                                  written.trouble->problem());
    const bool unfinished =
        summary.not_processed > 0 || (results == Results::written && written.page.empty());
    if (interrupts.finish().stop_requested() && unfinished)
        summary.closing.emplace_back(
            "Interrupted. The same command again goes on from here: what was made is kept.");
    else if (summary.failed > 0)
        summary.closing.emplace_back(
            "Where the cause is mended, the same command again makes these alone.");
    summary.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress->ends(summary);
    if (written.trouble) throw Failure(*written.trouble);
    return summary.failed == 0 && !unfinished ? 0 : 2;
}

/// Writes the day's results of what is there. The number of attempts that are not done.
std::size_t write_results_of(const BatchOrder& order, const Day& day,
                             const std::vector<RunState>& states) {
    std::vector<AttemptOutcome> outcomes;
    for (std::size_t i = 0; i < states.size(); ++i)
        outcomes.push_back(outcome_of(day.attempts[i], states[i], "it was not run to its end"));
    make_day_results(day, outcomes, order.context);
    return static_cast<std::size_t>(std::ranges::count_if(
        outcomes, [](const AttemptOutcome& outcome) { return outcome.state != "done"; }));
}

}  // namespace

int run_batch(const BatchOrder& order) {
    const Day day = read_day(order.day, order.context.out);
    return run_selected(order, day, chosen_by(order.only, day), LockKind::exclusive,
                        Results::written);
}

int run_share(const BatchOrder& order, const Share& share, const fs::path& pending) {
    const Day day = read_day(order.day, order.context.out);
    const std::set<std::string> listed = lines_in(pending);
    std::vector<bool> selected(day.attempts.size());
    std::size_t place = 0;
    for (std::size_t i = 0; i < selected.size(); ++i)
        if (listed.contains(day.attempts[i].id)) selected[i] = place++ % share.of == share.part;
    return run_selected(order, day, selected, LockKind::shared, Results::left);
}

int gather_day(const BatchOrder& order) {
    const Day day = read_day(order.day, order.context.out);
    const Interrupts interrupts;
    const auto lock = lock_day(order, LockKind::exclusive, interrupts.finish());
    if (!lock) return 2;
    remove_half_written(BatchFolders(order.context.out));
    const std::size_t missing =
        write_results_of(order, day, inspect_day(day, order.context, order.jobs));
    fmt::print("{} of {} attempts done; results {}\n", day.attempts.size() - missing,
               day.attempts.size(), (order.context.out / "day.html").string());
    return missing == 0 ? 0 : 2;
}

namespace {

fs::path jobs_file(const BatchFolders& folders) {
    return folders.slurm() / "job.json";
}

/// How the jobs of an earlier call stand; nothing where there are none, or they are over.
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
    const auto lock = lock_day(order, LockKind::exclusive, interrupts.finish());
    if (!lock) return 2;
    if (const auto status = jobs_under_way(folders)) {
        fmt::print("nothing was submitted: the jobs of an earlier call are under way\n{}", *status);
        return 0;
    }
    const std::vector<RunState> states = inspect_day(day, order.context, order.jobs);
    const std::vector<std::string> ids = to_do(day, chosen_by(order.only, day), states);
    if (ids.empty()) {
        const std::size_t missing = write_results_of(order, day, states);
        fmt::print("nothing is to be done: {} of {} attempts done; results {}\n",
                   day.attempts.size() - missing, day.attempts.size(),
                   (order.context.out / "day.html").string());
        return missing == 0 ? 0 : 2;
    }
    const fs::path pending = folders.slurm() / "pending.txt";
    make_directory(folders.slurm());
    write_file_atomically(pending, fmt::format("{}\n", fmt::join(ids, "\n")));
    const auto command = with(batch_command(order.day, order.context.out), task_options);
    const SlurmJobs jobs =
        submit({.name = "runcert-" + day.name,
                .tasks = tasks_for(ids.size(), array_limits()),
                .runs = ids.size(),
                .command = with(command, {"--pending", fs::absolute(pending).string()}),
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
