#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Text for people to read on a terminal.

namespace runcert {

/// The text as lines of at most 100 characters, broken at blanks; every line but the first begins
/// with `indent` blanks, and the first has `used` characters before it. A word longer than a line
/// is cut; a control character is a "?". Ends with a line end.
std::string wrapped(std::string_view text, std::size_t indent = 4, std::size_t used = 0);

/// 1587 as "1,587".
std::string counted(std::int64_t count);
/// "1 epoch", "1,587 epochs".
std::string counted(std::int64_t count, std::string_view noun);

/// "a, b and c"; empty for none.
std::string listed(const std::vector<std::string>& items);

}  // namespace runcert
