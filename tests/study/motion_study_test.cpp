#include "motion_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "draws.h"

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
