#include "make/run_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "run/run_lock.h"
#include "run/staging_folder.h"
#include "store/atomic_file.h"
#include "store/record_key.h"
#include "store/sha256.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

bool is_regular(const fs::path& file) {
    std::error_code error;
    return fs::is_regular_file(fs::symlink_status(file, error)) && !error;
}

}  // namespace

void remove_temporaries(const fs::path& folder) {
    if (!fs::is_directory(folder)) return;
    const Folder opened(folder);
    for (const std::string& name : opened.names())
        if (opened.kind_of(name) == EntryKind::file && name.ends_with(".tmp") &&
            is_own_name(opened, name))
            opened.remove(name);
}

void set_aside(const Folder& folder, const std::string& name, const fs::path& results) {
    const Folder kept = make_below(results, BatchFolders("").superseded());
    std::string free = name;
    for (int number = 2; kept.kind_of(free) != EntryKind::none; ++number)
        free = fmt::format("{}.{}", name, number);
    folder.rename(name, kept, free);
}

RunFiles::RunFiles(fs::path results, const fs::path& run, fs::path work)
    : results_(std::move(results)),
      run_dir_(results_ / run),
      work_(std::move(work)),
      work_dir_(results_ / work_) {}

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
    if (!fs::is_directory(results_)) return;
    const Folder results(results_);
    const std::string run = run_dir_.filename().string();
    if (results.kind_of(run) == EntryKind::link) (void)results.open(run);  // which refuses it
    const RunLock lock(results, run);
    clear_abandoned(results, run);
    remove_temporaries(work_dir_);
}

void RunFiles::open_work(const std::multimap<std::string, std::string>& known) {
    const Folder all = make_below(results_, work_.parent_path());
    const std::string name_of_work = work_.filename().string();
    if (all.kind_of(name_of_work) != EntryKind::none && !is_own_work())
        set_aside(all, name_of_work, results_);
    const Folder work = all.make(name_of_work);
    all.write(seal_name(), own_seal(identity_of(work)) + "\n" + own_seal(text_of_seal(all)));
    for (const std::string& name : work.names()) {
        const fs::path file = work_dir_ / name;
        const auto [begin, end] = known.equal_range(name);
        if (std::any_of(begin, end, [&](const auto& each) { return hash_of(file) == each.second; }))
            continue;
        work.remove_tree(name);
        hashes_.erase(file.string());
    }
}

void RunFiles::bring_to_work(const std::string& name, const std::string& sha256) {
    const auto found = find(name, sha256);
    if (!found)
        throw Failure((run_dir_ / name).string(), "the file changed while the run was made",
                      "Run the batch again");
    if (*found == work_dir_ / name) return;
    Folder(run_dir_).place(name, make_below(results_, work_));
    hashes_[(work_dir_ / name).string()] = sha256;
}

std::string RunFiles::seal_name() const {
    return work_.filename().string() + ".seal";
}

bool RunFiles::is_own_work() const {
    try {
        const Folder all = make_below(results_, work_.parent_path());
        const std::string seals = all.read(seal_name());
        return is_own_seal(identity_of(all.open(work_.filename().string())),
                           seals.substr(0, seals.find('\n')));
    } catch (const Failure&) {
        return false;
    }
}

std::string RunFiles::text_of_seal(const Folder& all) const {
    return "seal " + seal_name() + " in " + identity_of(all);
}

bool RunFiles::is_left_seal(const Folder& all) const {
    if (all.kind_of(work_.filename().string()) != EntryKind::none ||
        all.kind_of(seal_name()) != EntryKind::file)
        return false;
    const std::string seals = all.read(seal_name());
    const std::size_t end = seals.find('\n');
    return end != std::string::npos && is_own_seal(text_of_seal(all), seals.substr(end + 1));
}

std::string RunFiles::written(const std::string& name) {
    hashes_.erase((work_dir_ / name).string());
    const auto hash = hash_of(work_dir_ / name);
    if (!hash)
        throw Failure((work_dir_ / name).string(), "the program ended well without this file",
                      "This is a fault of the program; please report it with the attempt");
    return *hash;
}

void RunFiles::place(const std::map<std::string, std::string>& files, const Folder& to) {
    for (const auto& [name, hash] : files) {
        const auto found = find(name, hash);
        if (!found)
            throw Failure((run_dir_ / name).string(), "the file changed while the run was made",
                          "Run the batch again");
        Folder(found->parent_path()).place(name, to);
    }
}

void RunFiles::close_work() {
    const Folder all = make_below(results_, work_.parent_path());
    if (is_own_work()) {
        all.remove_tree(work_.filename().string());
        all.remove(seal_name());
    } else if (is_left_seal(all)) {
        all.remove(seal_name());  // a kill came between the two
    }
    forget();
}

}  // namespace runcert
