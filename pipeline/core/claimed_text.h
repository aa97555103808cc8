#pragma once

#include <string>
#include <string_view>

namespace runcert {

/// What somebody states, in quotation marks that nothing in it can close: “Greenbird”. Quotation
/// marks of its own become apostrophes. Empty if nothing is stated.
inline std::string claimed(std::string_view text) {
    std::string inner(text);
    for (const std::string_view mark :
         {"“", "”", "„", "‟", "«", "»", "‹", "›", "″", "＂", "〝", "〞", "\""})
        for (std::size_t at = inner.find(mark); at != std::string::npos; at = inner.find(mark, at))
            inner.replace(at, mark.size(), "'");
    return inner.empty() ? inner : "“" + inner + "”";
}

/// The same of a value beside its key, where it is more than one plain word or number.
inline std::string claimed_value(std::string_view text) {
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-_./";
    return text.find_first_not_of(plain) == text.npos ? std::string(text) : claimed(text);
}

}  // namespace runcert
