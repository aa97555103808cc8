#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

namespace runcert {

/// A number that may be missing, no larger than the number itself, for tables of millions of rows.
/// Used like std::optional, and converts to and from it. The internal value for "missing" is never
/// exposed.
template <class Number>
class OptionalNumber {
  public:
    constexpr OptionalNumber() = default;
    constexpr OptionalNumber(std::nullopt_t) {}
    constexpr OptionalNumber(Number value) : value_(value) {}
    constexpr OptionalNumber(const std::optional<Number>& value)
        : value_(value.value_or(missing)) {}
    constexpr operator std::optional<Number>() const {
        return has_value() ? std::optional<Number>(value_) : std::nullopt;
    }

    constexpr bool has_value() const {
        if constexpr (std::numeric_limits<Number>::has_quiet_NaN)
            return value_ == value_;
        else
            return value_ != missing;
    }
    constexpr explicit operator bool() const { return has_value(); }
    /// The number, which must be present.
    constexpr const Number& operator*() const { return value_; }
    constexpr Number& operator*() { return value_; }
    constexpr Number value() const { return std::optional<Number>(*this).value(); }
    constexpr Number value_or(Number other) const { return has_value() ? value_ : other; }
    constexpr void reset() { value_ = missing; }

    friend constexpr bool operator==(const OptionalNumber& a, const OptionalNumber& b) {
        return std::optional<Number>(a) == std::optional<Number>(b);
    }

  private:
    static constexpr Number missing = std::numeric_limits<Number>::has_quiet_NaN
                                          ? std::numeric_limits<Number>::quiet_NaN()
                                          : std::numeric_limits<Number>::lowest();
    Number value_ = missing;
};

using OptionalReal = OptionalNumber<double>;
using OptionalInteger = OptionalNumber<std::int64_t>;
using OptionalCount = OptionalNumber<std::int32_t>;

}  // namespace runcert
