#pragma once

#include <array>
#include <string_view>
#include <utility>

namespace runcert {

/// The words for the values of an enumeration, as used in files.
template <class Enum, std::size_t N>
using EnumWords = std::array<std::pair<Enum, std::string_view>, N>;

template <class Enum, std::size_t N>
constexpr std::string_view word_of(const EnumWords<Enum, N>& words, Enum value) {
    for (const auto& [candidate, word] : words)
        if (candidate == value) return word;
    return {};
}

/// Finds the value of a word. Returns false, and leaves `value` unchanged, where the word is
/// unknown.
template <class Enum, std::size_t N>
constexpr bool value_of(const EnumWords<Enum, N>& words, std::string_view text, Enum& value) {
    for (const auto& [candidate, word] : words)
        if (word == text) {
            value = candidate;
            return true;
        }
    return false;
}

}  // namespace runcert
