#include <gtest/gtest.h>

#include "stages/window/sample_series.h"
#include "stages/window/window.h"
#include "window_test_support.h"

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

// A channel that was never filled in says the same all over.
TEST(RecordedSpeed, ThatNeverChangesIsRefusedByNameWhereTheCraftMovesOtherwise) {
    ScreenedTable screened = test::recorded({});
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    const TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    Profile rule = test::rule_over(2.0, SpeedDefinition::mean_n);
    rule.speed_source = SpeedSource::velocity;
    const auto missing_at = [&](double fast_m_s, double standing_m_s) {
        for (std::size_t k = 0; k < screened.rows.size(); ++k)
            screened.rows[k].recorded_speed_m_s = k < 200 ? standing_m_s : fast_m_s;
        return find_windows(screened, trajectory, {rule}, test::few_draws())
            .profiles.front()
            .missing;
    };
    const std::string missing = missing_at(12.3, 12.3);
    EXPECT_NE(missing.find("the recorded speed is 12.3 m/s at all 401 epochs while the positions "
                           "move at "),
              std::string::npos)
        << missing;
    EXPECT_EQ(missing_at(12.3, 12.4).find("the recorded speed is"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
