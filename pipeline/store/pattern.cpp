#include "store/pattern.h"

#include <algorithm>

namespace runcert {

bool matches_pattern(std::string_view text, std::string_view pattern) {
    std::size_t at = 0, in_pattern = 0;
    std::size_t star = std::string_view::npos, star_at = 0;  // the last *, and where it may end
    while (at < text.size()) {
        const char next = in_pattern < pattern.size() ? pattern[in_pattern] : '\0';
        if (next == '*') {
            star = in_pattern++;
            star_at = at;
        } else if (in_pattern < pattern.size() && (next == '?' || next == text[at])) {
            ++in_pattern;
            ++at;
        } else if (star != std::string_view::npos) {
            in_pattern = star + 1;
            at = ++star_at;
        } else {
            return false;
        }
    }
    return pattern.find_first_not_of('*', in_pattern) == std::string_view::npos;
}

bool matches_pattern_list(std::string_view text, std::string_view patterns) {
    bool matches = false;
    while (!patterns.empty()) {
        std::string_view pattern = patterns.substr(0, patterns.find(','));
        patterns.remove_prefix(std::min(pattern.size() + 1, patterns.size()));
        const bool negated = pattern.starts_with('!');
        if (negated) pattern.remove_prefix(1);
        if (!matches_pattern(text, pattern)) continue;
        if (negated) return false;
        matches = true;
    }
    return matches;
}

}  // namespace runcert
