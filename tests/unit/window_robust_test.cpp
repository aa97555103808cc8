#include <gtest/gtest.h>

#include <algorithm>

#include "stages/window/course_windows.h"
#include "stages/window/sample_series.h"
#include "stages/window/trajectory_part.h"
#include "window_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Ten seconds at top speed, and the robust solution beside the screened solution: the same, but
/// that the window's end is so much further along the track.
struct WitnessRecords {
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 40.0});
    EstimationModel model;
    TrajectoryTable trajectory;
    ArcPart<2> part;
    Chain<2> smoothed;

    explicit WitnessRecords(double further_m) {
        model.motion.jerk_density = 0.6;
        trajectory = test::smoothed_with(screened, test::summary_of(model));
        part.arc = arcs_of<2>(screened).front();
        part.window = {30, 60};
        smoothed = Chain<2>(part.arc.epochs, model);
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
        return smoothed_speed(smoothed, {30, 60}, 3.0, {}).standard_uncertainty_m_s;
    }
};

TEST(RobustSpeed, AgreesWithinTwiceTheUncertaintyAndWhatOtherModelsChange) {
    const double u = WitnessRecords(0.0).uncertainty();
    ASSERT_GT(u, 1e-4);
    for (const double model_m_s : {0.0, 0.02}) {
        const double limit_m_s = 2.0 * (u + model_m_s);
        const RobustSpeed inside = WitnessRecords(2.99 * limit_m_s).with(model_m_s);
        EXPECT_NEAR(inside.limit_m_s, limit_m_s, 1e-9);
        EXPECT_NEAR(inside.difference_m_s, 2.99 / 3.0 * limit_m_s, 1e-6);
        EXPECT_TRUE(inside.agrees);
        EXPECT_FALSE(WitnessRecords(3.01 * limit_m_s).with(model_m_s).agrees);
        EXPECT_FALSE(WitnessRecords(-3.01 * limit_m_s).with(model_m_s).agrees);
    }
}

TEST(RobustSpeed, OfATrajectoryWithoutItThereIsNone) {
    WitnessRecords beside(0.0);
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
    const IndicatedSeries indicated = indicated_series(screened, test::rule_over(3.0), 1.5);
    EXPECT_EQ(indicated.rows.front().size(), screened.rows.size() - 2);
    EXPECT_EQ(indicated.rows.back(), std::vector<std::size_t>{50});
    EXPECT_NE(std::ranges::find(indicated.rows.front(), 60U), indicated.rows.front().end());
}

TEST(IndicatedSeries, TakesWhatTheReceiverCallsNoFixForItself) {
    // A position that a receiver holds or guesses without satellites shows no speed beside others,
    // whatever screening thinks of the rest; those that go on from one to the next show theirs.
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
    const IndicatedSeries indicated = indicated_series(screened, test::rule_over(3.0), 1.5);
    ASSERT_EQ(indicated.series.size(), 2U);
    EXPECT_EQ(indicated.rows.front().size(), screened.rows.size() - 6);
    EXPECT_EQ(indicated.rows.back(), (std::vector<std::size_t>{40, 41, 42, 43, 44}));
    EXPECT_EQ(indicated.series.front().positions.size(), indicated.rows.front().size());
    for (const std::size_t row : indicated.rows.front()) {
        EXPECT_NE(screened.rows[row].fix, FixType::none);
        EXPECT_NE(row, 60U);
    }
}

TEST(IndicatedSeries, OutliersOneAfterTheOtherShowWhatTheyShow) {
    ScreenedTable screened = test::recorded({.from_s = 30.0, .to_s = 40.0});
    for (std::size_t k = 40; k < 80; ++k)
        screened.rows[k].reason = Reason::outlier;
    EXPECT_EQ(indicated_series(screened, test::rule_over(3.0), 1.5).rows.front().size(),
              screened.rows.size());
}

// Whatever rows are left out for: the faster window that they hold is shown, and said to be
// refused.
TEST(IndicatedWindow, IsShownWhateverItsRowsWereLeftOutFor) {
    const auto hide = [](ScreenedEpoch& row, Reason reason, std::int64_t k) {
        row.usable = false;
        row.arc.reset();
        row.reason = reason;
        switch (reason) {
            case Reason::no_position:
                row.east_m.reset();
                row.recorded_speed_m_s = 60.0;
                break;
            case Reason::far_position:
                *row.east_m += 300'000.0;
                break;
            case Reason::no_fix:
                row.fix = FixType::none;
                break;
            case Reason::duplicate_time:
            case Reason::backward_time:
                row.time.nanoseconds -=
                    k * (reason == Reason::backward_time ? 200 : 100) * 1'000'000;
                break;
            case Reason::accuracy_missing:
                row.sigma_east_m.reset();
                row.sigma_north_m.reset();
                break;
            case Reason::accuracy_absurd:
                row.sigma_east_m = row.sigma_north_m = 1e4;
                break;
            default:
                break;
        }
    };
    std::size_t reasons = 0;
    for (int word = 1; !to_text(static_cast<Reason>(word)).empty(); ++word) {
        const auto reason = static_cast<Reason>(word);
        // What repeats another row hides nothing: the other stands.
        if (reason == Reason::repeated) continue;
        SCOPED_TRACE(to_text(reason));
        ++reasons;
        ScreenedTable screened = test::recorded({.from_s = 10.0, .to_s = 40.0});
        for (std::size_t k = 100; k < screened.rows.size(); ++k)
            hide(screened.rows[k], reason, static_cast<std::int64_t>(k) - 100);
        std::ranges::stable_sort(screened.rows, {}, &ScreenedEpoch::time);
        const auto shown =
            fastest_indicated(screened, test::rule_over(3.0), test::few_draws(), std::nullopt);
        ASSERT_TRUE(shown.has_value());
        EXPECT_GT(shown->speed_m_s, 59.0);
        EXPECT_LT(shown->speed_m_s, 61.0);
        EXPECT_FALSE(shown->refusals.empty());
    }
    EXPECT_EQ(reasons, 23U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
