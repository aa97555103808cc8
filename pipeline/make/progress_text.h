#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "make/progress.h"

// What is said of the events of a day, as text.

namespace runcert {

/// An event as lines for people, each ended; empty where it says nothing. `colour`: of an attempt's
/// state, by ANSI sequences.
std::string event_lines(const Event& event, const ProgressOptions& options, bool colour = false);

/// Events as lines of JSON, in ASCII. Bytes that are not UTF-8 become U+FFFD.
class EventJson {
  public:
    std::string lines(const Event& event);

  private:
    std::map<std::size_t, std::size_t> told_;  ///< steps of attempts that run
};

/// Brings the texts of attempts that run side by side into the order of the attempts: texts of the
/// first one that has not ended pass, those of later ones are held back.
class ReportOrder {
  public:
    /// What may be said after an event, whose own text is given.
    std::string after(const Event& event, const std::string& text);
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

/// The line that moves. Times are seconds since any moment.
class MovingLine {
  public:
    explicit MovingLine(const ProgressOptions& options)
        : total_(options.total), took_(options.took) {}
    void take(const Event& event, double now_s);

    /// Of a day "12 of 40, 1 failed, 2.5 a minute, 11 min 2 s left; heat-3: smooth 3 s of about
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
