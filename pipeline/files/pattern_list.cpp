#include "files/pattern_list.h"

#include <cstddef>

namespace runcert {

bool matches_pattern(std::string_view text, std::string_view pattern) {
    // The last * is the only one that needs to be tried again: linear in practice, and never worse
    // than the product of the lengths.
    std::size_t at = 0;
    std::size_t in_pattern = 0;
    std::size_t star = std::string_view::npos;
    std::size_t star_at = 0;
    while (at < text.size()) {
        if (in_pattern < pattern.size() && pattern[in_pattern] == '*') {
            star = in_pattern++;
            star_at = at;
        } else if (in_pattern < pattern.size() &&
                   (pattern[in_pattern] == '?' || pattern[in_pattern] == text[at])) {
            ++at;
            ++in_pattern;
        } else if (star != std::string_view::npos) {
            in_pattern = star + 1;
            at = ++star_at;
        } else {
            return false;
        }
    }
    while (in_pattern < pattern.size() && pattern[in_pattern] == '*')
        ++in_pattern;
    return in_pattern == pattern.size();
}

bool matches_pattern_list(std::string_view text, std::string_view patterns) {
    bool matches = false;
    while (!patterns.empty()) {
        std::string_view pattern = patterns.substr(0, patterns.find(','));
        patterns.remove_prefix(pattern.size() < patterns.size() ? pattern.size() + 1
                                                                : patterns.size());
        const bool negated = pattern.starts_with('!');
        if (negated) pattern.remove_prefix(1);
        if (!matches_pattern(text, pattern)) continue;
        if (negated) return false;
        matches = true;
    }
    return matches;
}

}  // namespace runcert
