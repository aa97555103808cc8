#include "days/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/prose.h"
#include "core/text.h"
#include "days/day_run.h"
#include "days/interrupts.h"
#include "days/slurm.h"
#include "run/staging_folder.h"
#include "store/external_program.h"
#include "store/sha256.h"
#include "store/user_state.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

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

/// What is done with the runs: made here, with or without the day's results, or only looked at,
/// since a cluster made them.
enum class Work { whole, share, looked_at };

/// The day's page, or why there is none, to be thrown when the outcomes of the runs have been said.
struct ResultsWritten {
    std::string page = {};
    std::optional<Failure> trouble = std::nullopt;
};

ResultsWritten results_written(const BatchOrder& order, const Day& day,
                               const std::vector<AttemptOutcome>& outcomes) {
    try {
        order.write_day(day, outcomes, order.out);
        return {.page = (order.out / "day.html").string()};
    } catch (const Failure& failure) {
        return {.trouble = failure};
    }
}

int run_selected(const BatchOrder& order, const Day& day, const std::vector<bool>& selected,
                 Work work) {
    const auto begin = std::chrono::steady_clock::now();
    ProgressOptions options = order.progress;
    options.total = day.attempts.size();
    const Progress progress = make_progress(options);
    const auto note = [&](const std::string& text) { progress({.what = Note{text}}); };
    const Interrupts interrupts(
        [&](Interruption wanted, int) { note(interruption_words(wanted)); });
    const auto lock =
        lock_day(order.out, work == Work::share ? LockKind::shared : LockKind::exclusive,
                 order.wait || work == Work::looked_at, interrupts.finish());
    if (!lock) {
        progress({.what = DaySummary{.closing = {"Interrupted while waiting for another batch."}}});
        return 2;
    }
    if (!lock->left_by().empty())
        note("the batch before this one was ended in its midst (" + lock->left_by() +
             "): going on from there");
    if (work != Work::share) clear_abandoned(Folder(order.out));
    for (const std::string& text : day.notes)
        note(text);
    if (std::string missing = missing_state(); !missing.empty()) note(missing);
    if (std::string missing = missing_sandbox(); !missing.empty()) note(missing);
    MakerOptions making = order.making;
    // Runs side by side use the processors already; their steps need not share one out again.
    making.threads = std::max(1U, threads_allowed() / static_cast<unsigned>(order.jobs));
    const std::vector<AttemptOutcome> outcomes = run_day(day, selected, order.out, making,
                                                         {.jobs = order.jobs,
                                                          .makes = work != Work::looked_at,
                                                          .finish = interrupts.finish(),
                                                          .stop = interrupts.stop()},
                                                         progress);
    DaySummary summary = summary_of(outcomes, selected);
    ResultsWritten written;
    if (work != Work::share && !interrupts.stop().stop_requested())
        written = results_written(order, day, outcomes);
    summary.results = written.page;
    if (written.trouble)
        summary.closing.push_back("The day's results could not be written: " +
                                  written.trouble->problem());
    const bool unfinished =
        summary.not_processed > 0 || (work != Work::share && written.page.empty());
    if (interrupts.finish().stop_requested() && unfinished)
        summary.closing.emplace_back(
            "Interrupted. The same command again goes on from here: what was made is kept.");
    else if (summary.failed > 0)
        summary.closing.emplace_back(
            "Where the cause is mended, the same command again makes these alone.");
    summary.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    progress({.what = summary});
    if (written.trouble) throw Failure(*written.trouble);
    return summary.failed == 0 && !unfinished ? 0 : 2;
}

/// `PROGRAM batch DAY... --out OUT` for another machine: the running program and absolute paths.
std::vector<std::string> batch_command(const BatchOrder& order,
                                       const std::vector<std::string>& only) {
    std::vector<std::string> words{fs::read_symlink("/proc/self/exe").string(), "batch"};
    for (const fs::path& path : order.day)
        words.push_back(fs::absolute(path).string());
    for (const std::string& pattern : only)
        words.insert(words.end(), {"--only", pattern});
    words.insert(words.end(), {"--out", fs::absolute(order.out).string()});
    return words;
}

