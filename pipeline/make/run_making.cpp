#include "make/run_making.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "make/run_record.h"
#include "run/chain.h"
#include "run/staging_folder.h"
#include "store/atomic_file.h"
#include "store/folder.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/signature.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

constexpr const char* report_file = "report.json";
constexpr const char* times_file = "run.yaml";

/// A run folder with other files in it does not verify, whoever signs its report.
void require_no_strangers(const std::filesystem::path& run_dir) {
    std::vector<std::string> strangers = unknown_files(run_dir);
    std::erase(strangers, superseded_folder);
    if (strangers.empty()) return;
    throw Failure((run_dir / strangers.front()).string(),
                  "this is no part of the run; nothing was signed",
                  "Move it out of the folder, and run the batch again");
}

/// The signature of this very report that the key made before in that role, if there is one: it and
/// its time stamp stay.
std::optional<std::string> own_signature(const std::filesystem::path& folder,
                                         const ReportFacts& report, const PublicKey& key,
                                         const std::string& role) {
    for (const SignatureFile& file : signature_files(folder)) {
        if (file.kind != SignatureKind::minisign) continue;
        try {
            const SignatureCheck check = check_signature(report.text, file.text, key, file.name);
            if (check.valid && parse_trusted_comment(check.trusted_comment).role == role)
                return file.name;
        } catch (const Failure&) {
            // No signature, whatever it is.
        }
    }
    return std::nullopt;
}

}  // namespace

/// Every file that a step made before, whether it can stay or not.
std::multimap<std::string, std::string> RunMaking::known_files() const {
    std::multimap<std::string, std::string> known(current_.begin(), current_.end());
    for (const auto& [step, record] : record_.steps)
        known.insert(record.outputs.begin(), record.outputs.end());
    return known;
}

/// Opens the work folder and puts all files into it that were made or kept so far, for the next
/// step to read.
void RunMaking::prepare() {
    if (!prepared_) {
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
         .latest = context_.latest,
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
    prepare();
    watch_.begins(step);
    if (step == "claim" && given_.file.empty()) {
        // Messages about the attempt name this file.
        make_directory(claim_.source.file.parent_path());
        write_file_atomically(claim_.source.file, claim_.text);
    }
    if (step == "render") bring_signatures();
}

/// Refuses what a step brought in from outside if it is not what was hashed before. Else the record
/// would name files that the run was not made from, and trust the run when they are put back.
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

/// The signatures in the run folder that are of this run's report, beside the batch's own.
FileHashes RunMaking::standing_signatures() const {
    FileHashes hashes;
    if (!files_.is_published(report_file, current_.at(report_file))) return hashes;
    for (const SignatureFile& file : signature_files(files_.run_dir()))
        if (!current_.contains(file.name)) hashes[file.name] = sha256_hex(file.text);
    return hashes;
}

/// The attestations there of this run's report.
FileHashes RunMaking::standing_attestations() const {
    FileHashes hashes;
    if (!files_.is_published(report_file, current_.at(report_file))) return hashes;
    for (const std::string& name : attestation_names(files_.run_dir()))
        if (std::filesystem::is_regular_file(files_.run_dir() / name))
            hashes[name] = digest_file(files_.run_dir() / name).sha256;
    return hashes;
}

/// Puts the standing signatures and attestations into the work folder: pages show them, and a new
/// signature stands beside them.
void RunMaking::bring_signatures() {
    for (const auto& [name, hash] : standing_signatures())
        files_.bring_to_work(name, hash);
    const Folder work(files_.work_dir());
    work.remove_tree(attestations_folder);
    if (!standing_attestations().empty()) carry_attestations(Folder(files_.run_dir()), work, true);
}

/// The run is whole beside the earlier one before it takes that one's place.
void RunMaking::publish() {
    std::vector<std::string> names;
    for (const auto& [name, hash] : current_)
        names.push_back(name);
    if (!is_published()) {
        StagingFolder staging(Folder(folders_.out), given_.id);
        files_.place(current_, staging.folder());
        carry_over(staging.earlier(), staging.folder());
        std::vector<StageDone> stages;
        for (const Step& step : steps())
            if (const auto done = record_.steps.find(step.name);
                done != record_.steps.end() && is_step_of(step, context_.report))
                stages.push_back({.name = step.name,
                                  .said = done->second.said,
                                  .seconds = done->second.seconds});
        staging.folder().write(times_file, run_times_text(started_, stages));
        staging.publish();
        files_.forget();
    }
    if (record_.published != names || record_.failure) {
        record_.published = names;
        record_.failure.reset();
        write_record();
    }
    files_.close_work();
}

void RunMaking::write_record() const {
    make_directory(folders_.record(given_.id).parent_path());
    write_run_record(record_place(), record_);
}

/// Signs the report that the steps so far made or kept, in the work folder, and returns the name of
/// the signature. A file that was changed since it was hashed is not signed.
std::string RunMaking::sign() {
    bring_signatures();
    const std::filesystem::path& folder = files_.work_dir();
    const ReportFacts report = read_report_facts(folder);
    if (sha256_hex(report.text) != current_.at("report.json"))
        throw Failure((folder / "report.json").string(),
                      "the report changed while the run was made; nothing was signed",
                      "Find out who writes into the folder, and run the batch again");
    require_signable(folder, report, "Make the run again with --force");
    if (files_.is_published("report.json", current_.at("report.json")))
        require_no_strangers(files_.run_dir());
    const std::string role = signing_role(claim_.attempt);
    if (auto standing = own_signature(folder, report, public_key_of(*context_.key), role))
        return *standing;
    state_.signs = what_is_signed(folder);
    return sign_report(folder, report, *context_.key, role);
}

}  // namespace runcert
