#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/random.h"
#include "stages/screen/screen.h"
#include "stages/screen/stretch_tests.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A change of acceleration is motion, not an error: what a craft may do after it has long been
/// quiet must not be left out of a record.

ScreenConfig config() {
    return screen_config(
        read_attempt("schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
                     "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
                     "attempt"));
}

ScreenConfig without_manoeuvres() {
    ScreenConfig config = RUNCERT_FILE::config();
    config.limits.acceleration_m_s2 = 0.0;
    return config;
}

/// North at 25 m/s, and from 60 s on an acceleration that comes and goes within so long.
struct Push {
    double acceleration_m_s2 = 0.0;
    double rounding_s = 0.5;
    double lasts_s = 3.0;  ///< with both roundings
    std::uint64_t seed = 1;

    double acceleration(double time_s) const {
        const double since_s = time_s - 60.0;
        const double share =
            std::clamp(std::min(since_s, lasts_s - since_s) / rounding_s, 0.0, 1.0);
        return acceleration_m_s2 * share;
    }
};

constexpr std::size_t epochs = 1200;

/// 10 Hz, 10 mm white noise, fixed, heights of 20 mm.
EnuTable recorded(const Push& push) {
    RandomGenerator random(push.seed);
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = true;
    table.facts.nominal_interval_s = 0.1;
    double north_m = 0.0;
    double speed_m_s = 25.0;
    for (std::size_t k = 0; k < epochs; ++k) {
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        row.east_m = 0.01 * random.normal();
        row.north_m = north_m + 0.01 * random.normal();
        row.up_m = 0.02 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.01;
        row.sigma_up_m = 0.02;
        row.fix = FixType::fixed;
        for (int i = 0; i < 100; ++i) {
            const double a = push.acceleration(0.1 * static_cast<double>(k) + 0.001 * (i + 0.5));
            north_m += 0.001 * (speed_m_s + 0.0005 * a);
            speed_m_s += 0.001 * a;
        }
    }
    return table;
}

struct Found {
    std::int64_t usable = 0;
    std::int64_t arcs = 0;
    double largest_m_s2 = 0.0;
    double far_m_s2 = 0.0;  ///< the largest manoeuvre where there is none
};

Found found_in(const EnuTable& table, const ScreenConfig& config = RUNCERT_FILE::config()) {
    const ScreenedTable screened = screen(table, config);
    const ScreeningSummary summary = summarise(screened.rows);
    Found found{.usable = summary.usable, .arcs = summary.arcs};
    for (const ScreenedEpoch& row : screened.rows) {
        const double size_m_s2 = row.manoeuvre_m_s2.value_or(0.0);
        found.largest_m_s2 = std::max(found.largest_m_s2, size_m_s2);
        const double time_s = row.time.seconds();
        if (time_s < 59.5 || time_s > 63.5) found.far_m_s2 = std::max(found.far_m_s2, size_m_s2);
    }
    return found;
}

TEST(Manoeuvre, IsMotionAndLeavesTheArcWhole) {
    for (const double acceleration : {4.0, 6.0, 8.0, -8.0})
        for (const double rounding_s : {0.1, 0.5})
            for (const std::uint64_t seed : {1U, 2U}) {
                const Found found = found_in(recorded(
                    {.acceleration_m_s2 = acceleration, .rounding_s = rounding_s, .seed = seed}));
                EXPECT_EQ(found.usable, std::int64_t{epochs}) << acceleration << " " << rounding_s;
                EXPECT_EQ(found.arcs, 1) << acceleration << " " << rounding_s;
                EXPECT_GT(found.largest_m_s2, 0.3 * std::abs(acceleration));
                EXPECT_LT(found.largest_m_s2, 1.5 * std::abs(acceleration));
                EXPECT_EQ(found.far_m_s2, 0.0);
            }
}

TEST(Manoeuvre, WithoutTheHypothesisItIsTakenForAnError) {
    const EnuTable table = recorded({.acceleration_m_s2 = 8.0});
    EXPECT_LT(found_in(table, without_manoeuvres()).usable, std::int64_t{epochs});
}

