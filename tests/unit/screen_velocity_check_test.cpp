#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "core/statistics.h"
#include "motion/chain.h"
#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"
#include "stages/screen/velocity_check.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A drive that accelerates: on each axis a steady speed, and sines of speed.
struct Drive {
    double steady_m_s = 15.0;
    double sway_m_s = 6.0;

    Eigen::Vector2d velocity(double t) const {
        return {steady_m_s + sway_m_s * std::sin(0.5 * t), sway_m_s * std::sin(0.4 * t + 1.0)};
    }
    Eigen::Vector2d position(double t) const {
        return {steady_m_s * t - sway_m_s / 0.5 * std::cos(0.5 * t),
                -sway_m_s / 0.4 * std::cos(0.4 * t + 1.0)};
    }
};

struct Recording {
    std::vector<ScreenedEpoch> rows;
    Motion motion;
    double interval_s = 0.0;

    VelocityCheckOptions options(double delay_max_s = 1.0) const {
        return {.delay_max_s = delay_max_s, .nominal_interval_s = interval_s};
    }
};

constexpr double position_sigma_m = 0.01;
constexpr double velocity_sigma_m_s = 0.03;

Recording record(const Drive& drive, std::size_t epochs, double interval_s, double delay_s,
                 std::uint64_t seed) {
    RandomGenerator random(seed);
    Recording recording;
    recording.interval_s = interval_s;
    for (std::size_t k = 0; k < epochs; ++k) {
        ScreenedEpoch& row = recording.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = std::llround(static_cast<double>(k) * interval_s * 1e9);
        const Eigen::Vector2d position = drive.position(row.time.seconds());
        const Eigen::Vector2d velocity = drive.velocity(row.time.seconds() - delay_s);
        row.east_m = position.x() + position_sigma_m * random.normal();
        row.north_m = position.y() + position_sigma_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = position_sigma_m;
        row.recorded_velocity_east_m_s = velocity.x() + velocity_sigma_m_s * random.normal();
        row.recorded_velocity_north_m_s = velocity.y() + velocity_sigma_m_s * random.normal();
        row.usable = true;
        row.arc = 1;
    }
    return recording;
}

/// Smooths every arc from its usable rows.
void smooth_positions(Recording& recording) {
    const EstimationModel model{.motion = {.jerk_density = 2.0}};
    std::vector<ScreenedEpoch>& rows = recording.rows;
    recording.motion.assign(rows.size(), std::nullopt);
    for (std::size_t first = 0, end = 0; first < rows.size(); first = end) {
        std::vector<ArcEpoch<2>> arc;
        for (end = first; end < rows.size() && rows[end].arc == rows[first].arc; ++end) {
            ArcEpoch<2>& epoch = arc.emplace_back();
            epoch.time_s = rows[end].time.seconds();
            if (rows[end].usable)
                epoch.measurement = {.position = measured_position<2>(rows[end]),
                                     .covariance = stated_covariance<2>(rows[end])};
        }
        if (!rows[first].arc) continue;
        const Chain<2> smoothed = Chain<2>(arc, model);
        for (std::size_t k = first; k < end; ++k) {
            const StateEstimate<2>& state = smoothed.state(k - first);
            EpochMotion& motion = recording.motion[k].emplace();
            motion.velocity = state.mean.segment<2>(2);
            motion.acceleration = state.mean.segment<2>(4);
            motion.velocity_covariance = state.covariance.block<2, 2>(2, 2);
            motion.acceleration_covariance = state.covariance.block<2, 2>(4, 4);
        }
    }
}

Recording smoothed(const Drive& drive, std::size_t epochs, double interval_s, double delay_s,
                   std::uint64_t seed = 1) {
    Recording recording = record(drive, epochs, interval_s, delay_s, seed);
    smooth_positions(recording);
    return recording;
}

std::vector<std::int64_t> marked(const Recording& recording) {
    std::vector<std::int64_t> epochs;
    for (const ScreenedEpoch& row : recording.rows)
        if (row.reason == Reason::velocity) epochs.push_back(row.epoch);
    return epochs;
}

