#pragma once

#include <string_view>

namespace runcert {

/// Whether a text matches a pattern in which * stands for any characters and ? for one.
bool matches_pattern(std::string_view text, std::string_view pattern);

/// Whether a text matches a list of patterns as OpenSSH reads it (PATTERNS in ssh_config(5)):
/// separated by commas, one of them must match, and none that begins with ! may.
bool matches_pattern_list(std::string_view text, std::string_view patterns);

}  // namespace runcert
