#include "run/chain.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"
#include "files/process.h"
#include "run/attempt_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view staging_prefix = ".runcert-";

/// Removes staging folders of runs that were killed: whoever makes one holds the lock of the run
/// folder.
void remove_abandoned(const fs::path& run_dir) {
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        if (!entry.path().filename().string().starts_with(staging_prefix) || !entry.is_directory())
            continue;
        std::error_code ignored;
        fs::remove_all(entry.path(), ignored);
    }
}

bool is_report(const std::string& name) {
    return name.starts_with("report.");
}

}  // namespace

StageDone run_step(std::string_view step, const StepCall& call, const ProcessOptions& options) {
    const Step& what = step_named(step);
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(command_of(what, call, program_folder()), options);
    if (result.exit_status == 2) throw StageFailed{what.name, result.errors};
    if (result.exit_status != 0)
        throw Failure(what.program,
                      fmt::format("the program ended with status {}: {}", result.exit_status,
                                  escape_for_message(result.errors, 400)),
                      "This is a fault of the program; please report it with the attempt");
    return {
        .name = what.name,
        .said = lines_of(result.output),
        .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

void run_stages(const fs::path& attempt, const fs::path& run_dir, const fs::path& earlier_run,
                const std::function<void(const StageDone&)>& done) {
    StepCall call{.attempt = attempt, .run_dir = run_dir};
    if (!earlier_run.empty()) call.import_options = {"--earlier-run", earlier_run.string()};
    const ProcessOptions options{.environment = {synced_by_caller()}};
    const fs::path copy = run_dir / attempt_copy_name;
    for (const Step& step : steps()) {
        if (step.product == nullptr) continue;
        try {
            done(run_step(step.name, call, options));
        } catch (StageFailed& failed) {
            const std::size_t at = failed.errors.find(copy.string());
            if (at != std::string::npos)
                failed.errors.replace(at, copy.string().size(), attempt.string());
            throw;
        }
        // From here on the run folder's own copy of the attempt is read. What is wrong with it is
        // for its author to find in the original.
        call.attempt = copy;
    }
}

StagingFolder::StagingFolder(fs::path run_dir)
    : run_dir_(std::move(run_dir)), created_run_dir_(!fs::exists(run_dir_)) {
    make_directory(run_dir_);
    lock_.emplace(run_dir_);
    remove_abandoned(run_dir_);
    path_ = run_dir_ / fmt::format("{}{}", staging_prefix, getpid());
    make_directory(path_);
}

StagingFolder::~StagingFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (created_run_dir_ && fs::is_empty(run_dir_, ignored)) fs::remove(run_dir_, ignored);
}

void StagingFolder::publish() {
    std::vector<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(path_)) {
        const fs::path name = fs::relative(entry.path(), path_);
        if (entry.is_directory()) {
            refuse_link(run_dir_ / name);
            make_directory(run_dir_ / name);
        } else {
            names.push_back(name.string());
        }
    }
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
        return std::pair(is_report(a), a) < std::pair(is_report(b), b);
    });
    std::vector<fs::path> made;
    for (const std::string& name : names)
        made.push_back(path_ / name);
    sync_files(made);
    std::error_code error;
    // What still stands of the earlier report's signatures was brought into this folder.
    std::vector<fs::path> old;
    for (const auto& entry : fs::directory_iterator(run_dir_))
        if (entry.path().filename().string().starts_with("report.json."))
            old.push_back(entry.path());
    for (const char* name : {"report.json", "report.html", "report.pdf"})
        old.push_back(run_dir_ / name);
    for (const fs::path& file : old)
        fs::remove(file, error);
    for (const std::string& name : names) {
        fs::rename(path_ / name, run_dir_ / name, error);
        if (error)
            throw Failure((run_dir_ / name).string(),
                          "the file could not be put in place: " + error.message(),
                          "Check that the folder can be written, and run again");
    }
    sync_folder(run_dir_);
}

}  // namespace runcert
