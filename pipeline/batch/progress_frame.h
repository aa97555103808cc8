#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

// What a terminal shows below the lines of the finished attempts.

namespace runcert {

/// An attempt that is being run, and the step that it is at.
struct RunningAttempt {
    std::string id;
    std::string step;
    double seconds = 0.0;  ///< since the step began
};

/// What the frame says of the day: counts of attempts, and the pace where it is known.
struct FrameContents {
    std::vector<RunningAttempt> running = {};
    std::size_t total = 0;
    std::size_t ended = 0;  ///< done, failed, interrupted or skipped
    std::size_t failed = 0;
    std::optional<double> runs_per_minute = {};
    /// Until all attempts have ended, as expected.
    std::optional<double> seconds_left = {};
};

/// The size of the terminal, in characters.
struct TerminalSize {
    std::size_t columns = 80;
    std::size_t rows = 24;
};

/// One line for each running attempt, as far as there are rows for them, and the bar. Each takes
/// fewer columns than the terminal has, so that none is broken into two.
std::vector<std::string> frame_lines(const FrameContents& contents, const TerminalSize& size);

/// The rows that lines take which were written on a terminal as wide as it is now, or wider before:
/// it breaks those that have become too long.
std::size_t rows_of(const std::vector<std::string>& lines, std::size_t columns);

}  // namespace runcert
