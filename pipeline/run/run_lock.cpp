#include "run/run_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <thread>

#include "core/failure.h"

namespace runcert {
namespace {

// A program that a killed process was just starting has its lock until it has begun or ended.
constexpr std::chrono::seconds longest_inheritance{1};
constexpr std::chrono::milliseconds poll_interval{5};

}  // namespace

RunLock::RunLock(const std::filesystem::path& run_dir)
    : folder_(open(run_dir.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (folder_ < 0) return;  // what is written there then fails with its own reason
    const auto last_try = std::chrono::steady_clock::now() + longest_inheritance;
    while (flock(folder_, LOCK_EX | LOCK_NB) != 0 && (errno == EWOULDBLOCK || errno == EINTR)) {
        if (std::chrono::steady_clock::now() > last_try) {
            close(folder_);
            throw Failure(run_dir.string(), "another program is writing in this run folder",
                          "Wait until it has ended, and run this again");
        }
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
