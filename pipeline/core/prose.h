#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Text for people to read on a terminal.

namespace runcert {

/// The text as lines of at most `columns` characters, broken at blanks and ending with a line end.
/// Every line but the first begins with `indent` blanks. The first already has `used` characters
/// before it. A word longer than a line is cut. What would steer a terminal is removed
/// (core/text.h).
std::string wrapped(std::string_view text, std::size_t indent = 4, std::size_t used = 0,
                    std::size_t columns = 100);

/// Characters of a text, not bytes.
std::size_t characters_in(std::string_view text);

/// 1587 as "1,587".
std::string counted(std::int64_t count);
/// "1 epoch", "1,587 epochs".
std::string counted(std::int64_t count, std::string_view noun);

/// "a, b and c"; empty for none.
std::string listed(const std::vector<std::string>& items);

/// A probability in per cent, rounded so that it never appears to pass a limit that it does not
/// reach: 0.97499 gives "97.49 %", 0.02501 gives "2.51 %". Near certainty it gives "more than
/// 99.9999 %" or "less than 0.0001 %".
std::string probability_text(double probability);
/// A required probability in per cent, as written in rules: "97.5 %".
std::string level_text(double level);

}  // namespace runcert
