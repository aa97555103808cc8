#include "batch/batch_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "batch/batch_folders.h"
#include "batch/day_results.h"
#include "core/failure.h"
#include "core/text.h"
#include "files/folder.h"
#include "files/pattern_list.h"

namespace runcert {
namespace {

void refuse_inner(const Folder& folder, const std::string& name) {
    const Folder inner = folder.open(name);
    for (const std::string& each : inner.names())
        if (inner.kind_of(each) == EntryKind::link) (void)inner.open(each);  // which refuses it
}

/// A folder of results may come from elsewhere: its own parts must lie in it.
void refuse_links(const Folder& folder) {
    for (const std::string& name : folder.names())
        if (folder.kind_of(name) == EntryKind::folder || folder.kind_of(name) == EntryKind::link)
            refuse_inner(folder, name);
}

}  // namespace

std::optional<FolderLock> lock_day(const BatchOrder& order, LockKind kind,
                                   const std::stop_token& stop) {
    const BatchFolders folders(order.context.out);
    const Folder own = make_below(folders.out, folders.own().filename());
    refuse_links(own);
    const std::string lock = folders.day_lock().filename().string();
    if (order.wait)
        return FolderLock::wait_lock(own, lock, kind, stop, [](const std::string& holder) {
            fmt::print(stderr, "waiting for another batch on this folder: {}\n", holder);
        });
    auto taken = FolderLock::try_lock(own, lock, kind);
    if (!taken.lock)
        throw Failure(order.context.out.string(),
                      "another batch is at work on this folder: " + taken.holder,
                      "Wait until it has ended (--wait does), or give another --out");
    return std::move(taken.lock);
}

std::vector<bool> chosen_of(const BatchOrder& order, const Day& day) {
    std::vector<bool> chosen(day.attempts.size(), order.only.empty());
    for (const std::string& pattern : order.only) {
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

std::size_t write_results_of(const BatchOrder& order, const Day& day,
                             const std::vector<RunState>& states) {
    std::vector<AttemptOutcome> outcomes;
    for (std::size_t i = 0; i < states.size(); ++i)
        outcomes.push_back(outcome_of(day.attempts[i], states[i],
                                      "it was not run to its end; the same command makes it"));
    make_day_results(day, outcomes, order.context);
    return static_cast<std::size_t>(std::ranges::count_if(
        outcomes, [](const AttemptOutcome& outcome) { return outcome.state != "done"; }));
}

}  // namespace runcert