TEST(Manoeuvre, OfWhatTheModelHasAnywayIsNotNamed) {
    EXPECT_EQ(found_in(recorded({})).largest_m_s2, 0.0);
    EXPECT_EQ(found_in(recorded({.acceleration_m_s2 = 0.5, .rounding_s = 1.0})).largest_m_s2, 0.0);
}

TEST(Manoeuvre, HarderThanTheClassCanIsAnError) {
    // 20 m/s^2 is what a land yacht can make.
    const Found found = found_in(recorded({.acceleration_m_s2 = 60.0, .rounding_s = 0.1}));
    EXPECT_LT(found.usable, std::int64_t{epochs});
    EXPECT_LE(found.largest_m_s2, 20.0 * 1.5);
}

TEST(Manoeuvre, ASlipBesideItIsFoundAllTheSame) {
    for (const std::size_t slip : {300U, 580U, 660U}) {
        EnuTable table = recorded({.acceleration_m_s2 = 6.0});
        for (std::size_t k = slip; k < epochs; ++k)
            *table.rows[k].east_m += 0.5;
        const ScreenedTable screened = screen(table, config());
        EXPECT_EQ(screened.rows[slip].break_before, ArcBreak::step) << slip;
        EXPECT_EQ(summarise(screened.rows).arcs, 2) << slip;
        EXPECT_GE(summarise(screened.rows).usable, std::int64_t{epochs} - 2) << slip;
    }
}

TEST(Manoeuvre, ADriftFarFromItIsRefused) {
    EnuTable table = recorded({.acceleration_m_s2 = 6.0});
    for (std::size_t k = 300; k < epochs; ++k)
        *table.rows[k].east_m += 0.1 * static_cast<double>(k - 300);  // 1 m/s
    const ScreenedTable screened = screen(table, config());
    EXPECT_EQ(screened.rows[200].reason, Reason::model);
    EXPECT_EQ(screened.rows[200].hypothesis, Hypothesis::ramp);
    EXPECT_LT(summarise(screened.rows).usable, 100);
}

/// From a stand up to 57 m/s and back at once; the acceleration changes by this jerk (m/s^3).
EnuTable peak(double acceleration_m_s2, double jerk_m_s3, double sigma_m, std::uint64_t seed) {
    RandomGenerator random(seed);
    const double rounding_s = acceleration_m_s2 / jerk_m_s3;
    const double lasts_s = 57.0 / acceleration_m_s2 + rounding_s;
    const auto pushed = [&](double since_s) {
        return acceleration_m_s2 *
               std::clamp(std::min(since_s, lasts_s - since_s) / rounding_s, 0.0, 1.0);
    };
    EnuTable table = recorded({});
    table.rows.resize(static_cast<std::size_t>(10.0 * (20.0 + 2.0 * lasts_s)));
    double north_m = 0.0, speed_m_s = 0.0;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        EnuEpoch& row = table.rows[k];
        row.east_m = sigma_m * random.normal();
        row.north_m = north_m + sigma_m * random.normal();
        row.up_m = 2.0 * sigma_m * random.normal();
        row.sigma_east_m = row.sigma_north_m = sigma_m;
        row.sigma_up_m = 2.0 * sigma_m;
        for (int i = 0; i < 100; ++i) {
            const double since_s = 0.1 * static_cast<double>(k) + 0.001 * (i + 0.5) - 10.0;
            const double a = pushed(since_s) - pushed(since_s - lasts_s);
            north_m += 0.001 * (speed_m_s + 0.0005 * a);
            speed_m_s += 0.001 * a;
        }
    }
    return table;
}

