#pragma once

#include <string_view>

namespace runcert {

// Patterns: * stands for any characters, ? for one.

/// Whether a pattern matches the whole of a text.
bool matches_pattern(std::string_view text, std::string_view pattern);

/// Whether a text matches a list of patterns as OpenSSH reads it (PATTERNS in ssh_config(5)):
/// separated by commas, one of them must match, and none that begins with ! may.
bool matches_pattern_list(std::string_view text, std::string_view patterns);

}  // namespace runcert
