#include <gtest/gtest.h>

#include <algorithm>

#include "stages/window/robust.h"
#include "stages/window/sample_series.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Ten seconds at top speed, and the robust batch beside the screened solution: the same, but that
/// the window's end is so much further along the track.
struct Beside {
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 40.0});
    EstimationModel model;
    TrajectoryTable trajectory;
    ArcPart<2> part;
    SmoothedArc<2> smoothed;

    explicit Beside(double further_m) {
        model.motion.jerk_density = 0.6;
        trajectory = test::smoothed_with(screened, test::summary_of(model));
        part.arc = arcs_of<2>(screened).front();
        part.window = {30, 60};
        smoothed = smooth<2>(part.arc.epochs, model);
        for (TrajectoryEpoch& row : trajectory.rows) {
            row.robust_east_m = row.east_m;
            row.robust_north_m = row.north_m;
            row.robust_weight = 1.0;
        }
        *trajectory.rows[60].robust_east_m += further_m / std::numbers::sqrt2;
        *trajectory.rows[60].robust_north_m += further_m / std::numbers::sqrt2;
    }
    RobustSpeed with(double model_m_s) const {
        return robust_speed(trajectory, part, smoothed, model_m_s).value();
    }
    double uncertainty() const {
        return displacement_speed(smoothed, 30, 60, 3.0).standard_uncertainty_m_s;
    }
};

TEST(RobustSpeed, AgreesWithinTwiceTheUncertaintyAndWhatOtherModelsChange) {
    const double u = Beside(0.0).uncertainty();
    ASSERT_GT(u, 1e-4);
    for (const double model_m_s : {0.0, 0.02}) {
        const double limit_m_s = 2.0 * (u + model_m_s);
        const RobustSpeed inside = Beside(2.99 * limit_m_s).with(model_m_s);
        EXPECT_NEAR(inside.limit_m_s, limit_m_s, 1e-9);
        EXPECT_NEAR(inside.difference_m_s, 2.99 / 3.0 * limit_m_s, 1e-6);
        EXPECT_TRUE(inside.agrees);
        EXPECT_FALSE(Beside(3.01 * limit_m_s).with(model_m_s).agrees);
        EXPECT_FALSE(Beside(-3.01 * limit_m_s).with(model_m_s).agrees);
    }
}

TEST(RobustSpeed, OfATrajectoryWithoutItThereIsNone) {
    Beside beside(0.0);
    beside.trajectory.rows[60].robust_east_m.reset();
    EXPECT_FALSE(robust_speed(beside.trajectory, beside.part, beside.smoothed, 0.0));
}

TEST(IndicatedSeries, LeavesOutSinglePositionsThatTheirNeighboursContradict) {
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 40.0});
    screened.rows[40].reason = Reason::outlier;
    screened.rows[50].reason = Reason::far_position;
    screened.rows[60].reason = Reason::burst;
    for (const std::size_t row : {40U, 50U, 60U})
        screened.rows[row].usable = false;
    const IndicatedSeries indicated = indicated_series(screened, test::rule_over(3.0));
    EXPECT_EQ(indicated.rows.front().size(), screened.rows.size() - 2);
    EXPECT_NE(std::ranges::find(indicated.rows.front(), 60U), indicated.rows.front().end());
}

TEST(IndicatedSeries, LeavesOutWhatTheReceiverCallsNoFix) {
    // A position that a receiver holds or guesses without satellites shows no speed, whatever
    // screening thinks of the rest.
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 40.0});
    for (std::size_t k = 40; k < 45; ++k) {
        screened.rows[k].fix = FixType::none;
        *screened.rows[k].east_m += 500.0;
    }
    for (std::size_t k = 50; k < 55; ++k) {
        screened.rows[k].fix = FixType::unknown;
        screened.rows[k].usable = false;
    }
    screened.rows[60].east_m.reset();
    const IndicatedSeries indicated = indicated_series(screened, test::rule_over(3.0));
    ASSERT_EQ(indicated.series.size(), 1U);
    EXPECT_EQ(indicated.rows.front().size(), screened.rows.size() - 6);
    EXPECT_EQ(indicated.series.front().positions.size(), indicated.rows.front().size());
    for (const std::size_t row : indicated.rows.front()) {
        EXPECT_NE(screened.rows[row].fix, FixType::none);
        EXPECT_NE(row, 60U);
    }
    for (ScreenedEpoch& row : screened.rows)
        row.fix = FixType::none;
    EXPECT_TRUE(indicated_series(screened, test::rule_over(3.0)).series.empty());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