TEST(VelocityCheck, FindsTheDelay) {
    for (const double delay_s : {0.12, 0.04, -0.30, 0.0})
        for (const double interval_s : {0.1, 0.25})
            for (const std::uint64_t seed : {1U, 2U, 3U}) {
                Recording recording = smoothed({}, 1200, interval_s, delay_s, seed);
                const auto found =
                    check_velocities(recording.rows, recording.motion, recording.options())
                        .comparison;
                ASSERT_TRUE(found && found->delay_s && found->sigma_delay_s);
                EXPECT_NEAR(*found->delay_s, delay_s, 3.0 * *found->sigma_delay_s);
                EXPECT_NEAR(*found->delay_s, delay_s, 0.01);
                EXPECT_LT(*found->sigma_delay_s, 0.003);
                EXPECT_TRUE(marked(recording).empty());
            }
}

// The stated uncertainty is the spread of the estimates over many recordings, also where the
// recorded velocities' errors last (0.5 s): taken as independent, it would be half of that.
TEST(VelocityCheck, TheDelaysUncertaintyIsTheSpread) {
    for (const double kept : {0.0, std::exp(-0.1 / 0.5)}) {
        std::vector<double> delays, sigmas;
        for (std::uint64_t seed = 1; seed <= 80; ++seed) {
            Recording recording = record({}, 600, 0.1, 0.12, seed);
            RandomGenerator random(1000 + seed);
            Eigen::Vector2d error = Eigen::Vector2d::Zero();
            for (ScreenedEpoch& row : recording.rows) {
                error = kept * error + 0.06 * Eigen::Vector2d(random.normal(), random.normal());
                *row.recorded_velocity_east_m_s += error.x();
                *row.recorded_velocity_north_m_s += error.y();
            }
            smooth_positions(recording);
            const auto found =
                check_velocities(recording.rows, recording.motion, recording.options()).comparison;
            delays.push_back(found->delay_s.value());
            sigmas.push_back(found->sigma_delay_s.value());
        }
        const double ratio = standard_deviation(delays) / median(sigmas);
        EXPECT_GT(ratio, 0.75) << kept;
        EXPECT_LT(ratio, 1.35) << kept;
    }
}

// A tenth of the recorded velocities and a twentieth of the positions wrong decide nothing.
TEST(VelocityCheck, OutliersDoNotDecideTheDelay) {
    Recording recording = record({}, 1200, 0.1, 0.12, 5);
    RandomGenerator random(6);
    for (std::size_t k = 0; k < recording.rows.size(); ++k) {
        if (k % 10 == 3) *recording.rows[k].recorded_velocity_east_m_s += 5.0 * random.normal();
        if (k % 20 == 7) *recording.rows[k].north_m += 0.2 * random.normal();
    }
    smooth_positions(recording);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options()).comparison;
    EXPECT_NEAR(found->delay_s.value(), 0.12, 0.01);
}

TEST(VelocityCheck, AnUnheededDelayLooksLikeErrors) {
    Recording recording = smoothed({}, 1200, 0.1, 0.12);
    auto rows = recording.rows;
    const auto with = check_velocities(rows, recording.motion, recording.options()).comparison;
    const auto without =
        check_velocities(rows, recording.motion, recording.options(0.0)).comparison;
    EXPECT_FALSE(without->delay_s);
    // Between the recorded velocity's noise and both, the smoothed one's at most as stated.
    const double smoothed_sigma_m_s = std::sqrt(recording.motion[600]->velocity_covariance(0, 0));
    EXPECT_GT(with->scale_m_s, velocity_sigma_m_s);
    EXPECT_LT(with->scale_m_s, std::hypot(velocity_sigma_m_s, smoothed_sigma_m_s));
    EXPECT_GT(without->scale_m_s, 3.0 * with->scale_m_s);
}

TEST(VelocityCheck, SteadyMotionDoesNotTellTheDelay) {
    Recording recording = smoothed({.steady_m_s = 20.0, .sway_m_s = 0.0}, 1200, 0.1, 0.12);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options()).comparison;
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->delay_s);
    EXPECT_FALSE(found->sigma_delay_s);
    EXPECT_EQ(found->compared, 1200);
    EXPECT_TRUE(marked(recording).empty());
}

