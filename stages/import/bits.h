#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace runcert {

inline constexpr double semicircle_rad =
    3.1415926535898;  // [IS-GPS-200] table 20-IV, [GAL-ICD] 5.1.1

/// Fields of bits out of bytes, the most significant bit first, one after the other.
class Bits {
  public:
    Bits(std::span<const std::uint8_t> bytes, std::size_t at) : bytes_(bytes), at_(at) {}

    void skip(std::size_t count) { at_ += count; }

    std::uint32_t whole(std::size_t count) {
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < count; ++i, ++at_)
            value = value << 1 | ((bytes_[at_ / 8] >> (7 - at_ % 8)) & 1U);
        return value;
    }

    std::int32_t with_sign(std::size_t count) {
        const std::uint32_t value = whole(count);
        const std::uint32_t sign = 1U << (count - 1);
        return static_cast<std::int32_t>((value ^ sign) - sign);
    }

    /// The number times two to the power of `exponent`.
    double scaled(std::size_t count, int exponent) { return std::ldexp(whole(count), exponent); }
    double scaled_with_sign(std::size_t count, int exponent) {
        return std::ldexp(with_sign(count), exponent);
    }
    double angle(std::size_t count, int exponent) {
        return scaled_with_sign(count, exponent) * semicircle_rad;
    }

  private:
    std::span<const std::uint8_t> bytes_;
    std::size_t at_;
};

/// Puts bits together, the most significant one first; the last byte is filled up with zeros.
class BitWriter {
  public:
    void put(std::uint32_t value, std::size_t count) {
        for (std::size_t i = count; i-- > 0; ++size_) {
            if (size_ % 8 == 0) bytes_.push_back(0);
            if ((value >> i) & 1U)
                bytes_.back() = static_cast<std::uint8_t>(bytes_.back() | 1U << (7 - size_ % 8));
        }
    }
    std::vector<std::uint8_t> take() && { return std::move(bytes_); }
    std::string_view text() const {
        return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
    }

  private:
    std::vector<std::uint8_t> bytes_;
    std::size_t size_ = 0;
};

}  // namespace runcert