// Accelerations that come and go over a second are no single manoeuvre: several stand for them.
TEST(Manoeuvre, HardPeaksLoseNoEpoch) {
    for (const double acceleration : {4.4, 5.3, 6.2})
        for (const double sigma_m : {0.004, 0.010})
            for (std::uint64_t seed = 1; seed <= 6; ++seed) {
                const EnuTable table = peak(acceleration, 6.7, sigma_m, seed);
                const Found found = found_in(table);
                EXPECT_EQ(found.usable, std::ssize(table.rows))
                    << acceleration << " " << sigma_m << " " << seed;
            }
}

// Nor does hard motion hide what is wrong: a step and a drift in the middle of a peak.
TEST(Manoeuvre, AStepOrADriftAcrossAHardPeakIsFound) {
    int steps = 0, drifts = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        EnuTable stepped = peak(6.2, 6.7, 0.010, seed), drifting = stepped;
        for (std::size_t k = 190; k < stepped.rows.size(); ++k) {
            *stepped.rows[k].east_m += 1.0;
            *drifting.rows[k].east_m += 0.3 * static_cast<double>(k - 190);  // 3 m/s
        }
        steps += found_in(stepped).arcs > 1;
        drifts += found_in(drifting).usable < std::ssize(drifting.rows);
    }
    EXPECT_EQ(steps, 6);
    EXPECT_GE(drifts, 5);
}

/// The tests of one stretch of 200 epochs, straight but for what `moved` adds north (m).
class Stretch {
  public:
    template <class Moved>
    explicit Stretch(const Moved& moved) {
        RandomGenerator random(3);
        for (int k = 0; k < 200; ++k) {
            ArcEpoch<2>& epoch = stretch_.epochs.emplace_back();
            epoch.time_s = 0.1 * k;
            epoch.measurement.emplace();
            epoch.measurement->covariance = 1e-4 * Eigen::Matrix2d::Identity();
            epoch.measurement->position << 0.01 * random.normal(),
                2.5 * k + moved(epoch.time_s) + 0.01 * random.normal();
        }
    }
    StretchTests<2> tests(const TestPlan& plan) const { return {stretch_, model_, plan}; }

  private:
    TestedStretch<2> stretch_;
    EstimationModel model_{.motion = {.jerk_density = 0.6}};
};

TestPlan plan(double manoeuvre_max_m_s2 = 20.0) {
    return {0.001, 200 * tests_of_an_epoch({}, 20), 0.8, 20, manoeuvre_max_m_s2};
}

/// Of the candidates of a kind the best supported.
Candidate best_of(const std::vector<Candidate>& candidates, Hypothesis hypothesis, bool manoeuvre) {
    Candidate best;
    for (const Candidate& one : candidates)
        if (one.hypothesis == hypothesis && one.manoeuvre == manoeuvre &&
            one.statistic > best.statistic)
            best = one;
    return best;
}

double square_from(double time_s, double acceleration_m_s2) {
    const double since_s = std::max(0.0, time_s - 10.0);
    return 0.5 * acceleration_m_s2 * since_s * since_s;
}

TEST(ManoeuvreTest, FindsWhenAndByHowMuchTheAccelerationChanges) {
    const Stretch stretch([](double time_s) { return square_from(time_s, 6.0); });
    const TestPlan with = plan();
    const StretchTests<2> tests = stretch.tests(with);
    const Candidate best = best_of(tests.candidates(), Hypothesis::ramp, true);
    EXPECT_NEAR(static_cast<double>(best.first), 100.0, 2.0);
    EXPECT_NEAR(tests.manoeuvre_of(best), 6.0, 1.5);
    EXPECT_GT(best.statistic, with.critical(2));
    EXPECT_EQ(best.degrees_of_freedom, 2);
    // It is no error: nothing is estimated of one, and nothing stands in its place.
    EXPECT_FALSE(tests.estimate_of(best).rate_north_m_s);
    EXPECT_EQ(tests.best_explanation(best, false).first, best.first);
    EXPECT_TRUE(tests.best_explanation(best, false).manoeuvre);
    // Not where the plan has none, nor where it would be more than the class can make.
    for (const double largest_m_s2 : {0.0, 4.0}) {
        const TestPlan less = plan(largest_m_s2);
        const auto candidates = stretch.tests(less).candidates();
        EXPECT_FALSE(candidates.empty());
        EXPECT_LT(best_of(candidates, Hypothesis::ramp, true).statistic, best.statistic);
    }
    const TestPlan none = with.with_manoeuvres(0.0);
    EXPECT_EQ(none.manoeuvre_max_m_s2(), 0.0);
    EXPECT_EQ(none.critical(2), with.critical(2));
    EXPECT_EQ(best_of(stretch.tests(none).candidates(), Hypothesis::ramp, true).statistic, 0.0);
}

