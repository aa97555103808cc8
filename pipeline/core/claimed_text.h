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

/// The same of a value beside its key, where it is more than one plain word, or a number with a
/// unit.
inline std::string claimed_value(std::string_view text) {
    constexpr std::string_view number = "0123456789+-.";
    constexpr std::string_view plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789+-_./";
    const std::size_t end = text.find_first_not_of(number);
    const bool has_unit = end != 0 && end != text.npos && text[end] == ' ';
    const std::string_view word = has_unit ? text.substr(end + 1) : text;
    return word.find_first_not_of(plain) == word.npos ? std::string(text) : claimed(text);
}

}  // namespace runcert
