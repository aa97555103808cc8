#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// Text from outside for a file that others show as HTML: the plain text (core/plain_text.h) with
/// &, <, > and quotes as entities.
std::string html_text(std::string_view text);

}  // namespace runcert