TEST(ManoeuvreTest, TakesThePlaceOfADriftThatItExplains) {
    // Nearly a drift: the speed changes by 3 m/s within half a second.
    const Stretch stretch(
        [](double time_s) { return square_from(time_s, 6.0) - square_from(time_s - 0.5, 6.0); });
    const TestPlan with = plan();
    const StretchTests<2> tests = stretch.tests(with);
    const auto candidates = tests.candidates();
    const Candidate drift = best_of(candidates, Hypothesis::ramp, false);
    const Candidate manoeuvre = best_of(candidates, Hypothesis::ramp, true);
    ASSERT_GT(drift.statistic, manoeuvre.statistic);
    ASSERT_GT(manoeuvre.statistic, 0.6 * drift.statistic);
    const Candidate instead = tests.best_explanation(drift, false);
    EXPECT_TRUE(instead.manoeuvre);
    EXPECT_EQ(instead.first, manoeuvre.first);
    EXPECT_EQ(instead.statistic, manoeuvre.statistic);
    const TestPlan none = plan(0.0);
    EXPECT_FALSE(stretch.tests(none).best_explanation(drift, false).manoeuvre);
}

TEST(ManoeuvreTest, DoesNotTakeThePlaceOfADriftOrAStepThatItDoesNotExplain) {
    const TestPlan with = plan();
    // A drift that begins at once is no motion of a craft; nor is a step.
    const Stretch drifting([](double time_s) { return 3.0 * std::max(0.0, time_s - 10.0); });
    const Candidate drift = best_of(drifting.tests(with).candidates(), Hypothesis::ramp, false);
    EXPECT_EQ(drift.first, 100U);
    EXPECT_FALSE(drifting.tests(with).best_explanation(drift, false).manoeuvre);
    const Stretch stepped([](double time_s) { return time_s < 9.95 ? 0.0 : 0.5; });
    const Candidate step = best_of(stepped.tests(with).candidates(), Hypothesis::step, false);
    EXPECT_EQ(step.first, 100U);
    EXPECT_FALSE(stepped.tests(with).best_explanation(step, false).manoeuvre);
    // Nor of a drift by a manoeuvre more than 40 epochs away.
    const Stretch apart([](double time_s) {
        return square_from(time_s - 5.0, 8.0) + 0.3 * std::max(0.0, time_s - 4.0);
    });
    const Candidate far = best_of(apart.tests(with).candidates(), Hypothesis::ramp, false);
    ASSERT_GT(far.statistic, 0.0);
    Candidate early = far;
    early.first = early.last = 40;
    early.statistic = with.critical(2) * 1.01;
    const Candidate instead = apart.tests(with).best_explanation(early, false);
    EXPECT_FALSE(instead.manoeuvre && instead.first > 80);
}

TEST(ManoeuvreTest, AnOutlierStaysOne) {
    const Stretch stretch([](double time_s) {
        return square_from(time_s, 6.0) + (std::abs(time_s - 10.5) < 0.05 ? 0.4 : 0.0);
    });
    const TestPlan with = plan();
    const StretchTests<2> tests = stretch.tests(with);
    const Candidate outlier = best_of(tests.candidates(), Hypothesis::outlier, false);
    EXPECT_EQ(outlier.first, 105U);
    EXPECT_FALSE(tests.best_explanation(outlier, false).manoeuvre);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
