#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

// Screening, smoothing and windows of a run whose positions step aside in its fastest seconds.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double step_m = 0.5;
constexpr double step_at_s = 30.0;
constexpr std::int64_t step_epoch = 301;

/// 60 s that are fastest, 35 m/s, in their middle: 20 m/s and a bell of 15 m/s and 8 s.
double distance_m(double time_s) {
    const double x = (time_s - step_at_s) / 8.0;
    return 20.0 * time_s + 15.0 * 8.0 * std::sqrt(std::numbers::pi) / 2.0 * std::erf(x);
}

Eigen::Vector2d direction() {
    return {0.6, 0.8};
}

/// The run at 10 Hz with 10 mm of white noise; from the fastest moment on positions are 0.5 m
/// further east: 0.3 m ahead, and 0.4 m aside. (What is only ahead could be late stamps as well.)
EnuTable recording() {
    RandomGenerator random(11);
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.georeferenced = true;
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    for (std::int64_t k = 0; k <= 600; ++k) {
        const double time_s = 0.1 * static_cast<double>(k);
        const Eigen::Vector2d position = distance_m(time_s) * direction();
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = position.x() + (k + 1 >= step_epoch ? step_m : 0.0) + 0.010 * random.normal();
        row.north_m = position.y() + 0.010 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.fix = FixType::fixed;
    }
    return table;
}

struct CertifiedRun {
    ScreenedTable screened;
    TrajectoryTable trajectory;
    ProfileWindows windows;
};

CertifiedRun certified() {
    const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
        "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
        "attempt");
    Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    profile.duration_s = 3.0;
    CertifiedRun run;
    run.screened = screen(recording(), screen_config(attempt));
    // As the stages hand them on: by their files.
    run.screened = read_screened(write_screened(run.screened), "3-screened");
    run.trajectory = smooth_trajectory(run.screened, smooth_config(attempt));
    run.trajectory = read_trajectory(write_trajectory(run.trajectory), "4-trajectory");
    run.windows = find_windows(run.screened, run.trajectory, {profile},
                               window_config(attempt, attempt.receivers.front()))
                      .profiles.at(0);
    return run;
}

bool holds_step(const WindowSpan& span) {
    return span.first_epoch < step_epoch && span.last_epoch >= step_epoch;
}

double true_speed_m_s(const WindowSpan& span) {
    const double start_s = span.start.seconds();
    const double duration_s = span.duration.seconds();
    return (distance_m(start_s + duration_s) - distance_m(start_s)) / duration_s;
}

TEST(PositionStep, EndsTheArcAndIsNamedWithItsSize) {
    const CertifiedRun run = certified();
    EXPECT_EQ(summarise(run.screened.rows).arcs, 2);
    EXPECT_EQ(run.trajectory.estimation.arcs, 2);
    for (const ScreenedEpoch& row : run.screened.rows)
        EXPECT_EQ(row.break_before == ArcBreak::step, row.epoch == step_epoch) << row.epoch;
    const EstimatedError& step = run.screened.rows.at(step_epoch - 1).estimated;
    EXPECT_NEAR(step.east_m.value(), step_m, 4.0 * step.sigma_east_m.value());
    EXPECT_NEAR(step.north_m.value(), 0.0, 4.0 * step.sigma_north_m.value());
}

TEST(PositionStep, NoWindowAcrossItIsCertified) {
    const CertifiedRun run = certified();
    const CertifiableWindow& best = run.windows.best.value();
    EXPECT_FALSE(holds_step(best.span));
    EXPECT_NEAR(best.speed_m_s, true_speed_m_s(best.span), 2.0 * best.standard_uncertainty_m_s);
    // The fastest that the raw positions indicate does hold it, and is refused for it alone.
    const IndicatedWindow& indicated = run.windows.indicated.value();
    EXPECT_TRUE(holds_step(indicated.span));
    EXPECT_GT(indicated.speed_m_s, true_speed_m_s(indicated.span) + 0.05);
    ASSERT_EQ(indicated.refusals.size(), 1U);
    EXPECT_NE(indicated.refusals[0].find("1 step that the motion cannot explain"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