// What lies beyond the range is not reported as its limit.
TEST(VelocityCheck, ADelayBeyondTheRangeIsNotTold) {
    Recording recording = smoothed({}, 1200, 0.1, 0.5);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options(0.3)).comparison;
    EXPECT_FALSE(found->delay_s);
    EXPECT_TRUE(marked(recording).empty());
}

TEST(VelocityCheck, CleanDataStayAsTheyAre) {
    Recording recording = smoothed({}, 10'000, 0.1, 0.12, 9);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options()).comparison;
    EXPECT_GT(found->compared, 9990);
    EXPECT_EQ(found->rejected, 0);
    for (const ScreenedEpoch& row : recording.rows) {
        ASSERT_TRUE(row.usable) << row.epoch;
        ASSERT_FALSE(row.statistic || row.hypothesis);
    }
}

// Seen in real recordings: single velocities off by eleven standard deviations while the positions
// are good, and a long time parked with a fraction of the noise, here a fortieth.
TEST(VelocityCheck, HeavyTailsAndParkedStretchesMarkNothing) {
    Recording recording = record({}, 1500, 0.1, 0.12, 10);
    RandomGenerator random(11);
    for (std::size_t k = 0; k < recording.rows.size(); ++k) {
        ScreenedEpoch& row = recording.rows[k];
        if (k < 900) {
            row.east_m = 0.002 * random.normal();
            row.north_m = 0.002 * random.normal();
            row.recorded_velocity_east_m_s = 0.005 * random.normal();
            row.recorded_velocity_north_m_s = 0.005 * random.normal();
            row.arc = 1;
        } else {
            *row.recorded_velocity_east_m_s += 0.2 * random.normal();
            *row.recorded_velocity_north_m_s += 0.2 * random.normal();
            if (k % 50 == 20) *row.recorded_velocity_east_m_s += 2.2;
            row.arc = 2;
        }
    }
    smooth_positions(recording);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options()).comparison;
    EXPECT_LT(found->scale_m_s, velocity_sigma_m_s);
    EXPECT_NEAR(found->delay_s.value(), 0.12, 3.0 * found->sigma_delay_s.value());
    EXPECT_TRUE(marked(recording).empty());
}

TEST(VelocityCheck, AWrongPositionIsMarkedAndOnlyIt) {
    for (const double interval_s : {0.1, 0.25, 1.0}) {
        Recording recording = record({}, 600, interval_s, 0.12, 3);
        *recording.rows[300].east_m += 3.0 * interval_s;  // 3 m/s wrong on both sides
        smooth_positions(recording);
        const auto found =
            check_velocities(recording.rows, recording.motion, recording.options()).comparison;
        EXPECT_EQ(marked(recording), std::vector<std::int64_t>{301}) << interval_s;
        EXPECT_EQ(found->rejected, 1);
        const ScreenedEpoch& row = recording.rows[300];
        EXPECT_FALSE(row.usable);
        EXPECT_EQ(row.hypothesis, Hypothesis::velocity);
        EXPECT_EQ(row.tested_axes, TestedAxes::horizontal);
        EXPECT_NEAR(row.threshold.value(), 2.0 * std::log(1e9), 1e-6);  // chi-squared, 2 degrees
        EXPECT_GT(row.statistic.value(), *row.threshold);
        // Smoothed again without it, nothing more is found.
        smooth_positions(recording);
        check_velocities(recording.rows, recording.motion, recording.options());
        EXPECT_EQ(marked(recording), std::vector<std::int64_t>{301}) << interval_s;
    }
}

// Neighbours that err alike raise the spread about one another, but not without limit.
TEST(VelocityCheck, WrongPositionsNearOneAnotherAreMarked) {
    Recording recording = record({}, 600, 0.1, 0.12, 3);
    for (const std::size_t k : {300U, 304U, 308U})
        *recording.rows[k].east_m += 0.6;
    smooth_positions(recording);
    check_velocities(recording.rows, recording.motion, recording.options());
    EXPECT_EQ(marked(recording), (std::vector<std::int64_t>{301, 305, 309}));
}

