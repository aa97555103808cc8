#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "make/progress.h"

// What is said of the events of a day, as text.

namespace runcert {

/// Says the events of a day as lines, for people or (in ASCII; bytes that are not UTF-8 become
/// U+FFFD) of JSON. The texts of attempts that run side by side are brought into the order of the
/// attempts: those of the first one that has not ended pass, those of later ones are held back.
class EventLines {
  public:
    /// `colour`: of an attempt's state, by ANSI sequences.
    explicit EventLines(const ProgressOptions& options, bool colour = false)
        : options_(options), colour_(colour) {}
    /// What may be said after an event: lines, each ended; that of an attempt is cut to the width.
    std::string after(const Event& event, std::size_t columns);
    /// All that is held back, in order; afterwards nothing is.
    std::string rest();

  private:
    std::string for_people(const Event& event) const;
    std::string json(const Event& event);

    struct Attempt {
        std::string held = {};
        std::size_t steps_told = 0;
        bool ended = false;
    };
    ProgressOptions options_;
    bool colour_;
    std::map<std::size_t, Attempt> attempts_;
    std::size_t next_ = 0;  ///< the first attempt that has not ended
};

/// The line that moves. Times are seconds since any moment.
class MovingLine {
  public:
    explicit MovingLine(const ProgressOptions& options)
        : total_(options.total), took_(options.took) {}
    void take(const Event& event, double now_s);

    /// Of a day "12 of 40, 1 failed, 11 min 2 s left, 2.5 a minute; heat-3: smooth 3 s of about
    /// 8 s, 2 more"; of one attempt "smooth 3 s of about 8 s". The pace is that of the attempts
    /// that really ran: one of which everything was kept says nothing about those to come.
    std::string text(double now_s) const;

  private:
    struct Running {
        std::string id;
        std::string step = "begins";
        double since_s = 0.0;
    };
    std::size_t total_;
    std::map<std::string, double> took_;  ///< seconds of a step the last time
    std::map<std::size_t, Running> running_;
    std::size_t ended_ = 0, failed_ = 0, ran_ = 0;
    std::optional<double> began_s_;
    double last_ended_s_ = 0.0;  ///< when the last of those that ran ended
};

/// Seconds as text, rounded to the last unit shown; negative ones as 0.
/// 8.31 as "8.3 s", 754 as "12 min 34 s", 7500 as "2 h 5 min".
std::string duration_text(double seconds);

/// The columns a text takes on a terminal: two for wide characters (Chinese, Japanese, Korean,
/// emoji), none for those that combine with the one before. The text must be plain (plain_text).
std::size_t columns_of(std::string_view text);

/// The text cut to a width, with "..." at its end where it was cut; no character is parted from
/// those that combine with it.
std::string fitted(std::string_view text, std::size_t columns);

}  // namespace runcert