/// The ids of the selected attempts that are not done.
std::vector<std::string> ids_to_do(const BatchOrder& order, const Day& day,
                                   const std::vector<bool>& selected) {
    // A batch on this folder would keep the tasks out.
    const auto lock = lock_day(order.out, LockKind::exclusive, order.wait, {});
    std::vector<std::string> ids;
    Day made{.name = day.name, .attempts = {}, .notes = {}};
    for (std::size_t i = 0; i < selected.size(); ++i) {
        const GivenAttempt& attempt = day.attempts[i];
        std::error_code error;
        if (!selected[i] || attempt.refused) continue;
        if (fs::exists(order.out / attempt.id / "report.json", error))
            made.attempts.push_back(attempt);
        else
            ids.push_back(attempt.id);
    }
    const std::vector<RunState> states = inspect_day(made, order.out, order.making, order.jobs);
    for (std::size_t i = 0; i < states.size(); ++i)
        if (!states[i].complete) ids.push_back(made.attempts[i].id);
    return ids;
}

}  // namespace

int run_batch(const BatchOrder& order) {
    const Day day = read_day(order.day, order.out);
    return run_selected(order, day, chosen_of(day, order.only), Work::whole);
}

int run_share(const BatchOrder& order, const Share& share) {
    if (const std::string missing = missing_state(); !missing.empty())
        throw Failure("--share", missing,
                      "Set XDG_STATE_HOME to a folder of this user's that the computers share");
    Day day = read_day(order.day, order.out);
    const std::vector<bool> chosen = chosen_of(day, order.only);
    std::vector<GivenAttempt> own;  // the others are not even looked at
    for (std::size_t i = 0, place = 0; i < chosen.size(); ++i)
        if (chosen[i] && place++ % share.of == share.part)
            own.push_back(std::move(day.attempts[i]));
    day.attempts = std::move(own);
    return run_selected(order, day, std::vector<bool>(day.attempts.size(), true), Work::share);
}

int run_on_cluster(const BatchOrder& order, const std::vector<std::string>& task_options,
                   const std::vector<std::string>& slurm_args) {
    const std::size_t most = most_tasks();
    const Day day = read_day(order.day, order.out);
    const std::vector<bool> selected = chosen_of(day, order.only);
    constexpr std::size_t digits = 8;
    const std::string out = fs::weakly_canonical(fs::absolute(order.out)).string();
    ArrayJob job{.name = fmt::format("runcert-{}-{}", day.name, sha256_hex(out).substr(0, digits)),
                 .folder = fs::absolute(order.out / batch_folder / "slurm"),
                 .slurm_args = slurm_args};
    if (const std::string id = job_at_work(job.name); !id.empty())
        throw Failure("Slurm", fmt::format("job {} of an earlier call is at work on this day", id),
                      fmt::format("Wait until it has ended (squeue --me shows it), or end it with "
                                  "scancel {}; then give this command again",
                                  id));
    if (const std::vector<std::string> to_do = ids_to_do(order, day, selected); !to_do.empty()) {
        // Shares of the whole day may leave some tasks more of a rest than others: few are named.
        constexpr std::size_t few = 1000;  // in a word, of which Linux takes 128 KiB
        job.tasks = tasks_for(to_do.size(), most);
        job.command = batch_command(order, to_do.size() <= few ? to_do : order.only);
        job.command.insert(job.command.end(), task_options.begin(), task_options.end());
        ProgressOptions plain = order.progress;
        if (plain.style == ProgressStyle::terminal) plain.style = ProgressStyle::plain;
        make_progress(plain)(
            {.what = Note{fmt::format("{} to be made by {}, {}. They go on if this call ends; the "
                                      "same command then goes on "
                                      "from what is done.",
                                      counted(static_cast<std::int64_t>(to_do.size()), "run"),
                                      counted(static_cast<std::int64_t>(job.tasks), "task"),
                                      job.name)}});
        run_array(job);
    }
    return run_selected(order, day, selected, Work::looked_at);
}

int say_status(const BatchOrder& order) {
    const Day day = read_day(order.day, order.out);
    std::size_t done = 0;
    std::string lines;
    const std::vector<RunState> states = inspect_day(day, order.out, order.making, order.jobs);
    for (std::size_t i = 0; i < states.size(); ++i) {
        const AttemptOutcome outcome = outcome_of(day.attempts[i], states[i], "");
        if (outcome.state == "done")
            ++done;
        else if (outcome.failure)
            lines += plain_text(fmt::format("  failed  {}: {}: {}", day.attempts[i].id,
                                            outcome.failure->step, outcome.failure->problem)) +
                     "\n";
        else
            lines += plain_text(fmt::format("  to do   {}: {}", day.attempts[i].id,
                                            states[i].steps.empty()
                                                ? "not begun"
                                                : fmt::format("{}: {}", states[i].steps.back().step,
                                                              states[i].steps.back().reason))) +
                     "\n";
    }
    fmt::print("{} of {} attempts done\n{}", done, states.size(), lines);
    return done == states.size() ? 0 : 1;
}

}  // namespace runcert
