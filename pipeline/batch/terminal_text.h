#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace runcert {

/// The columns a text takes on a terminal: two for wide characters (Chinese, Japanese, Korean,
/// emoji), none for those that combine with the one before. The text must be plain (plain_text).
std::size_t columns_of(std::string_view text);

/// The text cut to a width, with "..." at its end where it was cut; no character is parted from
/// those that combine with it.
std::string fitted(std::string_view text, std::size_t columns);

}  // namespace runcert
