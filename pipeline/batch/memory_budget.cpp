#include "batch/memory_budget.h"

#include <fstream>
#include <string>

namespace runcert {

bool MemoryBudget::acquire(std::uint64_t bytes, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    const bool granted =
        changed_.wait(lock, stop, [&] { return running_ == 0 || used_ + bytes <= budget_; });
    if (!granted) return false;
    used_ += bytes;
    ++running_;
    return true;
}

void MemoryBudget::release(std::uint64_t bytes) {
    {
        const std::scoped_lock lock(mutex_);
        used_ -= bytes;
        --running_;
    }
    changed_.notify_all();
}

std::uint64_t expected_memory(std::uint64_t recording_bytes) {
    constexpr std::uint64_t programs = std::uint64_t{150} << 20;  // the page's and the PDF's
    constexpr std::uint64_t for_each_byte = 60;
    return programs + for_each_byte * recording_bytes;
}

std::uint64_t available_memory() {
    std::ifstream info("/proc/meminfo");
    std::string key;
    std::uint64_t kibibytes = 0;
    for (std::string unit; info >> key >> kibibytes; std::getline(info, unit))
        if (key == "MemAvailable:") return kibibytes * 1024 / 5 * 4;
    return std::uint64_t{1} << 30;
}

}  // namespace runcert
