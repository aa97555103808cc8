#include "make/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <set>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/text.h"
#include "make/day_run.h"
#include "make/interrupts.h"
#include "make/run_files.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

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

/// Says how many runs were made again because their record was not this user's; empty for none.
std::string foreign_records_words(const std::vector<AttemptOutcome>& outcomes) {
    const auto count = std::ranges::count_if(outcomes, &AttemptOutcome::foreign_record);
    if (count == 0) return {};
    return fmt::format("{} recomputed: {} not written by this user's batches, or not as written.",
                       count == 1 ? "1 run was" : fmt::format("{} runs were", count),
                       count == 1 ? "its record was" : "their records were");
}

/// Whether the results are to be written.
enum class Results { written, left };

/// The day's page, or why there is none, to be thrown when the outcomes of the runs have been said.
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
    const Progress progress = make_progress(options);
    const auto note = [&](const std::string& text) { progress({.what = Note{text}}); };
    const Interrupts interrupts(
        [&](Interruption wanted, int) { note(interruption_words(wanted)); });
    const auto lock = lock_day(order.context.out, lock_kind, order.wait, interrupts.finish());
    if (!lock) {
        progress({.what = DaySummary{.closing = {"Interrupted while waiting for another batch."}}});
        return 2;
    }
    if (!lock->left_by().empty())
        note("the batch before this one was ended in its midst (" + lock->left_by() +
             "): going on from there");
    if (lock_kind == LockKind::exclusive) remove_half_written(BatchFolders(order.context.out));
    for (const std::string& text : day.notes)
        note(text);
    if (!order.passing_key.empty()) note(order.passing_key);
    if (std::string missing = missing_sandbox(); !missing.empty()) note(missing);
    BatchContext context = order.context;
    // Runs side by side use the processors already; their steps need not share one out again.
    context.threads = std::max(1U, threads_allowed() / static_cast<unsigned>(order.jobs));
    const std::vector<AttemptOutcome> outcomes = run_day(
        day, selected, context,
        {.jobs = order.jobs, .finish = interrupts.finish(), .stop = interrupts.stop()}, progress);
    DaySummary summary = summary_of(outcomes, selected);
    if (std::string words = foreign_records_words(outcomes); !words.empty())
        summary.closing.push_back(std::move(words));
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
    progress({.what = summary});
    if (written.trouble) throw Failure(*written.trouble);
    return summary.failed == 0 && !unfinished ? 0 : 2;
}

/// The submitted runs whose task ended before they did: a node was lost, or could not begin it.
/// None if they are so many that the cluster, or a cancellation, is the reason.
std::vector<bool> lost_runs(const BatchOrder& order, const Day& day,
                            const std::set<std::string>& submitted) {
    const std::vector<RunState> states = inspect_day(day, order.context, order.jobs);
    std::vector<bool> lost(states.size());
    for (std::size_t i = 0; i < states.size(); ++i)
        lost[i] = submitted.contains(day.attempts[i].id) && !day.attempts[i].refused &&
                  !states[i].complete && !states[i].failure;
    constexpr std::size_t few = 3;
    const auto count = static_cast<std::size_t>(std::ranges::count(lost, true));
    if (count > std::max(few, submitted.size() / 10)) lost.assign(states.size(), false);
    return lost;
}

}  // namespace

int run_batch(const BatchOrder& order) {
    const Day day = read_day(order.day, order.context.out);
    return run_selected(order, day, chosen_of(day, order.only), LockKind::exclusive,
                        Results::written);
}

int run_share(const BatchOrder& order, const Share& share, const fs::path& pending) {
    if (!order.passing_key.empty())
        throw Failure("--share", order.passing_key,
                      "Set XDG_STATE_HOME to a folder of this user's that the computers share");
    const Day day = read_day(order.day, order.context.out);
    const std::set<std::string> listed = lines_in(pending);
    std::vector<bool> selected(day.attempts.size());
    std::size_t place = 0;
    for (std::size_t i = 0; i < selected.size(); ++i)
        if (listed.contains(day.attempts[i].id)) selected[i] = place++ % share.of == share.part;
    return run_selected(order, day, selected, LockKind::shared, Results::left);
}

int gather_day(const BatchOrder& order, const fs::path& pending) {
    const Day day = read_day(order.day, order.context.out);
    if (!pending.empty())
        if (const std::vector<bool> lost = lost_runs(order, day, lines_in(pending));
            std::ranges::count(lost, true) > 0)
            run_selected(order, day, lost, LockKind::shared, Results::left);
    const Interrupts interrupts;
    const auto lock =
        lock_day(order.context.out, LockKind::exclusive, order.wait, interrupts.finish());
    if (!lock) return 2;
    remove_half_written(BatchFolders(order.context.out));
    return write_results_of(day, inspect_day(day, order.context, order.jobs), order.context);
}

}  // namespace runcert
