#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

namespace runcert {

class Folder;

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

    /// Takes the lock at once, or says who has it; where all who had it have died, waits up to a
    /// second for what they were just starting. The file and its folder are made where they are
    /// missing. Failure where the file cannot be made, and where the file system has no locks.
    static Attempt try_lock(const std::filesystem::path& file, LockKind kind);
    /// The same of a file in an open folder (store/folder.h). Failure too where it is a link.
    static Attempt try_lock(const Folder& folder, const std::string& name, LockKind kind);

    /// Waits until the lock is free and takes it; nothing where a stop is requested first. `waits`
    /// is told who has it, once, when there is something to wait for. Failures as for try_lock.
    static std::optional<FolderLock> wait_lock(
        const std::filesystem::path& file, LockKind kind, const std::stop_token& stop,
        const std::function<void(const std::string& holder)>& waits = {});
    static std::optional<FolderLock> wait_lock(
        const Folder& folder, const std::string& name, LockKind kind, const std::stop_token& stop,
        const std::function<void(const std::string& holder)>& waits = {});

    ~FolderLock();
    FolderLock(FolderLock&& other) noexcept;
    FolderLock& operator=(FolderLock&&) = delete;
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

    /// Of an exclusive lock: who held it before and died without releasing it, in the words of
    /// Attempt::holder; empty where nobody did.
    const std::string& left_by() const { return left_by_; }

  private:
    explicit FolderLock(int file) : file_(file) {}
    void sign(LockKind kind);

    int file_ = -1;
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
