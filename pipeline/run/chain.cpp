#include "run/chain.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"
#include "files/process.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view workshop_prefix = ".runcert-";

/// Opens a folder and takes its lock, which ends with the process however that ends; -1 where
/// another has it.
int lock_folder(const fs::path& folder) {
    const int file = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (file >= 0 && flock(file, LOCK_EX | LOCK_NB) == 0) return file;
    if (file >= 0) close(file);
    return -1;
}

/// Removes workshops of runs that were killed: those whose lock nobody holds.
void remove_abandoned(const fs::path& run_dir) {
    for (const auto& entry : fs::directory_iterator(run_dir)) {
        if (!entry.path().filename().string().starts_with(workshop_prefix) || !entry.is_directory())
            continue;
        const int lock = lock_folder(entry.path());
        if (lock < 0) continue;
        std::error_code ignored;
        fs::remove_all(entry.path(), ignored);
        close(lock);
    }
}

bool is_report(const std::string& name) {
    return name.starts_with("report.");
}

}  // namespace

StageDone run_stage(const std::string& name, const std::vector<std::string>& arguments,
                    const ProcessOptions& options) {
    std::vector<std::string> command{(program_folder() / ("runcert-" + name)).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    const auto begin = std::chrono::steady_clock::now();
    const ProcessResult result = run_process(command, options);
    if (result.exit_status == 2) throw StageFailed{name, result.errors};
    if (result.exit_status != 0)
        throw Failure("runcert-" + name,
                      fmt::format("the program ended with status {}: {}", result.exit_status,
                                  escape_for_message(result.errors, 400)),
                      "This is a fault of the program; please report it with the attempt");
    return {
        .name = name,
        .said = lines_of(result.output),
        .seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count()};
}

void run_stages(const fs::path& attempt, const fs::path& run_dir, const fs::path& evidence,
                const std::function<void(const StageDone&)>& done) {
    std::vector<std::string> import_arguments{"--attempt", attempt.string(), "--run-dir",
                                              run_dir.string()};
    if (!evidence.empty()) {
        import_arguments.emplace_back("--evidence");
        import_arguments.push_back(evidence.string());
    }
    const ProcessOptions options{.environment = {synced_by_caller()}};
    done(run_stage("import", import_arguments, options));
    // From here on the run folder's own copy of the attempt is read. What is wrong with it is for
    // its author to find in the original.
    const std::string copy = (run_dir / "attempt.yaml").string();
    const std::vector<std::string> arguments{"--attempt", copy, "--run-dir", run_dir.string()};
    for (const char* stage : {"enu", "screen", "smooth", "window", "check"})
        try {
            done(run_stage(stage, arguments, options));
        } catch (StageFailed& failed) {
            const std::size_t at = failed.errors.find(copy);
            if (at != std::string::npos) failed.errors.replace(at, copy.size(), attempt.string());
            throw;
        }
}

Workshop::Workshop(fs::path run_dir)
    : run_dir_(std::move(run_dir)), created_run_dir_(!fs::exists(run_dir_)) {
    make_directory(run_dir_);
    remove_abandoned(run_dir_);
    path_ = run_dir_ / fmt::format("{}{}", workshop_prefix, getpid());
    make_directory(path_);
    lock_ = lock_folder(path_);
}

Workshop::~Workshop() {
    if (lock_ >= 0) close(lock_);
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (created_run_dir_ && fs::is_empty(run_dir_, ignored)) fs::remove(run_dir_, ignored);
}

void Workshop::publish() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(path_))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
        return std::pair(is_report(a), a) < std::pair(is_report(b), b);
    });
    std::vector<fs::path> made;
    for (const std::string& name : names)
        made.push_back(path_ / name);
    sync_files(made);
    std::error_code error;
    // Signatures, time stamps and queries of the earlier report are void.
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
