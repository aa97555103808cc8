#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "real_support.h"

// What screening finds in real recordings.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class UrbanCar : public testing::Test {
  protected:
    void SetUp() override {
        const auto data = recordings();
        if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
        const fs::path folder = *data / "ppk_urban_car";
        certified_tables = certified(folder / "rover.pos", base_station);
        reference = reference_positions(folder / "reference.csv", urban_frame());
    }

    /// Of the reference, where it has the row's time to the millisecond; its positions are given
    /// on the fifths of a second.
    std::optional<Eigen::Vector2d> reference_at(const ScreenedEpoch& row) const {
        const GpsTime at =
            tables().screened.facts.first_epoch.value().plus_nanoseconds(row.time.nanoseconds);
        const auto found =
            reference.find(std::llround(static_cast<double>(at.nanoseconds_of_week()) * 1e-6));
        return found == reference.end() ? std::nullopt : std::optional(found->second);
    }

    const Tables& tables() const { return certified_tables.value(); }

    std::optional<Tables> certified_tables;
    std::map<std::int64_t, Eigen::Vector2d> reference;
};

TEST_F(UrbanCar, FixedEpochsThatAreWrongAreMarkedOrHarmless) {
    // "Fixed", yet more than 0.3 m from the reference, horizontally. What is left of them is an
    // offset too constant to show, in stretches that hold no window; gaps of up to two seconds join
    // some that were too short to be used at all.
    std::int64_t wrong = 0;
    std::int64_t used = 0;
    std::set<std::int64_t> arcs;
    for (const ScreenedEpoch& row : tables().screened.rows) {
        if (row.fix != FixType::fixed || !row.east_m) continue;
        const auto truth = reference_at(row);
        if (!truth || (Eigen::Vector2d(*row.east_m, *row.north_m) - *truth).norm() <= 0.3) continue;
        ++wrong;
        if (!row.usable) continue;
        ++used;
        arcs.insert(*row.arc);
    }
    fmt::print("{} fixed epochs wrong by more than 0.3 m, {} of them not marked\n", wrong, used);
    EXPECT_GT(wrong, 100);
    EXPECT_LE(used, 45);
    for (const Arc<2>& arc : arcs_of<2>(tables().screened))
        if (arcs.contains(arc.number)) {
            EXPECT_TRUE(certifiable(tables().screened, arc).empty()) << "arc " << arc.number;
        }
}

TEST_F(UrbanCar, NoCertifiableWindowIsFarFromTheReference) {
    double largest = 0.0;
    std::int64_t windows = 0;
    for (const Arc<2>& arc : arcs_of<2>(tables().screened))
        for (const EpochPair& window : certifiable(tables().screened, arc)) {
            const TrajectoryEpoch& first = tables().trajectory.rows[arc.rows[window.first]];
            const TrajectoryEpoch& last = tables().trajectory.rows[arc.rows[window.last]];
            const auto from = reference_at(tables().screened.rows[arc.rows[window.first]]);
            const auto to = reference_at(tables().screened.rows[arc.rows[window.last]]);
            if (!from || !to) continue;
            const double speed =
                std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
            ++windows;
            largest = std::max(largest, std::abs(speed - (*to - *from).norm()) / 3.0 * 3.6);
        }
    fmt::print("{} certifiable windows, none more than {:.3f} km/h from the reference\n", windows,
               largest);
    EXPECT_GT(windows, 1000);
    EXPECT_LE(largest, 0.2);
}

TEST(RealScreening, EpochsOfTokyoThatContradictTheRecordedVelocityAreMarked) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Tables tables = certified(*data / "ppk_tokyo_ecef" / "rover.pos");
    const auto& rows = tables.screened.rows;
    std::int64_t contradicting = 0;
    for (std::size_t k = 1; k < rows.size(); ++k) {
        const ScreenedEpoch& before = rows[k - 1];
        const ScreenedEpoch& row = rows[k];
        if (!before.recorded_velocity_east_m_s || !row.recorded_velocity_east_m_s) continue;
        const double position_m_s =
            std::hypot(*row.east_m - *before.east_m, *row.north_m - *before.north_m) /
            (row.time.seconds() - before.time.seconds());
        const double recorded_m_s =
            0.5 *
            (std::hypot(*before.recorded_velocity_east_m_s, *before.recorded_velocity_north_m_s) +
             std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s));
        if (std::abs(position_m_s - recorded_m_s) <= 3.0) continue;
        ++contradicting;
        EXPECT_FALSE(row.usable) << "epoch " << row.epoch;
    }
    EXPECT_EQ(contradicting, 8);
}

TEST(RealScreening, TheDelayOfTheRecordedVelocityIsFound) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Tables tables = certified(*data / "rtk_imu_drive" / "rover.pos");
    ASSERT_TRUE(tables.screened.basis.velocity);
    const VelocityComparison& velocity = *tables.screened.basis.velocity;
    fmt::print("delay {:.4f} s, {} velocities compared\n", velocity.delay_s.value_or(-1.0),
               velocity.compared);
    EXPECT_NEAR(velocity.delay_s.value_or(0.0), 0.12, 0.01);
    EXPECT_EQ(velocity.rejected, 0);
    EXPECT_GT(velocity.compared, 2000);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
