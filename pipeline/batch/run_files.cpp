#include "batch/run_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"
#include "files/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

// The names of files half written, those of write_file_atomically and of `place`.
constexpr std::string_view temporary_prefix = ".runcert-";
constexpr std::string_view temporary_suffix = ".tmp";

bool is_regular(const fs::path& file) {
    std::error_code error;
    return fs::is_regular_file(fs::symlink_status(file, error)) && !error;
}

[[noreturn]] void fail(const fs::path& file, const std::error_code& error) {
    throw Failure(file.string(), "the file could not be put in place: " + error.message(),
                  "Check that the folder can be written and has space, and run again");
}

/// Gives `to` the contents of `from`, at once: a link under a temporary name, renamed; a copy where
/// the file system has no links.
void place(const fs::path& from, const fs::path& to) {
    const fs::path temporary =
        to.parent_path() /
        fmt::format("{}{}{}", temporary_prefix, to.filename().string(), temporary_suffix);
    std::error_code error;
    fs::remove(temporary, error);
    fs::create_hard_link(from, temporary, error);
    if (error) {
        write_file_atomically(to, FileView(from).bytes());
        return;
    }
    fs::rename(temporary, to, error);
    if (error) fail(to, error);
    fs::remove(temporary, error);  // rename does nothing where both are the same file already
}

}  // namespace

void remove_temporaries(const fs::path& folder) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with(temporary_prefix) && name.ends_with(temporary_suffix))
            fs::remove_all(entry.path(), ignored);
    }
}

RunFiles::RunFiles(fs::path run_dir, fs::path work_dir)
    : run_dir_(std::move(run_dir)), work_dir_(std::move(work_dir)) {}

std::optional<std::string> RunFiles::hash_of(const fs::path& file) {
    const auto known = hashes_.find(file.string());
    if (known != hashes_.end()) return known->second;
    std::optional<std::string> hash;
    if (is_regular(file)) hash = digest_file(file).sha256;
    return hashes_[file.string()] = hash;
}

std::optional<fs::path> RunFiles::find(const std::string& name, const std::string& sha256) {
    for (const fs::path& folder : {work_dir_, run_dir_})
        if (hash_of(folder / name) == sha256) return folder / name;
    return std::nullopt;
}

bool RunFiles::is_published(const std::string& name, const std::string& sha256) {
    return hash_of(run_dir_ / name) == sha256;
}

bool RunFiles::exists(const std::string& name) const {
    return is_regular(work_dir_ / name) || is_regular(run_dir_ / name);
}

void RunFiles::remove_left() const {
    for (const fs::path& folder : {run_dir_, work_dir_})
        remove_temporaries(folder);
}

void RunFiles::open_work(const std::multimap<std::string, std::string>& known) {
    make_directory(work_dir_);
    for (const auto& entry : fs::directory_iterator(work_dir_)) {
        const std::string name = entry.path().filename().string();
        const auto [begin, end] = known.equal_range(name);
        if (std::any_of(begin, end,
                        [&](const auto& file) { return hash_of(entry.path()) == file.second; }))
            continue;
        std::error_code error;
        fs::remove_all(entry.path(), error);
        if (error) fail(entry.path(), error);
        hashes_.erase(entry.path().string());
    }
}

void RunFiles::bring_to_work(const std::string& name, const std::string& sha256) {
    const auto found = find(name, sha256);
    if (!found)
        throw Failure((run_dir_ / name).string(), "the file changed while the run was made",
                      "Run the batch again");
    if (*found == work_dir_ / name) return;
    place(*found, work_dir_ / name);
    hashes_[(work_dir_ / name).string()] = sha256;
}

std::string RunFiles::written(const std::string& name) {
    hashes_.erase((work_dir_ / name).string());
    const auto hash = hash_of(work_dir_ / name);
    if (!hash)
        throw Failure((work_dir_ / name).string(), "the program ended well without this file",
                      "This is a fault of the program; please report it with the attempt");
    return *hash;
}

void RunFiles::publish(const std::vector<std::string>& names) {
    make_directory(run_dir_);
    std::vector<std::string> changed;
    std::vector<fs::path> files;
    for (const std::string& name : names) {
        const auto hash = hash_of(work_dir_ / name);
        if (!hash || hash_of(run_dir_ / name) == hash) continue;
        changed.push_back(name);
        files.push_back(work_dir_ / name);
    }
    sync_files(files);  // the steps did not
    for (const std::string& name : changed) {
        place(work_dir_ / name, run_dir_ / name);
        hashes_[(run_dir_ / name).string()] = hash_of(work_dir_ / name);
    }
    sync_folder(run_dir_);
}

void RunFiles::withdraw(const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        std::error_code error;
        fs::remove(run_dir_ / name, error);
        if (error) fail(run_dir_ / name, error);
        hashes_.erase((run_dir_ / name).string());
    }
}

void RunFiles::close_work() {
    std::error_code ignored;
    fs::remove_all(work_dir_, ignored);
    hashes_.clear();
}

}  // namespace runcert