// 0.6 m/s on both sides is ten standard deviations of a displacement over 0.25 s, but less than
// what a delay of 0.3 s makes while the craft accelerates.
TEST(VelocityCheck, DisplacementsHeedTheDelay) {
    Recording recording = record({}, 600, 0.25, 0.3, 3);
    *recording.rows[300].east_m += 0.15;
    smooth_positions(recording);
    auto rows = recording.rows;
    EXPECT_EQ(check_velocities(rows, recording.motion, recording.options(0.0)).comparison->rejected,
              0);
    check_velocities(recording.rows, recording.motion, recording.options());
    EXPECT_EQ(marked(recording), std::vector<std::int64_t>{301});
}

// Positions that drift at 1 m/s for a while: no displacement says so, the smoothed motion does,
// also where the drift is as long as the window that a local scale comes from.
TEST(VelocityCheck, ADriftIsMarked) {
    struct Case {
        double interval_s;
        std::size_t epochs;
        double least_share;  ///< marked of the drift; its ends are smoothed over
    };
    for (const Case& c : {Case{0.1, 40, 0.6}, Case{0.25, 12, 0.7}, Case{0.25, 40, 0.9}}) {
        Recording recording = record({}, 1200, c.interval_s, 0.12, 4);
        const std::size_t first = 600, last = first + c.epochs;
        for (std::size_t k = first; k < recording.rows.size(); ++k)
            *recording.rows[k].north_m +=
                c.interval_s * static_cast<double>(std::min(k, last) - first);
        smooth_positions(recording);
        check_velocities(recording.rows, recording.motion, recording.options());
        std::size_t inside = 0;
        for (std::size_t k = 0; k < recording.rows.size(); ++k) {
            if (recording.rows[k].usable) continue;
            EXPECT_GE(k, first - 10);
            EXPECT_LE(k, last + 10);
            inside += k > first && k < last;
        }
        EXPECT_GE(static_cast<double>(inside), c.least_share * static_cast<double>(c.epochs))
            << c.interval_s << " s, " << c.epochs;
    }
}

// Too slow for the smoothed motion to tell: the displacement over three seconds does.
TEST(VelocityCheck, ASlowDriftIsMarkedByItsDisplacement) {
    for (const double rate_m_s : {0.1, 0.3}) {
        Recording recording = record({.steady_m_s = 20.0, .sway_m_s = 0.0}, 1200, 0.1, 0.0, 4);
        const std::size_t first = 600, last = first + 30;
        for (std::size_t k = first; k < recording.rows.size(); ++k)
            *recording.rows[k].north_m +=
                0.1 * rate_m_s * static_cast<double>(std::min(k, last) - first);
        smooth_positions(recording);
        const VelocityFindings found =
            check_velocities(recording.rows, recording.motion, recording.options());
        ASSERT_EQ(found.errors.size(), 1U);
        EXPECT_FALSE(found.errors.front().spreads.empty());
        const std::vector<std::int64_t> epochs = marked(recording);
        ASSERT_FALSE(epochs.empty()) << rate_m_s;
        EXPECT_GE(epochs.front(), static_cast<std::int64_t>(first) - 10);
        EXPECT_LE(epochs.back(), static_cast<std::int64_t>(last) + 12);
        EXPECT_TRUE(std::ranges::any_of(recording.rows, [](const ScreenedEpoch& row) {
            return row.break_before == ArcBreak::ramp;
        }));
    }
}

TEST(VelocityCheck, VelocitiesComputedFromThePositionsWitnessNothing) {
    Recording recording = record({}, 1200, 0.1, 0.0, 4);
    for (std::size_t k = 1; k < recording.rows.size(); ++k) {
        ScreenedEpoch& row = recording.rows[k];
        row.recorded_velocity_east_m_s = (*row.east_m - *recording.rows[k - 1].east_m) / 0.1;
        row.recorded_velocity_north_m_s = (*row.north_m - *recording.rows[k - 1].north_m) / 0.1;
    }
    smooth_positions(recording);
    const VelocityFindings found =
        check_velocities(recording.rows, recording.motion, recording.options());
    EXPECT_EQ(found.comparison.value().origin, VelocityOrigin::positions);
    EXPECT_TRUE(found.errors.empty());
    EXPECT_EQ(found.comparison->compared, 0);
}

