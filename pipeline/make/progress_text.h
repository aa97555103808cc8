#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "make/progress.h"

// What is said of attempts and days, as lines for people.

namespace runcert {

/// How the lines of a finished attempt are written.
struct AttemptTextOptions {
    /// The attempt's place in the day, from 0 (shown from 1), of `total`.
    std::size_t index = 0;
    std::size_t total = 0;
    std::size_t columns = 80;  ///< the first line is cut to these
    /// Says why each step ran or was kept.
    bool explain = false;
    bool colour = false;  ///< of the state, by ANSI sequences
};

/// The steps of an attempt that ran.
std::size_t steps_run(const AttemptReport& attempt);

/// The line of a finished attempt, cut to the width; below it, indented, why it failed, and with
/// `explain` why each step ran or was kept. Each ends with a line end.
std::string attempt_text(const AttemptReport& attempt, const AttemptTextOptions& options);

/// A note, as a line; more of them where it has line ends.
std::string note_text(const std::string& note);

/// How many attempts and steps there were, where the results are, and the closing lines.
std::string summary_text(const DaySummary& summary);

/// The closing lines alone.
std::string closing_text(const DaySummary& summary);

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
