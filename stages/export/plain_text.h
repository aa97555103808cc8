#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// Text from outside as it may stand in a file that others display: the same, but U+FFFD for
/// control characters (line feed and tab become a blank), for what is not UTF-8, and for the marks
/// that turn the direction of writing around, which could make a line say something else.
std::string plain_text(std::string_view text);

/// The same with &, <, > and quotes as HTML entities.
std::string html_text(std::string_view text);

}  // namespace runcert
