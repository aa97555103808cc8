#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <string_view>

#include "store/folder.h"

namespace runcert {

/// The folders that a run folder may hold; others in it are the user's own.
inline constexpr std::array<std::string_view, 3> run_subfolders{"superseded", "keys",
                                                                "attestations"};

bool is_run_subfolder(std::string_view name);

/// What is done in a run folder under its lock.
enum class RunUse { writes, reads };

/// The lock of a run folder, which every program holds while it writes there: certify, a batch that
/// publishes, a stage, sign, timestamp, seal, and bundle while it reads. It ends with the object's
/// life or with the process, however that ends; programs that are started do not inherit it.
/// Other readers need none: each file is put in place whole.
///
/// A new run is exchanged for the old folder, and the lock is that of the folder which has the
/// name: whoever waited for the old folder's lock goes on to wait for the new one's.
class RunLock {
  public:
    /// Takes the lock of the folder that a user named, and to write there removes what killed
    /// programs of this user left half written. Failure where another program has it. On a file
    /// system that has no locks, nothing is locked.
    explicit RunLock(const std::filesystem::path& run_dir, RunUse use = RunUse::writes);
    /// The same of a folder in another, where it is no symbolic link.
    RunLock(const Folder& parent, const std::string& name);
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

  private:
    bool take(const Folder& parent, const std::string& name, const std::filesystem::path& shown);

    FileDescriptor folder_;
};

}  // namespace runcert
