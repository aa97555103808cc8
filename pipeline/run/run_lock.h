#pragma once

#include <filesystem>

namespace runcert {

/// The lock of a run folder, which every program holds while it writes there: certify, a batch that
/// publishes, a stage, sign, timestamp, seal. It ends with the object's life or with the process,
/// however that ends; programs that are started do not inherit it. Readers need none: each file is
/// put in place whole.
class RunLock {
  public:
    /// Takes the lock of a folder that is there. Failure where another program has it. On a file
    /// system that has no locks, nothing is locked.
    explicit RunLock(const std::filesystem::path& run_dir);
    ~RunLock();
    RunLock(const RunLock&) = delete;
    RunLock& operator=(const RunLock&) = delete;

  private:
    int folder_ = -1;
};

}  // namespace runcert
