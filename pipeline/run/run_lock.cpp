#include "run/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>

#include "core/failure.h"
#include "store/user_state.h"

namespace runcert {
namespace {

// A program that a killed process was just starting has its lock until it has begun or ended.
constexpr std::chrono::seconds longest_inheritance{1};
constexpr std::chrono::milliseconds poll_interval{5};

/// Removes what killed programs of this user left half written in a folder, and in those of a run
/// in it. What cannot be removed stays: it is no part of the run.
void remove_half_written(const Folder& folder, bool is_run) {
    try {
        for (const std::string& name : folder.names()) {
            const EntryKind kind = folder.kind_of(name);
            if (kind == EntryKind::folder && (!is_run || is_run_subfolder(name)))
                remove_half_written(folder.open(name), false);
            else if (kind == EntryKind::file && name.ends_with(".tmp") && is_own_name(name))
                folder.remove(name);
        }
    } catch (const Failure&) {
    }
}

}  // namespace

bool is_run_subfolder(std::string_view name) {
    return std::ranges::find(run_subfolders, name) != run_subfolders.end();
}

RunLock::RunLock(const std::filesystem::path& run_dir, RunUse use) {
    std::error_code error;
    const std::filesystem::path real = std::filesystem::canonical(run_dir, error);
    if (error || !real.has_filename()) return;
    if (take(Folder(real.parent_path()), real.filename().string(), run_dir) &&
        use == RunUse::writes)
        remove_half_written(Folder(run_dir), true);
}

RunLock::RunLock(const Folder& parent, const std::string& name) {
    if (take(parent, name, parent.path() / name)) remove_half_written(parent.open(name), true);
}

bool RunLock::take(const Folder& parent, const std::string& name,
                   const std::filesystem::path& shown) {
    constexpr int how = O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW;
    const auto last_try = std::chrono::steady_clock::now() + longest_inheritance;
    while (true) {
        folder_ = FileDescriptor(openat(parent.number(), name.c_str(), how));
        // Without it, what is written there then fails with its own reason.
        if (!folder_.is_open()) return false;
        if (flock(folder_.number(), LOCK_EX | LOCK_NB) == 0) {
            if (parent.has(folder_.number(), name)) return true;
            continue;
        }
        if (errno != EWOULDBLOCK && errno != EINTR) return false;
        if (std::chrono::steady_clock::now() > last_try)
            throw Failure(shown.string(), "another program is writing in this run folder",
                          "Wait until it has ended, and run this again");
        std::this_thread::sleep_for(poll_interval);
    }
}

RunLock::~RunLock() {
    // Closing alone would wait for a program that another thread is just starting.
    if (folder_.is_open()) flock(folder_.number(), LOCK_UN);
}

}  // namespace runcert
