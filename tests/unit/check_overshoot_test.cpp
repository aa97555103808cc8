#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "stages/check/course.h"

// Signs of a filter in the motion: steps of the acceleration, filtered and not, and gusts.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double interval_s = 0.1;
constexpr double pi = std::numbers::pi;

using Acceleration = std::function<double(double time_s)>;

/// A trajectory towards the north-east, with a given initial speed and along-track acceleration.
std::vector<TrajectoryEpoch> moving(double length_s, double speed_m_s, const Acceleration& along) {
    std::vector<TrajectoryEpoch> rows;
    const auto count = static_cast<std::int64_t>(std::llround(length_s / interval_s));
    for (std::int64_t k = 0; k <= count; ++k) {
        const double time_s = interval_s * static_cast<double>(k);
        TrajectoryEpoch& row = rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.arc = 1;
        row.usable = true;
        row.speed_m_s = speed_m_s;
        row.velocity_east_m_s = row.velocity_north_m_s = speed_m_s * std::sqrt(0.5);
        row.acceleration_east_m_s2 = row.acceleration_north_m_s2 = along(time_s) * std::sqrt(0.5);
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 0.03;
        speed_m_s += interval_s * along(time_s + 0.5 * interval_s);
    }
    return rows;
}

struct Step {
    double time_s;
    double to_m_s2;
};

/// Two starts and braking, with plateaus of 10 to 15 s.
const std::vector<Step> run{{10.0, 3.0}, {22.0, 0.0},  {37.0, 2.5},
                            {50.0, 0.0}, {65.0, -4.0}, {75.0, 0.0}};

Acceleration in_steps(const std::vector<Step>& steps) {
    return [steps](double time_s) {
        double value = 0.0;
        for (const Step& step : steps)
            if (time_s >= step.time_s) value = step.to_m_s2;
        return value;
    };
}

/// What a filter of second order makes of steps: the sum of its step responses, in closed form.
Acceleration filtered(const std::vector<Step>& steps, double frequency_hz, double damping) {
    return [=](double time_s) {
        const double rate = 2.0 * pi * frequency_hz;
        const double rest = std::sqrt(1.0 - damping * damping);
        double value = 0.0;
        double before = 0.0;
        for (const Step& step : steps) {
            const double t = time_s - step.time_s;
            if (t > 0.0)
                value += (step.to_m_s2 - before) *
                         (1.0 - std::exp(-damping * rate * t) *
                                    (std::cos(rest * rate * t) +
                                     damping / rest * std::sin(rest * rate * t)));
            before = step.to_m_s2;
        }
        return value;
    };
}

TEST(Overshoot, OfAFilterOfSecondOrderIsFoundWithItsPeriodAndItsDecay) {
    for (const auto& [frequency_hz, damping] : {std::pair{0.3, 0.3}, {0.5, 0.3}, {0.5, 0.2}}) {
        SCOPED_TRACE(testing::Message() << frequency_hz << " Hz, damping " << damping);
        const Overshoot overshoot =
            find_overshoot(moving(90.0, 5.0, filtered(run, frequency_hz, damping)));
        EXPECT_TRUE(overshoot.found());
        EXPECT_EQ(overshoot.changes, 6);
        EXPECT_EQ(overshoot.swings, 6);
        const double rest = std::sqrt(1.0 - damping * damping);
        EXPECT_NEAR(overshoot.period_s, 1.0 / (frequency_hz * rest), interval_s);
        EXPECT_NEAR(overshoot.part, std::exp(-pi * damping / rest), 0.02);
    }
}

TEST(Overshoot, OfTheSameStepsWithoutAFilterIsNone) {
    const Overshoot overshoot = find_overshoot(moving(90.0, 5.0, in_steps(run)));
    EXPECT_GE(overshoot.changes, 2);
    EXPECT_EQ(overshoot.swings, 0);
    EXPECT_FALSE(overshoot.found());
    // Nor with a filter that does not swing.
    EXPECT_FALSE(find_overshoot(moving(90.0, 5.0, filtered(run, 0.3, 0.8))).found());
}

TEST(Overshoot, IsNotFoundInGusts) {
    RandomGenerator random(31);
    std::int64_t changes = 0;
    for (int seed = 0; seed < 300; ++seed) {
        struct Gust {
            double amplitude_m_s2, period_s, phase;
        };
        std::vector<Gust> gusts;
        for (int i = 0; i < 6; ++i)
            gusts.push_back({0.3 + 0.7 * random.uniform(), 1.5 + 6.0 * random.uniform(),
                             2.0 * pi * random.uniform()});
        const Overshoot overshoot = find_overshoot(moving(90.0, 25.0, [&](double time_s) {
            double value = in_steps(run)(time_s);
            for (const Gust& gust : gusts)
                value +=
                    gust.amplitude_m_s2 * std::sin(2.0 * pi * time_s / gust.period_s + gust.phase);
            return value;
        }));
        changes += overshoot.changes;
        EXPECT_FALSE(overshoot.found())
            << "seed " << seed << ": " << overshoot.swings << " of " << overshoot.changes;
    }
    EXPECT_GT(changes, 300);
}

TEST(Overshoot, AfterOneChangeAloneMayBeTheCrafts) {
    const std::vector<Step> once{{10.0, 2.0}};
    const Overshoot overshoot = find_overshoot(moving(40.0, 5.0, filtered(once, 0.3, 0.3)));
    EXPECT_EQ(overshoot.swings, 1);
    EXPECT_FALSE(overshoot.found());
}

TEST(Overshoot, IsLookedForWhereTheCraftHasADirectionOnly) {
    std::vector<TrajectoryEpoch> rows = moving(90.0, 5.0, filtered(run, 0.3, 0.3));
    for (TrajectoryEpoch& row : rows)
        row.speed_m_s = 1.9;
    EXPECT_EQ(find_overshoot(rows).changes, 0);
    rows = moving(90.0, 5.0, filtered(run, 0.3, 0.3));
    for (TrajectoryEpoch& row : rows)
        row = TrajectoryEpoch{};  // as outside of arcs, where nothing is given
    EXPECT_EQ(find_overshoot(rows).changes, 0);
    EXPECT_EQ(find_overshoot({}).changes, 0);
}

TEST(Overshoot, BelowTheUncertaintyOfTheAccelerationIsNotSeen) {
    std::vector<TrajectoryEpoch> rows = moving(90.0, 5.0, filtered(run, 0.3, 0.3));
    for (TrajectoryEpoch& row : rows)
        row.sigma_acceleration_east_m_s2 = row.sigma_acceleration_north_m_s2 = 2.0;
    EXPECT_EQ(find_overshoot(rows).swings, 0);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
