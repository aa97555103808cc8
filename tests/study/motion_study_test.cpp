#include "motion_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "draws.h"
#include "schemas/windows/windows.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "supposed_errors.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// One cell, by the beginning of its motion's name and its errors.
MotionCell cell_of(const std::string& motion, const std::string& errors, double rate_hz = 10.0) {
    const std::vector<MotionCell> cells = motion_cells(rate_hz);
    const auto found = std::ranges::find_if(cells, [&](const MotionCell& cell) {
        return cell.motion == motion && cell.errors == errors;
    });
    if (found == cells.end()) throw Failure("", "there is no cell " + motion + ", " + errors, "");
    return *found;
}

/// What a cell of few runs can show: every run certified, all but one held, nothing falsely
/// decided. What spoils every run is found by the four of the daily set for certain, what spoils
/// half of them with probability 0.7 in each cell.
void expect_honest(const MotionCell& cell, int in_study) {
    const int runs = draws({.daily = 4, .study = in_study});
    SCOPED_TRACE(cell.motion + ", " + cell.errors);
    const MotionSummary sum = summarise(study_motion(cell, {.runs = runs}));
    fmt::print("{}", motion_line(cell, sum));
    EXPECT_GE(sum.certified, runs - 1);
    EXPECT_GE(sum.held, sum.certified - 1);
    EXPECT_LE(sum.missed, 1);
    EXPECT_EQ(sum.beaten, 0);
    EXPECT_EQ(sum.not_beaten, 0);
    const auto n = static_cast<double>(sum.certified);
    EXPECT_LE(std::abs(sum.mean_error_m_s),
              sum.mean_expanded_m_s / 5.0 + 2.0 * sum.sd_error_m_s / std::sqrt(n));
}

/// Expanded uncertainty (m/s) of the fastest 3 s of a run after so many seconds of waiting, in
/// which the white noise of 8 mm was so many times as large.
double expanded_after(double waiting_s, double noise_factor, std::uint64_t seed) {
    auto script = std::make_shared<MotionScript>();
    script->add(4.0 + waiting_s)
        .change_speed(60.0, 4.0, 2.0)
        .add(6.0)
        .change_speed(-60.0, 4.0, 2.0)
        .add(4.0);
    StudyRun run;
    run.length_s = script->duration_s();
    run.jerk_density = 0.0;
    run.noise.white_m = 0.008;
    run.script = script;
    SimulatedRecording recording = simulate_recording(run, seed);
    for (std::size_t k = 0; k < recording.truth.size(); ++k) {
        ScreenedEpoch& row = recording.screened.rows[k];
        if (row.time.seconds() > waiting_s) break;
        row.east_m = recording.truth[k].x() + noise_factor * (*row.east_m - recording.truth[k].x());
        row.north_m =
            recording.truth[k].y() + noise_factor * (*row.north_m - recording.truth[k].y());
    }
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    const ScreenedTable screened =
        screen(to_be_screened(recording.screened), study_screen_config());
    WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
    config.monte_carlo_trials_max = 100'000;
    const Windows windows =
        find_windows(screened, smooth_trajectory(screened, smooth_config(study_attempt())),
                     {profile}, config, std::nullopt, {});
    return expanded_uncertainty_by_rule_m_s(windows.profiles.front().best.value(), 2.0);
}

// Screening took the first seconds of a run after quiet waiting for outliers.
TEST(Motion, FiveMinutesOfWaitingWithAnotherNoiseChangeNoInterval) {
    for (const double factor : {3.0, 1.0 / 3.0}) {
        double alone = 0.0, after = 0.0;
        const int runs = draws({.daily = 2, .study = 20});
        for (int i = 0; i < runs; ++i) {
            alone += expanded_after(0.0, 1.0, 100 + static_cast<std::uint64_t>(i));
            after += expanded_after(300.0, factor, 100 + static_cast<std::uint64_t>(i));
        }
        fmt::print("noise {:.2f} times as large: U {:.4f} and {:.4f} m/s\n", factor, alone / runs,
                   after / runs);
        // One scale is fitted to the whole recording, and a part of U follows it.
        EXPECT_NEAR(after / alone, 1.0, 0.16);
    }
}

TEST(Motion, TwentyQuietMinutesDoNotSmoothTheRunAway) {
    expect_honest(cell_of("quiet 20 min, 2 m/s2 at once, plateau 3.5 s", "10 mm white"), 10);
    expect_honest(cell_of("quiet 20 min, peak at 4 m/s2", "3 mm white, 8 mm 1.5 s"), 6);
}

TEST(Motion, HardAccelerationIsNotScreenedAway) {
    expect_honest(cell_of("quiet 0 min, 8 m/s2 over 0.5 s, plateau 3.5 s", "10 mm white"), 10);
    expect_honest(cell_of("quiet 20 min, 6 m/s2 over 0.5 s, plateau 3.5 s", "10 mm white"), 6);
    expect_honest(cell_of("quiet 1 min, braking at 8 m/s2 over 0.3 s", "10 mm white"), 10);
}

TEST(Motion, HardPeaksAreNotScreenedAway) {
    expect_honest(cell_of("quiet 1 min, peak at 6.2 m/s2, jerk 6.7", "10 mm white"), 20);
    expect_honest(cell_of("quiet 1 min, peak at 5.3 m/s2, jerk 6.7", "3 mm white, 8 mm 1.5 s"), 20);
}

TEST(Motion, GustsAndEqualRuns) {
    expect_honest(cell_of("quiet 1 min, gusts of 2.3 and 7 s", "3 mm white, 20 mm 1.5 s"), 10);
    expect_honest(cell_of("quiet 1 min, two equal runs", "3 mm white, 8 mm 1.5 s"), 10);
}

TEST(Motion, SlowErrorsAlongTheTrack) {
    expect_honest(
        cell_of("quiet 1 min, 2 m/s2 at once, plateau 3.5 s", "10 mm white, 80 mm 1.5 s along"),
        12);
}

TEST(Motion, OtherRates) {
    for (const double rate_hz : {1.0, 5.0, 20.0})
        expect_honest(cell_of("quiet 1 min, 2 m/s2 at once, plateau 30 s", "10 mm white", rate_hz),
                      8);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
