#include <fmt/format.h>

#include <chrono>

#include "batch/run_making.h"
#include "batch/step_reason.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"
#include "files/process.h"

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

void RunMaking::run_program(const std::string& step, StepRecord& record) {
    // Every step reads the attempt that was hashed, and not the file, which may change meanwhile.
    const auto copy = files_.work_dir() / std::string(attempt_copy_name);
    const std::string folder =
        claim_.source.folder.empty() ? std::string(".") : claim_.source.folder.string();
    const ProcessResult result = run_process(
        command_of(step_named(step),
                   {.attempt = copy,
                    .run_dir = files_.work_dir(),
                    .import_options = {"--folder", folder},
                    .pdf = context_.report.pdf},
                   context_.program_folder),
        {.environment = {synced_by_caller(), {"RUNCERT_THREADS", std::to_string(context_.threads)}},
         .time_limit = context_.time_limit,
         .stop = stop_,
         .most_output = most_output_of_step,
         .own_group = true});
    if (result.end == ProcessEnd::stopped) throw Interrupted{};
    if (result.end != ProcessEnd::by_itself || result.exit_status != 0) {
        throw StepError{
            failure_of_program(step, result, context_.time_limit,
                               {{copy.string(), claim_.source.file.string()},
                                {files_.work_dir().string(), files_.run_dir().string()}})};
    }
    record.said = lines_of(result.output);
}

/// Does a step in the work folder; the record then has what it said and wrote.
void RunMaking::execute(const std::string& step, StepRecord& record) {
    std::vector<std::string> outputs =
        outputs_of(step_named(step), claim_.attempt, context_.report);
    if (step == "claim") {
        // Messages about the attempt name this file.
        if (given_.file.empty()) {
            make_directory(claim_.source.file.parent_path());
            write_file_atomically(claim_.source.file, claim_.text);
        }
        bring_in_claim(claim_.attempt, claim_.text, claim_.source, files_.work_dir());
    } else if (step == "sign") {
        outputs = {sign()};
    } else {
        if (step == "render") bring_signatures();
        run_program(step, record);
    }
    for (const std::string& name : outputs)
        record.outputs[name] = files_.written(name);
    if (step == "claim" || step == "import") require_as_hashed(step, record);
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

void RunMaking::do_step(const std::string& step, StepRecord record) {
    if (stop_.stop_requested()) throw Interrupted{};
    prepare();  // which may wait for memory; a step's time is its own
    watch_.begins(step);
    const auto begin = std::chrono::steady_clock::now();
    execute(step, record);
    record.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    for (const auto& [name, hash] : record.outputs)
        current_[name] = hash;
    state_.steps.back().seconds = record.seconds;
    record_.steps[step] = std::move(record);
    record_.failure.reset();
    write_record();
    watch_.ends(state_.steps.back());
}

}  // namespace runcert
