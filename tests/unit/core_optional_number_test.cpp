#include <gtest/gtest.h>

#include "core/optional_number.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(OptionalNumber, TakesTheRoomOfItsNumber) {
    EXPECT_EQ(sizeof(OptionalReal), sizeof(double));
    EXPECT_EQ(sizeof(OptionalInteger), sizeof(std::int64_t));
    EXPECT_EQ(sizeof(OptionalNumber<std::int8_t>), 1U);
}

TEST(OptionalNumber, IsUsedLikeAnOptional) {
    OptionalReal real;
    EXPECT_FALSE(real);
    EXPECT_EQ(real, std::nullopt);
    EXPECT_EQ(real.value_or(2.5), 2.5);
    EXPECT_THROW((void)real.value(), std::bad_optional_access);
    real = 0.0;
    EXPECT_TRUE(real);
    EXPECT_EQ(*real, 0.0);
    EXPECT_EQ(real.value_or(2.5), 0.0);
    real.reset();
    EXPECT_FALSE(real.has_value());

    OptionalCount count = 0;
    EXPECT_TRUE(count);
    count = std::nullopt;
    EXPECT_FALSE(count);
    count = -7;
    EXPECT_EQ(*count, -7);
}

TEST(OptionalNumber, TurnsIntoAnOptionalAndBack) {
    const std::optional<double> there = OptionalReal(1.5);
    const std::optional<double> missing = OptionalReal();
    EXPECT_EQ(there, 1.5);
    EXPECT_FALSE(missing);
    EXPECT_EQ(*OptionalReal(there), 1.5);
    EXPECT_FALSE(OptionalReal(missing));
    // Missing equals missing, although inside it is no number.
    EXPECT_TRUE(OptionalReal() == OptionalReal());
    EXPECT_FALSE(OptionalReal() == OptionalReal(0.0));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
