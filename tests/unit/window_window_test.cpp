#include "stages/window/window.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "stages/window/course_windows.h"
#include "window_test_support.h"
#include "witness/certifiable.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A random walk of speed with gaps and rejected epochs, as screening and smoothing would leave it.
struct Sample {
    ScreenedTable screened;
    TrajectoryTable trajectory;
};

/// A motion so free that the smoothed positions are the measured ones.
NoiseSummary free_motion() {
    EstimationModel model;
    model.motion.jerk_density = 50.0;
    return test::summary_of(model);
}

Sample random_sample(std::uint64_t seed) {
    RandomGenerator random(seed);
    Sample sample;
    sample.trajectory.estimation.horizontal = AxesEstimation{.noise = free_motion(), .health = {}};
    sample.screened.facts.nominal_interval_s = sample.trajectory.facts.nominal_interval_s = 0.1;
    std::int64_t time_ns = 0;
    std::int64_t arc = 1;
    double east_m = 0.0;
    double speed = 20.0;
    for (std::int64_t epoch = 1; epoch <= 400; ++epoch) {
        const bool gap = random.uniform() < 0.01;
        time_ns += gap ? 700'000'000 : 100'000'000;
        arc += gap ? 1 : 0;
        speed = std::abs(speed + random.normal());
        east_m += 0.1 * speed;
        TrajectoryEpoch& row = sample.trajectory.rows.emplace_back();
        row.epoch = epoch;
        row.time.nanoseconds = time_ns;
        row.east_m = east_m;
        row.north_m = std::sin(east_m / 30.0) * 10.0;
        row.speed_m_s = speed;
        row.arc = arc;
        row.usable = random.uniform() > 0.02;
        if (random.uniform() < 0.01) {
            // A repeated time stamp: an unusable epoch that belongs to no arc.
            TrajectoryEpoch& repeated = sample.trajectory.rows.emplace_back();
            repeated.epoch = ++epoch;
            repeated.time.nanoseconds = time_ns;
        }
    }
    return sample;
}

/// The speed between two rows, by the definition in words.
double value_of(const TrajectoryTable& t, std::size_t i, std::size_t j,
                SpeedDefinition definition) {
    const double span = t.rows[j].time.seconds() - t.rows[i].time.seconds();
    double path = 0.0;
    double sum = *t.rows[i].speed_m_s;
    for (std::size_t k = i + 1; k <= j; ++k) {
        path += std::hypot(*t.rows[k].east_m - *t.rows[k - 1].east_m,
                           *t.rows[k].north_m - *t.rows[k - 1].north_m);
        sum += *t.rows[k].speed_m_s;
    }
    const double n = static_cast<double>(j - i);
    if (definition == SpeedDefinition::displacement)
        return std::hypot(*t.rows[j].east_m - *t.rows[i].east_m,
                          *t.rows[j].north_m - *t.rows[i].north_m) /
               span;
    if (definition == SpeedDefinition::path_length) return path / span;
    return definition == SpeedDefinition::mean_n_plus_1 ? sum / (n + 1.0)
                                                        : (sum - *t.rows[i].speed_m_s) / n;
}

/// The best window by trying every pair of epochs.
double brute_force(const TrajectoryTable& t, double duration_s, SpeedDefinition definition,
                   std::int64_t& candidates) {
    double best = -1.0;
    candidates = 0;
    for (std::size_t i = 0; i < t.rows.size(); ++i) {
        if (!t.rows[i].arc) continue;
        for (std::size_t j = i + 1; j < t.rows.size(); ++j) {
            const double span = t.rows[j].time.seconds() - t.rows[i].time.seconds();
            if (!t.rows[j].arc || span < duration_s - 0.001 - 1e-9) continue;
            bool certifiable = span < duration_s + 0.1 - 1e-9;
            for (std::size_t k = i; k <= j; ++k)
                certifiable = certifiable && t.rows[k].usable && t.rows[k].arc == t.rows[i].arc;
            if (!certifiable) break;
            ++candidates;
            best = std::max(best, value_of(t, i, j, definition));
            break;  // the first epoch that is far enough ends the window
        }
    }
    return best;
}

/// The screened table that belongs to a sample, measured without error, so that the stretch can be
/// smoothed anew.
ScreenedTable screened_of(const TrajectoryTable& trajectory) {
    ScreenedTable screened;
    screened.facts = trajectory.facts;
    screened.facts.vertical_measured = false;
    for (const TrajectoryEpoch& row : trajectory.rows) {
        ScreenedEpoch& epoch = screened.rows.emplace_back();
        epoch.epoch = row.epoch;
        epoch.time = row.time;
        epoch.east_m = row.east_m;
        epoch.north_m = row.north_m;
        epoch.sigma_east_m = epoch.sigma_north_m = 1e-9;
        epoch.usable = row.usable;
        epoch.reason = row.usable ? Reason::none : Reason::innovation;
        epoch.arc = row.arc;
    }
    return screened;
}

