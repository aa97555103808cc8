#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Text for people to read on a terminal.

namespace runcert {

/// The text as lines of at most 100 characters, broken at blanks; every line but the first begins
/// with `indent` blanks, and the first has `used` characters before it. A word longer than a line
/// is cut; what would steer a terminal is taken out (core/plain_text.h). Ends with a line end.
std::string wrapped(std::string_view text, std::size_t indent = 4, std::size_t used = 0);

/// 1587 as "1,587".
std::string counted(std::int64_t count);
/// "1 epoch", "1,587 epochs".
std::string counted(std::int64_t count, std::string_view noun);

/// "a, b and c"; empty for none.
std::string listed(const std::vector<std::string>& items);

/// A probability in per cent, rounded to the side of doubt so that it never shows as one beyond a
/// limit that it does not reach: 0.97499 is "97.49 %", 0.02501 "2.51 %". "more than 99.9999 %" and
/// "less than 0.0001 %" where it is nearly certain.
std::string probability_text(double probability);
/// A level of probability in per cent, as it is written: "97.5 %".
std::string level_text(double level);

}  // namespace runcert
