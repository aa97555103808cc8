#include "batch/memory_budget.h"

#include <fstream>
#include <string>

namespace runcert {

bool MemoryBudget::acquire(std::uint64_t bytes, const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    const std::uint64_t ticket = next_ticket_++;
    waiting_.push_back(ticket);
    const bool granted = changed_.wait(lock, stop, [&] {
        return waiting_.front() == ticket && (running_ == 0 || used_ + bytes <= budget_);
    });
    std::erase(waiting_, ticket);
    if (granted) {
        used_ += bytes;
        ++running_;
    }
    lock.unlock();
    changed_.notify_all();  // whoever is next
    return granted;
}

void MemoryBudget::release(std::uint64_t bytes) {
    {
        const std::scoped_lock lock(mutex_);
        used_ -= bytes;
        --running_;
    }
    changed_.notify_all();
}

std::uint64_t expected_memory(std::uint64_t epochs) {
    constexpr std::uint64_t programs = std::uint64_t{150} << 20;  // the page's and the PDF's
    constexpr std::uint64_t for_each_epoch = 16 << 10;            // smoothing
    return programs + for_each_epoch * epochs;
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
