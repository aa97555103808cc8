#include "run/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <thread>
#include <utility>

#include "core/failure.h"
#include "store/user_state.h"

namespace runcert {
namespace {

// A program that a killed process was just starting has its lock until it has begun or ended.
constexpr std::chrono::seconds longest_inheritance{1};
constexpr std::chrono::milliseconds poll_interval{5};

/// Whether a name is still that of an open folder, and not of one that was exchanged for it.
bool still_names(int parent, const std::filesystem::path& name, bool follow, int folder) {
    struct stat open_one {};
    struct stat named {};
    return fstat(folder, &open_one) == 0 &&
           fstatat(parent, name.c_str(), &named, follow ? 0 : AT_SYMLINK_NOFOLLOW) == 0 &&
           open_one.st_dev == named.st_dev && open_one.st_ino == named.st_ino;
}

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
    if (take(AT_FDCWD, run_dir, true, run_dir) && use == RunUse::writes)
        remove_half_written(Folder(run_dir), true);
}

RunLock::RunLock(const Folder& parent, const std::string& name) {
    if (take(parent.number(), name, false, parent.path() / name))
        remove_half_written(parent.open(name), true);
}

bool RunLock::take(int parent, const std::filesystem::path& name, bool follow,
                   const std::filesystem::path& shown) {
    const int how = O_RDONLY | O_DIRECTORY | O_CLOEXEC | (follow ? 0 : O_NOFOLLOW);
    const auto last_try = std::chrono::steady_clock::now() + longest_inheritance;
    while (true) {
        folder_ = openat(parent, name.c_str(), how);
        if (folder_ < 0) return false;  // what is written there then fails with its own reason
        const bool taken = flock(folder_, LOCK_EX | LOCK_NB) == 0;
        const int error = taken ? 0 : errno;
        if (taken && still_names(parent, name, follow, folder_)) return true;
        if (!taken && error != EWOULDBLOCK && error != EINTR) return false;
        close(std::exchange(folder_, -1));
        if (taken) continue;
        if (std::chrono::steady_clock::now() > last_try)
            throw Failure(shown.string(), "another program is writing in this run folder",
                          "Wait until it has ended, and run this again");
        std::this_thread::sleep_for(poll_interval);
    }
}

RunLock::~RunLock() {
    if (folder_ < 0) return;
    // Closing alone would wait for a program that another thread is just starting.
    flock(folder_, LOCK_UN);
    close(folder_);
}

}  // namespace runcert
