#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace runcert {

/// A nominal page of Galileo's I/NAV message, two halves of a second each ([GAL-ICD] 4.3.2.3). On
/// E1-B the 40 bits between word and check carry OSNMA ([OSNMA-ICD] 3.1).
struct InavPage {
    std::array<std::uint8_t, 16> word{};  ///< the 128 bits of the word, its type in the first six
    std::uint8_t root_bits = 0;           ///< of the header and root key section (HKROOT)
    std::uint32_t tag_bits = 0;           ///< of the section of tags and key (MACK)
};

/// Reads the even and the odd half, 120 bits each, every one at the start of 16 bytes. Empty where
/// they are not a nominal page, or its cyclic redundancy check fails.
std::optional<InavPage> inav_page(std::span<const std::uint8_t, 32> halves);

}  // namespace runcert
