#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace runcert {

// Patterns: * stands for any characters, ? for one.

/// Whether a name is a pattern.
bool is_pattern(std::string_view name);

/// Whether a pattern matches the whole of a text.
bool matches_pattern(std::string_view text, std::string_view pattern);

/// Whether a text matches a list of patterns as OpenSSH reads it (PATTERNS in ssh_config(5)):
/// separated by commas, one of them must match, and none that begins with ! may.
bool matches_pattern_list(std::string_view text, std::string_view patterns);

/// A file that a pattern matches.
struct PatternMatch {
    std::string file;                    ///< relative, like the pattern
    std::vector<std::string> stood_for;  ///< what each wildcard stands for; adjacent ones are one
};

/// The files that a pattern matches, relative to a folder, sorted by their bytes. As in a shell, a
/// wildcard stands for no / and not for the dot of a hidden name. Where wildcards could stand for
/// several texts, each takes as few characters as it can. None where a folder does not exist;
/// Failure where one cannot be read.
std::vector<PatternMatch> matching_files(const std::filesystem::path& folder,
                                         const std::string& pattern);

/// How many wildcards a pattern has, adjacent ones being one.
std::size_t wildcard_count(std::string_view pattern);

/// A pattern with each wildcard replaced by the text that it stands for. There must be as many.
std::string filled_in(std::string_view pattern, const std::vector<std::string>& stood_for);

}  // namespace runcert
