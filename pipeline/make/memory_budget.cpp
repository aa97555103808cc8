#include "make/memory_budget.h"

#include <algorithm>
#include <fstream>
#include <initializer_list>
#include <string>

namespace runcert {
namespace {

using namespace std::string_view_literals;

std::uint64_t count_of(std::string_view mark, std::string_view text) {
    std::uint64_t count = 0;
    for (std::size_t at = text.find(mark); at != std::string_view::npos;
         at = text.find(mark, at + mark.size()))
        ++count;
    return count;
}

/// Of several marks that an epoch may have one each of, how often the one that is there most is.
std::uint64_t most_of(std::initializer_list<std::string_view> marks, std::string_view text) {
    std::uint64_t most = 0;
    for (const std::string_view mark : marks)
        most = std::max(most, count_of(mark, text));
    return most;
}

std::uint64_t marked_epochs(std::string_view recording) {
    if (recording.starts_with('$')) return most_of({"GGA,", "RMC,", "GLL,"}, recording);
    // NAV-PVT, NAV-HPPOSLLH, NAV-POSLLH, NAV-SOL.
    if (recording.starts_with("\xb5\x62"sv))
        return most_of({"\xb5\x62\x01\x07"sv, "\xb5\x62\x01\x14"sv, "\xb5\x62\x01\x02"sv,
                        "\xb5\x62\x01\x06"sv},
                       recording);
    if (recording.substr(0, 80).find("OBSERVATION DATA") != std::string_view::npos)
        return count_of("\n>", recording);  // RINEX 3; RINEX 2 marks none
    return 0;
}

}  // namespace

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

std::uint64_t estimated_epochs(std::string_view recording) {
    constexpr std::size_t looked_at = 4096;
    constexpr std::size_t least_binary_bytes = 32;  // Locosys SBP
    if (const std::uint64_t marked = marked_epochs(recording); marked > 0) return marked;
    if (recording.substr(0, looked_at).find('\0') != std::string_view::npos)
        return recording.size() / least_binary_bytes + 1;
    return most_of({"\n", "<trkpt", "<Trackpoint"}, recording) + 1;
}

}  // namespace runcert
