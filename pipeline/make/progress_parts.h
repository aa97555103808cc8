#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "make/progress.h"

// What the ways of showing progress are made of.

namespace runcert {

/// Brings the texts of attempts that run side by side into the order of the attempts: texts of the
/// first one that has not ended pass, those of later ones are held back.
class ReportOrder {
  public:
    /// A text of an attempt; returns what may be said now.
    std::string say(std::size_t index, std::string_view text);
    /// Nothing more is said of an attempt; returns what may be said now: what was held back for it.
    std::string end(std::size_t index);
    /// All that is held back, in order; afterwards nothing is.
    std::string rest();

  private:
    struct Held {
        std::string text = {};
        bool ended = false;
    };
    std::map<std::size_t, Held> held_;
    std::size_t next_ = 0;  ///< the first attempt that has not ended
};

/// How fast a day goes, judged by the attempts that really ran: one of which everything was kept
/// takes next to no time and says nothing about those to come. Times are seconds since any moment.
class Pace {
  public:
    /// The attempt of that index begins.
    void begins(std::size_t index, double now_s);
    /// It has ended; `ran` is false where everything was kept. An index that has not begun is
    /// passed over.
    void ends(std::size_t index, bool ran, double now_s);

    /// Attempts that ran, in a minute, since the first one began; nothing before one has ended.
    std::optional<double> runs_per_minute(double now_s) const;

    /// The time (s) that the attempts running and `waiting` more will take, if each takes as long
    /// as those that ran did and as many go side by side; nothing before one has ended.
    std::optional<double> seconds_left(std::size_t waiting, double now_s) const;

  private:
    std::map<std::size_t, double> running_;  ///< when they began
    std::optional<double> first_began_s_;
    std::size_t side_by_side_ = 0;
    std::size_t ran_ = 0;
    double ran_for_s_ = 0.0;
};

/// An attempt that is being run, and the step that it is at.
struct RunningAttempt {
    std::string id;
    std::string step;
    double seconds = 0.0;  ///< since the step began
};

/// What the frame, below the lines of the finished attempts, says of the day: counts of attempts,
/// and the pace where it is known.
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

/// The rows that lines take on a terminal which may have been wider when they were written: it
/// breaks those that have become too long.
std::size_t rows_of(const std::vector<std::string>& lines, std::size_t columns);

/// Progress in the style `terminal`. Only `make_progress` calls this.
std::unique_ptr<Progress> make_terminal_progress(const ProgressOptions& options);

}  // namespace runcert
