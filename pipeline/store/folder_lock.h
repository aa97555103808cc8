#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "store/folder.h"

namespace runcert {

/// Alone, or with others that share.
enum class LockKind { exclusive, shared };

/// A lock that processes take so that they do not disturb each other in a folder, e.g. two batches
/// with one output folder. It is held until the end of the object's life or of the process,
/// however that ends, and programs that are started do not inherit it. On a network folder it holds
/// between computers where its file system does (NFS version 4 does).
///
/// The lock's file says for people who holds it and since when; it stays when the lock is released,
/// and may be removed when nobody holds it.
class FolderLock {
  public:
    struct Attempt;

    /// Takes the lock, a file in an open folder, at once, or says who has it; where all who had it
    /// have died, waits up to a second for what they were just starting. The file is made where it
    /// is missing. Failure where it cannot be made or is a link, and where the file system has no
    /// locks.
    static Attempt try_lock(const Folder& folder, const std::string& name, LockKind kind);

    /// Waits until the lock is free and takes it; nothing where a stop is requested first. `waits`
    /// is told who has it, once, when there is something to wait for. Failures as for try_lock.
    static std::optional<FolderLock> wait_lock(
        const Folder& folder, const std::string& name, LockKind kind, const std::stop_token& stop,
        const std::function<void(const std::string& holder)>& waits = {});

    ~FolderLock();
    FolderLock(FolderLock&& other) noexcept = default;

    /// Of an exclusive lock: who held it before and died without releasing it, in the words of
    /// Attempt::holder; empty where nobody did.
    const std::string& left_by() const { return left_by_; }

  private:
    explicit FolderLock(FileDescriptor file) : file_(std::move(file)) {}
    void sign(LockKind kind);

    FileDescriptor file_;
    long entry_ = -1;  ///< where its own line begins in the file
    std::string left_by_;
};

struct FolderLock::Attempt {
    std::optional<FolderLock> lock;
    /// Where there is no lock, who has it: "process 4711 on lake-laptop, since 2026-03-14 10:12:00
    /// UTC". Printable.
    std::string holder;
};

}  // namespace runcert
