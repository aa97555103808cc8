#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <stop_token>

namespace runcert {

/// Lets runs begin as long as the memory that they are expected to need fits a budget together; one
/// that is expected to need more than the whole budget runs alone. For several threads.
class MemoryBudget {
  public:
    explicit MemoryBudget(std::uint64_t bytes) : budget_(bytes) {}

    /// Waits until a run of that need fits; false where a stop is requested first.
    bool acquire(std::uint64_t bytes, const std::stop_token& stop);
    void release(std::uint64_t bytes);

  private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::uint64_t budget_;
    std::uint64_t used_ = 0;
    std::size_t running_ = 0;
};

/// What a run needs at its peak, for recordings of that many bytes in all: measured on recordings
/// of 70 kB to 100 MB, and rounded up.
std::uint64_t expected_memory(std::uint64_t recording_bytes);

/// Four fifths of the memory that the computer has available now.
std::uint64_t available_memory();

}  // namespace runcert
