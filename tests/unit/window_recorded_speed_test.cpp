#include <gtest/gtest.h>

#include "stages/window/sample_series.h"

namespace runcert::RUNCERT_FILE {
namespace {

TEST(RecordedSpeedOfAnEpoch, ComesFromASpeedWithoutACourseToo) {
    RecordedVelocity row;
    EXPECT_FALSE(recorded_speed(row, Dimension::horizontal));
    row.recorded_speed_m_s = 12.0;
    const auto unstated = recorded_speed(row, Dimension::horizontal);
    ASSERT_TRUE(unstated);
    EXPECT_EQ(unstated->speed_m_s, 12.0);
    EXPECT_FALSE(unstated->standard_uncertainty_m_s);
    row.sigma_recorded_speed_m_s = 0.25;
    EXPECT_DOUBLE_EQ(*recorded_speed(row, Dimension::horizontal)->standard_uncertainty_m_s, 0.25);
    // In space it needs the vertical velocity beside it, and vertically it says nothing.
    EXPECT_FALSE(recorded_speed(row, Dimension::vertical));
    EXPECT_FALSE(recorded_speed(row, Dimension::space));
    row.recorded_velocity_up_m_s = -5.0;
    EXPECT_DOUBLE_EQ(recorded_speed(row, Dimension::space)->speed_m_s, 13.0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
