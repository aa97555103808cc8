#include "days/day_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "core/failure.h"
#include "core/text.h"
#include "run/staging_folder.h"
#include "schemas/common/product_files.h"
#include "store/pattern.h"

namespace runcert {
namespace {

/// Gives the numbers below `count` to that many threads, each once.
template <class Work>
void for_each_index(std::size_t count, std::size_t threads, Work work) {
    std::atomic<std::size_t> next{0};
    const auto loop = [&] {
        for (std::size_t i = next++; i < count; i = next++)
            work(i);
    };
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min(threads, count); ++i)
        others.emplace_back(loop);
    loop();
}

RunFailure refusal_of(const Failure& failure) {
    return {.step = "day",
            .problem = sentence(failure.problem()),
            .where = failure.where(),
            .remedy = sentence(failure.remedy())};
}

std::string error_text(const RunFailure& failure) {
    return fmt::format("{}: {}\nwhere: {}\nwhat to do: {}", failure.step, failure.problem,
                       failure.where, failure.remedy);
}

/// The files that the day's results name; the others need not be kept in memory.
FileHashes named_in_results(const FileHashes& files) {
    FileHashes named;
    for (const auto& [name, hash] : files)
        if (name == "report.json" || is_page_name(name) || name == products::verdict_file ||
            name.starts_with(products::observations.stem))
            named[name] = hash;
    return named;
}

/// One attempt of the day on this computer.
class AttemptRun {
  public:
    AttemptRun(std::size_t index, const GivenAttempt& attempt, const std::filesystem::path& out,
               const Progress& progress)
        : index_(index),
          attempt_(attempt),
          order_{.attempt = attempt, .run_dir = out / attempt.id},
          progress_(progress) {}

    AttemptOutcome run(const MakerOptions& making, const LocalEngine& engine) {
        if (engine.finish.stop_requested()) {
            tell(AttemptSkipped{});
            // What is there from before counts, unless all is to stop now.
            return outcome_of(attempt_,
                              attempt_.refused || engine.stop.stop_requested()
                                  ? RunState{}
                                  : inspect_run(order_, making),
                              "the batch was interrupted before");
        }
        tell(AttemptBegins{attempt_.id});
        const auto begin = std::chrono::steady_clock::now();
        const RunState state = made(making, engine);
        if (!engine.makes && !state.complete && !state.failure) {
            tell(AttemptSkipped{});
            return outcome_of(attempt_, state,
                              "it was not run to its end; the same command makes it");
        }
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
        report(state, elapsed.count());
        AttemptOutcome outcome =
            outcome_of(attempt_, state, "the batch was interrupted while it ran");
        for (const StepReport& step : state.steps)
            ++(step.ran ? outcome.steps_run : outcome.steps_kept);
        return outcome;
    }

  private:
    RunState made(const MakerOptions& making, const LocalEngine& engine) {
        if (attempt_.refused) return {.failure = refusal_of(*attempt_.refused)};
        const MakerWatch watch{.begins = [&](const std::string& step) { tell(StepBegins{step}); },
                               .ends = [&](const StepReport& step, const StepRecord&,
                                           const std::filesystem::path&) { tell(step); }};
        if (!engine.makes) {
            RunState state = inspect_run(order_, making);
            // The one that would run.
            std::erase_if(state.steps, [](const StepReport& step) { return step.ran; });
            return state;
        }
        return update_run(order_, making, watch, engine.stop);
    }

    template <class What>
    void tell(const What& what) {
        progress_({index_, what});
    }

    void report(const RunState& state, double seconds) {
        AttemptReport report{.id = attempt_.id,
                             .source = attempt_.source,
                             .state = state.complete      ? "done"
                                      : state.interrupted ? "interrupted"
                                                          : "failed",
                             .steps = state.steps,
                             .said = state.said,
                             .signs = state.signs,
                             .superseded = state.superseded,
                             .error = state.failure ? error_text(*state.failure) : "",
                             .seconds = seconds};
        tell(report);
    }

    std::size_t index_;
    const GivenAttempt& attempt_;
    RunOrder order_;
    const Progress& progress_;
};

RunState inspected(const GivenAttempt& attempt, const std::filesystem::path& out,
                   const MakerOptions& making) {
    return inspect_run({.attempt = attempt, .run_dir = out / attempt.id}, making);
}

void refuse_inner(const Folder& folder, const std::string& name) {
    const Folder inner = folder.open(name);
    for (const std::string& each : inner.names())
        if (inner.kind_of(each) == EntryKind::link) (void)inner.open(each);  // which refuses it
}

/// Failure if a part of a folder of results, which may come from elsewhere, is a symbolic link.
void refuse_links(const Folder& folder) {
    for (const std::string& name : folder.names())
        if (folder.kind_of(name) == EntryKind::folder || folder.kind_of(name) == EntryKind::link)
            refuse_inner(folder, name);
}

}  // namespace

std::optional<FolderLock> lock_day(const std::filesystem::path& out, LockKind kind, bool wait,
                                   const std::stop_token& stop) {
    const Folder own = make_below(out, batch_folder);
    refuse_links(own);
    const std::string lock = "batch.lock";
    if (wait)
        return FolderLock::wait_lock(own, lock, kind, stop, [](const std::string& holder) {
            fmt::print(stderr, "waiting for another batch on this folder: {}\n", holder);
        });
    auto taken = FolderLock::try_lock(own, lock, kind);
    if (!taken.lock)
        throw Failure(out.string(), "another batch is at work on this folder: " + taken.holder,
                      "Wait until it has ended (--wait does), or give another --out");
    return std::move(taken.lock);
}

std::vector<bool> chosen_of(const Day& day, const std::vector<std::string>& only) {
    std::vector<bool> chosen(day.attempts.size(), only.empty());
    for (const std::string& pattern : only) {
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

AttemptOutcome outcome_of(const GivenAttempt& attempt, const RunState& state,
                          const std::string& otherwise) {
    if (attempt.refused) return {.state = "failed", .failure = refusal_of(*attempt.refused)};
    if (state.complete) return {.state = "done", .files = named_in_results(state.files)};
    if (state.failure) return {.state = "failed", .failure = state.failure};
    return {.reason = otherwise};
}

std::vector<AttemptOutcome> run_day(const Day& day, const std::vector<bool>& selected,
                                    const std::filesystem::path& out, const MakerOptions& making,
                                    const LocalEngine& engine, const Progress& progress) {
    std::vector<AttemptOutcome> outcomes(day.attempts.size());
    for_each_index(day.attempts.size(), engine.jobs, [&](std::size_t i) {
        const GivenAttempt& attempt = day.attempts[i];
        if (selected[i]) {
            outcomes[i] = AttemptRun(i, attempt, out, progress).run(making, engine);
            return;
        }
        progress({i, AttemptSkipped{}});
        outcomes[i] =
            outcome_of(attempt, attempt.refused ? RunState{} : inspected(attempt, out, making),
                       "left out by --only");
    });
    return outcomes;
}

std::vector<RunState> inspect_day(const Day& day, const std::filesystem::path& out,
                                  const MakerOptions& making, std::size_t jobs) {
    std::vector<RunState> states(day.attempts.size());
    for_each_index(day.attempts.size(), jobs, [&](std::size_t i) {
        const GivenAttempt& attempt = day.attempts[i];
        if (attempt.refused) return;
        states[i] = inspected(attempt, out, making);
        states[i].files = named_in_results(states[i].files);
    });
    return states;
}

}  // namespace runcert
