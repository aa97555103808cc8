#include <algorithm>

#include "batch/run_making.h"
#include "files/atomic_file.h"
#include "files/sha256.h"
#include "run/run_lock.h"
#include "run/run_times.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

constexpr const char* report_file = "report.json";
constexpr const char* times_file = "run.yaml";

bool is_report(const std::string& name) {
    return name.starts_with("report.");
}

}  // namespace

/// The signatures in the run folder that are of this run's report, beside the batch's own.
FileHashes RunMaking::standing_signatures() const {
    FileHashes hashes;
    if (!files_.is_published(report_file, current_.at(report_file))) return hashes;
    for (const SignatureFile& file : signature_files(files_.run_dir()))
        if (!current_.contains(file.name)) hashes[file.name] = sha256_hex(file.text);
    return hashes;
}

/// Has them in the work folder, for the page to show and for a new one to stand beside.
void RunMaking::bring_signatures() {
    for (const auto& [name, hash] : standing_signatures())
        files_.bring_to_work(name, hash);
}

/// Takes out of the run folder what is not of the run any more: another report with its pages,
/// signatures and time stamps, and files that the run had before and has no longer.
void RunMaking::withdraw_void() {
    std::vector<std::string> names;
    if (!files_.is_published(report_file, current_.at(report_file))) {
        names = {report_file, "report.html", "report.pdf"};
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator(files_.run_dir(), none))
            if (const std::string name = entry.path().filename().string();
                belongs_to_signatures(name))
                names.push_back(name);
        supersede_signatures(files_.run_dir());
    }
    for (const std::string& name : record_.published)
        if (!current_.contains(name) && !is_report(name)) names.push_back(name);
    files_.withdraw(names);
}

/// The reports go out first and in last: a run folder with one is never half old and half new.
void RunMaking::publish() {
    std::vector<std::string> names;
    for (const auto& [name, hash] : current_)
        names.push_back(name);
    std::stable_partition(names.begin(), names.end(),
                          [](const std::string& name) { return !is_report(name); });
    if (!is_published()) {
        make_directory(files_.run_dir());
        const RunLock lock(files_.run_dir());
        withdraw_void();
        std::vector<StageDone> stages;
        for (const Step& step : steps())
            if (const auto done = record_.steps.find(step.name);
                done != record_.steps.end() && is_step_of(step, context_.report))
                stages.push_back({.name = step.name,
                                  .said = done->second.said,
                                  .seconds = done->second.seconds});
        write_file_atomically(files_.run_dir() / times_file, run_times_text(started_, stages));
        files_.publish(names);
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
