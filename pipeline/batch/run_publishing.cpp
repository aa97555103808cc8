#include "batch/run_making.h"
#include "files/atomic_file.h"
#include "files/folder.h"
#include "files/sha256.h"
#include "run/run_times.h"
#include "run/staging_folder.h"
#include "trust/attestation_files.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

constexpr const char* report_file = "report.json";
constexpr const char* times_file = "run.yaml";

}  // namespace

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

/// Has them in the work folder, for the page to show and for a new one to stand beside.
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

}  // namespace runcert
