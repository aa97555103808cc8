#include <fmt/format.h>

#include "batch/run_making.h"
#include "batch/step_reason.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"

namespace runcert {

/// Every file that a step made before, whether it can stay or not.
std::multimap<std::string, std::string> RunMaking::known_files() const {
    std::multimap<std::string, std::string> known(current_.begin(), current_.end());
    for (const auto& [step, record] : record_.steps)
        known.insert(record.outputs.begin(), record.outputs.end());
    return known;
}

/// Opens the work folder, and has all files there that were made or kept so far: the next step
/// reads them there.
void RunMaking::prepare() {
    if (!prepared_) {
        if (!watch_.admitted(estimated_epochs(claim_))) throw Interrupted{};
        files_.open_work(known_files());
        prepared_ = true;
    }
    // Steps between two that are done may have been kept.
    for (const auto& [name, hash] : current_)
        files_.bring_to_work(name, hash);
}

/// Does the steps whose files cannot stay, in the work folder.
void RunMaking::make() {
    StepRecord now;  // of the step that is done
    make_run(
        {.attempt = claim_.attempt,
         .text = claim_.text,
         .source = claim_.source,
         .folder = files_.work_dir(),
         .known_as = files_.run_dir(),
         .report = context_.report,
         .programs = context_.program_folder,
         .process = {.environment = {synced_by_caller(),
                                     {"RUNCERT_THREADS", std::to_string(context_.threads)}},
                     .time_limit = context_.time_limit,
                     .stop = stop_,
                     .most_output = most_output_of_step,
                     .own_group = true},
         .sign = [this] { return sign(); }},
        [&](const Step& step) {
            step_ = step.name;
            now = expected(step.name);
            if (keeps(step.name, now)) return true;
            begin(step.name);
            return false;
        },
        [&](const StageDone& done) { end(done, std::move(now)); });
}

void RunMaking::begin(const std::string& step) {
    if (stop_.stop_requested()) throw Interrupted{};
    prepare();  // which may wait for memory; a step's time is its own
    watch_.begins(step);
    if (step == "claim" && given_.file.empty()) {
        // Messages about the attempt name this file.
        make_directory(claim_.source.file.parent_path());
        write_file_atomically(claim_.source.file, claim_.text);
    }
    if (step == "render") bring_signatures();
}

/// That what a step brought in from outside is what was hashed before. Else the record would have
/// the run made from files that it was not made from, and trust it when they are put back.
void RunMaking::require_as_hashed(const std::string& step, const StepRecord& record) {
    FileHashes brought_in = claim_.files;  // which import brings in once more
    brought_in.insert(record.inputs.begin(), record.inputs.end());
    for (const auto& [name, hash] : brought_in)
        if (files_.written(name) != hash)
            throw StepError{
                {.step = step,
                 .problem = fmt::format("what the run keeps as {} changed while it was read", name),
                 .where = claim_.source.file.string(),
                 .remedy = "Leave the files of the attempt as they are while the batch runs, and "
                           "run it again"}};
}

/// Keeps what a step said and wrote.
void RunMaking::end(const StageDone& done, StepRecord record) {
    for (const std::string& name : done.wrote)
        record.outputs[name] = files_.written(name);
    if (done.name == "claim" || done.name == "import") require_as_hashed(done.name, record);
    record.said = done.said;
    record.seconds = done.seconds;
    for (const auto& [name, hash] : record.outputs)
        current_[name] = hash;
    state_.steps.back().seconds = record.seconds;
    record_.steps[done.name] = std::move(record);
    record_.failure.reset();
    write_record();
    watch_.ends(state_.steps.back());
}

}  // namespace runcert
