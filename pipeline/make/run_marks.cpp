#include "make/run_marks.h"

#include <fmt/format.h>

#include <set>

#include "make/run_record.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

std::string mark_text(const RunFailure& failure) {
    return fmt::format(
        "This run is not current: the last batch could not make it again.\n\n"
        "step: {}\nproblem: {}\nwhere: {}\nwhat to do: {}\n\n"
        "The other files here are of an earlier batch, and of what its report names. Once the "
        "cause "
        "is mended, the same batch makes the run again and removes this file.\n",
        failure.step, failure.problem, failure.where, failure.remedy);
}

/// Whether a batch of this user put a run there.
bool was_published(const BatchContext& context, const std::string& id) {
    const RunRecord record = read_run_record({.file = BatchFolders(context.out).record(id),
                                              .of = "run " + id,
                                              .key = context.record_key});
    return !record.published.empty();
}

void mark(const BatchContext& context, const std::string& id, const AttemptOutcome& outcome) {
    const Folder results(context.out);
    if (results.kind_of(id) != EntryKind::folder) return;
    const Folder run = results.open(id);
    if (outcome.state == "done" && run.kind_of(not_current_file) == EntryKind::file)
        run.remove(not_current_file);
    if (outcome.failure && was_published(context, id)) {
        const std::string text = mark_text(*outcome.failure);
        if (run.kind_of(not_current_file) != EntryKind::file || run.read(not_current_file) != text)
            run.write(not_current_file, text);
    }
}

}  // namespace

std::vector<std::string> mark_runs(const Day& day, const std::vector<AttemptOutcome>& outcomes,
                                   const BatchContext& context) {
    std::set<std::string> ids;
    for (std::size_t i = 0; i < outcomes.size(); ++i) {
        mark(context, day.attempts[i].id, outcomes[i]);
        ids.insert(day.attempts[i].id);
    }
    std::vector<std::string> without_attempt;
    const Folder results(context.out);
    for (const std::string& name : results.names())
        if (!ids.contains(name) && results.kind_of(name) == EntryKind::folder &&
            was_published(context, name))
            without_attempt.push_back(name);
    return without_attempt;
}

}  // namespace runcert
