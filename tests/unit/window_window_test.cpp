#include "stages/window/window.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "stages/window/search.h"

namespace runcert {
namespace {

/// A random walk of speed with gaps and rejected epochs, as screening and smoothing would leave it.
struct Sample {
    ScreenedTable screened;
    TrajectoryTable trajectory;
};

Sample random_sample(std::uint64_t seed) {
    RandomGenerator random(seed);
    Sample sample;
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
        row.speed_mps = speed;
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

/// The best window by trying every pair of epochs, by the definition in words.
double brute_force(const TrajectoryTable& t, double duration_s, const std::string& definition,
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
            double path = 0.0;
            double sum = *t.rows[i].speed_mps;
            for (std::size_t k = i + 1; k <= j; ++k) {
                path += std::hypot(*t.rows[k].east_m - *t.rows[k - 1].east_m,
                                   *t.rows[k].north_m - *t.rows[k - 1].north_m);
                sum += *t.rows[k].speed_mps;
            }
            const double n = static_cast<double>(j - i);
            double speed = 0.0;
            if (definition == "displacement")
                speed = std::hypot(*t.rows[j].east_m - *t.rows[i].east_m,
                                   *t.rows[j].north_m - *t.rows[i].north_m) /
                        span;
            else if (definition == "path_length")
                speed = path / span;
            else if (definition == "mean_n_plus_1")
                speed = sum / (n + 1.0);
            else
                speed = (sum - *t.rows[i].speed_mps) / n;
            best = std::max(best, speed);
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
        for (const std::string definition :
             {"displacement", "path_length", "mean_n_plus_1", "mean_n"}) {
            for (const double duration_s : {1.0, 3.0}) {
                Profile profile;
                profile.id = "test";
                profile.duration_s = duration_s;
                profile.definition = definition;
                std::int64_t candidates = 0;
                const double expected =
                    brute_force(sample.trajectory, duration_s, definition, candidates);
                const Windows windows =
                    find_windows(screened, sample.trajectory, {profile},
                                 {.duration_tolerance_s = 0.001, .model = {.jerk_density = 50.0}});
                SCOPED_TRACE(definition);
                EXPECT_EQ(windows.profiles[0].candidates, candidates);
                ASSERT_EQ(windows.profiles[0].best.has_value(), candidates > 0);
                if (candidates > 0) {
                    EXPECT_NEAR(windows.profiles[0].best->speed_mps, expected, 1e-9);
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
    EXPECT_THROW(find_windows(screened, sample.trajectory, {profile},
                              {.duration_tolerance_s = 0.001, .model = {.jerk_density = 50.0}}),
                 Failure);
}

TEST(IndicatedWindow, IsFoundAcrossWhatScreeningRefused) {
    Sample sample = random_sample(5);
    ScreenedTable screened = screened_of(sample.trajectory);
    for (std::size_t k = 200; k < screened.rows.size(); ++k)
        if (screened.rows[k].east_m) *screened.rows[k].east_m += 500.0;
    screened.rows[200].break_before = ArcBreak::innovation;
    const auto indicated =
        fastest_indicated(screened, 3.0, {.duration_tolerance_s = 0.001, .model = {}});
    ASSERT_TRUE(indicated.has_value());
    EXPECT_LT(indicated->span.first_epoch, 201);
    EXPECT_GE(indicated->span.last_epoch, 201);
    EXPECT_GT(indicated->speed_mps, 150.0);
    bool said = false;
    for (const std::string& refusal : indicated->refusals)
        said = said || refusal.find("1 step") != std::string::npos;
    EXPECT_TRUE(said);
}

}  // namespace
}  // namespace runcert