// A speed without a course counts along the direction of travel.
TEST(VelocityCheck, ASpeedAloneIsAWitness) {
    Recording recording = record({.steady_m_s = 20.0}, 1200, 0.1, 0.12, 4);
    for (ScreenedEpoch& row : recording.rows) {
        row.recorded_speed_m_s =
            std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s);
        row.recorded_velocity_east_m_s.reset();
        row.recorded_velocity_north_m_s.reset();
    }
    for (std::size_t k = 600; k < recording.rows.size(); ++k)
        *recording.rows[k].east_m += 0.1 * static_cast<double>(std::min<std::size_t>(k, 640) - 600);
    smooth_positions(recording);
    const VelocityFindings found =
        check_velocities(recording.rows, recording.motion, recording.options());
    ASSERT_EQ(found.errors.size(), 1U);
    EXPECT_TRUE(found.errors.front().speed_only);
    EXPECT_FALSE(marked(recording).empty());
}

TEST(VelocityCheck, OnlyUsableRowsAreMarked) {
    Recording recording = record({}, 600, 0.1, 0.12, 3);
    *recording.rows[300].east_m += 3.0;
    recording.rows[300].usable = false;
    recording.rows[300].reason = Reason::outlier;
    smooth_positions(recording);
    const auto found =
        check_velocities(recording.rows, recording.motion, recording.options()).comparison;
    EXPECT_EQ(found->rejected, 0);
    EXPECT_EQ(recording.rows[300].reason, Reason::outlier);
}

// Two arcs between which positions and velocities jump: joining them would contradict.
TEST(VelocityCheck, ArcsAreNeverJoined) {
    for (const double delay_s : {0.12, -0.12}) {
        Recording recording = record({}, 800, 0.1, delay_s, 7);
        for (std::size_t k = 400; k < 800; ++k) {
            ScreenedEpoch& row = recording.rows[k];
            row.arc = 2;
            *row.east_m += 50.0 + 10.0 * row.time.seconds();
            *row.recorded_velocity_east_m_s += 10.0;
        }
        smooth_positions(recording);
        const auto found =
            check_velocities(recording.rows, recording.motion, recording.options()).comparison;
        EXPECT_TRUE(marked(recording).empty());
        EXPECT_NEAR(found->delay_s.value(), delay_s, 0.01);
        // Two epochs at one end of each arc look out of it.
        EXPECT_EQ(found->compared, 800 - 2 * 2);
    }
}

TEST(VelocityCheck, ReceiversThatDoNotFillTheField) {
    Recording recording = smoothed({}, 600, 0.1, 0.12);
    for (const double constant : {0.0, 7.0}) {
        for (ScreenedEpoch& row : recording.rows)
            row.recorded_velocity_east_m_s = row.recorded_velocity_north_m_s = constant;
        const auto found =
            check_velocities(recording.rows, recording.motion, recording.options()).comparison;
        ASSERT_TRUE(found);
        EXPECT_EQ(found->compared, 0);
        EXPECT_FALSE(found->delay_s);
        EXPECT_TRUE(marked(recording).empty());
    }
}

TEST(VelocityCheck, TooFewToCompare) {
    Recording recording = smoothed({}, 100, 0.1, 0.12);
    auto few = recording.rows;
    for (std::size_t k = 29; k < few.size(); ++k)
        few[k].recorded_velocity_north_m_s.reset();
    EXPECT_FALSE(check_velocities(few, recording.motion, recording.options()).comparison);

    auto unusable = recording.rows;
    for (std::size_t k = 29; k < unusable.size(); ++k)
        unusable[k].usable = false;
    const auto found = check_velocities(unusable, recording.motion, recording.options()).comparison;
    ASSERT_TRUE(found);
    EXPECT_EQ(found->compared, 0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
