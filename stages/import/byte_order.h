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

/// A number of a record: where its bytes begin, and what one of it stands for.
template <std::integral Integer, std::endian order = std::endian::little>
struct NumberField {
    std::size_t at = 0;
    double unit = 1.0;

    constexpr Integer whole(std::string_view record) const {
        return order == std::endian::little ? little_endian<Integer>(record, at)
                                            : big_endian<Integer>(record, at);
    }
    constexpr double real(std::string_view record) const {
        return static_cast<double>(whole(record)) * unit;
    }
};

}  // namespace runcert
