#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <stop_token>
#include <string_view>

namespace runcert {

/// Lets runs begin as long as the memory that they are expected to need together fits a budget; a
/// run that needs more than the whole budget runs alone. Safe for several threads.
class MemoryBudget {
  public:
    /// A budget of so many bytes.
    explicit MemoryBudget(std::uint64_t bytes) : budget_(bytes) {}

    /// Waits until a run with that need fits; false where a stop is requested first. Runs are let
    /// in in the order in which they come, so that small ones do not pass a large one for ever.
    bool acquire(std::uint64_t bytes, const std::stop_token& stop);
    /// Gives back what an `acquire` that returned true took: the same number of bytes.
    void release(std::uint64_t bytes);

  private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::uint64_t budget_;
    std::uint64_t used_ = 0;
    std::size_t running_ = 0;
    std::deque<std::uint64_t> waiting_;  ///< tickets, the next to be let in first
    std::uint64_t next_ticket_ = 0;
};

/// What the programs of a run need at their peak (bytes), for recordings of so many epochs in all:
/// about 1.3 to 2 times what was measured. Measured were, in MiB, the largest of import, enu,
/// screen, window, check and report; smooth; and pages and PDF with gnuplot and WeasyPrint:
///
///     epochs                 others  smooth  pages
///        451  .pos               22      19    116
///      3,000  .pos, CSV          25      53    116
///      3,000  NMEA               25      42    117
///     28,200  .pos, CSV         113     377    117
///     28,200  NMEA               97     293    117
///    100,000  .pos (100 Hz)    381     878    120
///
/// Smoothing takes 9 to 15 KiB for each epoch, and decides from about 10,000 epochs on.
std::uint64_t expected_memory(std::uint64_t epochs);

/// Four fifths of the memory that the computer has available now (bytes), by MemAvailable of
/// /proc/meminfo; 1 GiB where that cannot be read.
std::uint64_t available_memory();

/// About how many epochs a recording of any format holds, rather too many than too few: the marks
/// of epochs in NMEA, UBX, GPX and RINEX, the lines of other texts, one for every 32 bytes of other
/// binary recordings.
std::uint64_t estimated_epochs(std::string_view recording);

}  // namespace runcert