TEST(WindowSearch, EqualsExhaustiveSearch) {
    for (std::uint64_t seed = 1; seed <= 25; ++seed) {
        Sample sample = random_sample(seed);
        sample.trajectory.facts.vertical_measured = false;
        // An arc must begin with a measurement.
        std::optional<std::int64_t> arc;
        for (TrajectoryEpoch& row : sample.trajectory.rows)
            if (row.arc && row.arc != arc) {
                arc = row.arc;
                row.usable = true;
            }
        const ScreenedTable screened = screened_of(sample.trajectory);
        for (const SpeedDefinition definition :
             {SpeedDefinition::displacement, SpeedDefinition::path_length,
              SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
            for (const double duration_s : {1.0, 3.0}) {
                std::int64_t candidates = 0;
                const double expected =
                    brute_force(sample.trajectory, duration_s, definition, candidates);
                const Windows windows =
                    find_windows(screened, sample.trajectory,
                                 {test::rule_over(duration_s, definition)}, test::few_draws());
                SCOPED_TRACE(to_text(definition));
                EXPECT_EQ(windows.profiles[0].candidates, candidates);
                ASSERT_EQ(windows.profiles[0].best.has_value(), candidates > 0);
                if (candidates == 0) continue;
                const CertifiableWindow& best = *windows.profiles[0].best;
                // Epochs are numbered in the order of the rows.
                const auto row = [](std::int64_t epoch) {
                    return static_cast<std::size_t>(epoch) - 1;
                };
                EXPECT_NEAR(value_of(sample.trajectory, row(best.span.first_epoch),
                                     row(best.span.last_epoch), definition),
                            expected, 1e-9);
                // The measured speed of positions without error is that of the same window.
                if (definition == SpeedDefinition::displacement ||
                    definition == SpeedDefinition::path_length) {
                    EXPECT_NEAR(best.speed_m_s, expected, 1e-4);
                }
            }
        }
    }
}

TEST(WindowSearch, EndsOfIrregularTimes) {
    const std::vector<ElapsedTime> times{
        {0}, {999'500'000}, {1'400'000'000}, {2'400'000'001}, {9'000'000'000}};
    const auto ends = window_ends(times, 1.0, 0.001, 0.5);
    EXPECT_EQ(ends[0], 1U);  // short by less than the tolerance
    EXPECT_EQ(ends[1], 3U);  // 1.4005 s: the next epoch, within one interval
    EXPECT_EQ(ends[2], 3U);
    EXPECT_FALSE(ends[3].has_value());  // the next is far beyond
    EXPECT_FALSE(ends[4].has_value());
}

TEST(WindowSearch, ATrajectoryOfOtherEpochsIsRefused) {
    Sample sample = random_sample(3);
    sample.trajectory.facts.vertical_measured = false;
    std::erase_if(sample.trajectory.rows, [](const TrajectoryEpoch& row) { return !row.arc; });
    for (TrajectoryEpoch& row : sample.trajectory.rows) {
        row.usable = true;
        row.arc = 1;
    }
    ScreenedTable screened = screened_of(sample.trajectory);
    for (ScreenedEpoch& row : screened.rows)
        *row.east_m += 0.001;  // every row has a position here
    const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    EXPECT_THROW(find_windows(screened, sample.trajectory, {profile}, test::few_draws()), Failure);
}

/// What a Failure of the search says; empty where there is none.
std::string refusal_of(const ScreenedTable& screened, const TrajectoryTable& trajectory) {
    try {
        find_windows(screened, trajectory, {test::rule_over(3.0)}, test::few_draws());
    } catch (const Failure& failure) {
        return failure.what();
    }
    return {};
}

TEST(WindowSearch, ATrajectoryOfAnotherModelIsRefused) {
    const ScreenedTable screened = test::recorded({.from_s = 20.0, .to_s = 40.0});
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    EXPECT_EQ(refusal_of(screened, trajectory), "");
    model.motion.jerk_density = 0.7;  // than that which its header claims
    trajectory.estimation.horizontal.noise = test::summary_of(model);
    EXPECT_NE(refusal_of(screened, trajectory).find("Run runcert-smooth again"), std::string::npos);
}

TEST(WindowSearch, ATrajectoryOfOtherArcsIsRefused) {
    ScreenedTable screened = test::recorded({.from_s = 20.0, .to_s = 40.0});
    const TrajectoryTable trajectory = test::smoothed_with(screened, free_motion());
    screened.rows.back().arc.reset();
    EXPECT_NE(refusal_of(screened, trajectory).find("arcs"), std::string::npos);
}

/// One speed after the first is no mean, and the sentence says so.
TEST(WindowSearch, AMeanOfOneSpeedIsRefused) {
    const ScreenedTable screened = test::recorded({.from_s = 20.0, .to_s = 40.0});
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    const TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    const auto mean_over = [&](double duration_s) {
        Profile rule = test::rule_over(duration_s);
        rule.definition = SpeedDefinition::mean_n;
        return find_windows(screened, trajectory, {rule}, test::few_draws()).profiles.at(0);
    };
    EXPECT_FALSE(mean_over(0.1).best);
    EXPECT_EQ(mean_over(0.1).missing,
              "a mean of the speeds after the first over 0.100 s needs two of them, and the "
              "recording has an epoch every 0.100 s");
    EXPECT_TRUE(mean_over(0.2).best);
    EXPECT_EQ(mean_over(0.2).missing, "");
}

TEST(CertifiedWindow, HoldsEveryWayToItsSpeed) {
    const ScreenedTable screened = test::recorded({.from_s = 20.0, .to_s = 40.0});
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    const auto best_of = [&] {
        return find_windows(screened, trajectory, {read_profile(builtin_profile("nalsa"), "nalsa")},
                            test::few_draws())
            .profiles.at(0)
            .best.value();
    };
    const CertifiableWindow best = best_of();
    EXPECT_NEAR(best.speed_m_s, 60.0, 3.0 * best.standard_uncertainty_m_s);
    EXPECT_NEAR(best.displacement_m, 3.0 * (best.speed_m_s + best.selection->bias_m_s), 1e-9);
    // nalsa's floor for fixed solutions decides against 10 mm stated.
    EXPECT_EQ(best.bound->decided_by, BoundSource::floor);
    EXPECT_EQ(best.bound->sigma_m, 0.020);
    EXPECT_GT(best.bound->standard_uncertainty_m_s, best.fitted->standard_uncertainty_m_s);
    EXPECT_EQ(best.fitted->models, 1);
    // No robust solution was kept beside this trajectory: nothing is claimed of it.
    EXPECT_FALSE(best.robust.has_value());
    // With one whose end is 0.1 m further the speeds differ by 0.0333 m/s and more than they may.
    for (TrajectoryEpoch& row : trajectory.rows) {
        row.robust_east_m = row.east_m;
        row.robust_north_m = row.north_m;
        row.robust_weight = 0.9;
    }
    EXPECT_TRUE(best_of().robust->agrees);
    EXPECT_EQ(best_of().robust->downweighted, 0);
    TrajectoryEpoch& last = trajectory.rows[static_cast<std::size_t>(best.span.last_epoch) - 1];
    *last.robust_east_m += 0.1 / std::numbers::sqrt2;
    *last.robust_north_m += 0.1 / std::numbers::sqrt2;
    *last.robust_weight = 0.4;
    const RobustSpeed robust = best_of().robust.value();
    EXPECT_NEAR(robust.difference_m_s, 0.1 / 3.0, 1e-6);
    EXPECT_LT(robust.limit_m_s, 0.1 / 3.0);
    EXPECT_FALSE(robust.agrees);
    EXPECT_EQ(robust.downweighted, 1);
}

TEST(CertifiedWindow, IsTheSameTwice) {
    const ScreenedTable screened = test::recorded({.from_s = 25.0, .to_s = 40.0});
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    const TrajectoryTable trajectory = test::smoothed_with(screened, test::summary_of(model));
    const auto best = [&] {
        return find_windows(screened, trajectory, {test::rule_over(3.0)}, test::few_draws())
            .profiles.at(0)
            .best.value();
    };
    const CertifiableWindow a = best();
    const CertifiableWindow b = best();
    EXPECT_EQ(a.speed_m_s, b.speed_m_s);
    EXPECT_EQ(a.standard_uncertainty_m_s, b.standard_uncertainty_m_s);
    EXPECT_EQ(a.monte_carlo->upper_m_s, b.monte_carlo->upper_m_s);
    EXPECT_EQ(a.selection->bias_m_s, b.selection->bias_m_s);
}

TEST(IndicatedWindow, IsFoundAcrossWhatScreeningRefused) {
    Sample sample = random_sample(5);
    ScreenedTable screened = screened_of(sample.trajectory);
    for (std::size_t k = 200; k < screened.rows.size(); ++k)
        if (screened.rows[k].east_m) *screened.rows[k].east_m += 500.0;
    screened.rows[200].break_before = ArcBreak::innovation;
    const auto indicated =
        fastest_indicated(screened, test::rule_over(3.0), test::few_draws(), std::nullopt);
    ASSERT_TRUE(indicated.has_value());
    EXPECT_LT(indicated->span.first_epoch, 201);
    EXPECT_GE(indicated->span.last_epoch, 201);
    EXPECT_GT(indicated->speed_m_s, 150.0);
    bool said = false;
    for (const std::string& refusal : indicated->refusals)
        said = said || refusal.find("1 step") != std::string::npos;
    EXPECT_TRUE(said);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
