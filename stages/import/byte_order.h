#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace runcert {

// Whole numbers, two's complement, out of a record's bytes; all of them must be there.

/// The number whose bytes begin at `at`, the least significant one first.
template <std::integral Integer>
constexpr Integer little_endian(std::string_view bytes, std::size_t at) {
    std::make_unsigned_t<Integer> value = 0;
    for (std::size_t i = sizeof(Integer); i-- > 0;)
        value = static_cast<std::make_unsigned_t<Integer>>(
            (std::uint64_t{value} << 8) | static_cast<unsigned char>(bytes[at + i]));
    return std::bit_cast<Integer>(value);
}

/// The same, the most significant one first.
template <std::integral Integer>
constexpr Integer big_endian(std::string_view bytes, std::size_t at) {
    std::make_unsigned_t<Integer> value = 0;
    for (std::size_t i = 0; i < sizeof(Integer); ++i)
        value = static_cast<std::make_unsigned_t<Integer>>(
            (std::uint64_t{value} << 8) | static_cast<unsigned char>(bytes[at + i]));
    return std::bit_cast<Integer>(value);
}

}  // namespace runcert
