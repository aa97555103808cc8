#include "speeds_study.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "draws.h"

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<SpeedsSummary> study(const SpeedsCell& cell, std::int64_t runs) {
    const auto summaries =
        study_speeds([&](std::uint64_t seed) { return certify_speeds(cell, seed); }, runs, 1, 1);
    fmt::print("{}", speeds_lines(cell.name, summaries));
    return summaries;
}

/// What the mean U of a cell's rules is at most, km/h: a fifth above that of 100 sessions.
struct Limits {
    SpeedsCell cell;
    double two_s_km_h = 0.0, ten_s_km_h = 0.0;
};

void PrintTo(const Limits& limits, std::ostream* out) {
    *out << limits.cell.name;
}

Limits of_session(double rate_hz, double white_m_s, double filter_s, double two_s_km_h,
                  double ten_s_km_h) {
    return {.cell = {.name = fmt::format("{:g} Hz, {:g} m/s{}", rate_hz, white_m_s,
                                         filter_s > 0.0 ? ", filtered" : ""),
                     .rate_hz = rate_hz,
                     .length_s = 600.0,
                     .white_m_s = white_m_s,
                     .white_filter_s = filter_s,
                     .stated_m_s = 0.5},
            .two_s_km_h = two_s_km_h,
            .ten_s_km_h = ten_s_km_h};
}

class SpeedsOfRecordedVelocities : public testing::TestWithParam<Limits> {};

/// Of 12 runs of 2 rules fewer than 21 hold with 0.96 where each does with 0.8, as where the slow
/// error is left out.
TEST_P(SpeedsOfRecordedVelocities, HoldTheTruthAndAreTight) {
    const Limits& limits = GetParam();
    const auto summaries = study(limits.cell, draws({.daily = 12, .study = 200}));
    double held = 0.0;
    const double at_most_km_h[] = {limits.two_s_km_h, limits.ten_s_km_h};
    for (std::size_t i = 0; i < summaries.size(); ++i) {
        const SpeedsSummary& one = summaries[i];
        SCOPED_TRACE(one.rule);
        EXPECT_EQ(one.certified, one.runs);
        held += 0.5 * one.held;
        EXPECT_LT(3.6 * one.mean_expanded, at_most_km_h[i]);
        EXPECT_LT(std::abs(one.mean_error), 0.5 * one.mean_expanded);
        if (is_study()) {
            EXPECT_GE(one.held, 0.95);
        }
    }
    EXPECT_GE(held, 0.87);
}

INSTANTIATE_TEST_SUITE_P(
    Cells, SpeedsOfRecordedVelocities,
    testing::Values(of_session(10.0, 0.05, 0.0, 1.05, 0.52), of_session(10.0, 0.1, 0.0, 1.05, 0.53),
                    of_session(10.0, 0.3, 0.0, 1.15, 0.63), of_session(1.0, 0.05, 0.0, 1.15, 0.57),
                    of_session(1.0, 0.1, 0.0, 1.25, 0.67), of_session(1.0, 0.3, 0.0, 2.7, 1.45),
                    of_session(10.0, 0.1, 0.3, 1.17, 0.56), of_session(10.0, 0.3, 0.3, 2.4, 0.85)));

/// Where the positions follow the velocities nothing is told of lasting errors, and what is stated
/// counts whole: 0.5 m/s.
TEST(SpeedsOfRecordedVelocities, CountWholeBesidePositionsThatFollowThem) {
    const SpeedsCell cell{
        .length_s = 600.0, .stated_m_s = 0.5, .positions = SpeedsPositions::integrated};
    for (int seed = 1; seed <= draws({.daily = 3, .study = 30}); ++seed)
        for (const CertifiedSpeed& one : certify_speeds(cell, static_cast<std::uint64_t>(seed))) {
            EXPECT_GE(one.expanded, 0.999) << one.rule;
            // Half of the range of the choice's bias beside it, as all of it may differ.
            EXPECT_LT(one.expanded, 1.6) << one.rule;
            EXPECT_LE(std::abs(one.error()), one.expanded) << one.rule;
        }
}

/// All cells are the study's. Daily, of 10 runs fewer than 8 hold with 0.97 where each does with
/// 0.5.
TEST(SpeedsOfRecordedVelocities, HoldTheTruthInEveryCell) {
    constexpr std::array daily{"honest, 1 Hz",
                               "jitter and gaps, 5 Hz",
                               "low-passed 1.5 s, 1 Hz",
                               "errs 0.15 m/s, states 0.08",
                               "scale +1.5 %",
                               "spike of +45 %, 10 Hz",
                               "spike of two samples, +25 %"};
    // Nothing beside the speeds tells that these state too little.
    constexpr std::array untold{"positions integrated, states 0.15",
                                "positions integrated, 0.1 m, states 0.15",
                                "differences of positions", "differences of positions, 0.03 m/s"};
    for (const SpeedsCell& cell : speeds_cells()) {
        if (!is_study() && std::ranges::find(daily, cell.name) == daily.end()) continue;
        SCOPED_TRACE(cell.name);
        for (const SpeedsSummary& one : study(cell, draws({.daily = 10, .study = 100}))) {
            SCOPED_TRACE(one.rule);
            if (is_study() && std::ranges::find(untold, cell.name) == untold.end())
                EXPECT_EQ(one.misses(), "");
            else
                EXPECT_GE(one.held, 0.8);
        }
    }
}

/// What people record: the mean error is a small part of U.
TEST(SpeedsOfRecordedVelocities, OfPeoplesDevicesHaveNoBiasThatCounts) {
    for (const PeopleKind& kind : people_kinds()) {
        if (kind.velocities != PeopleVelocities::stated) continue;
        if (!is_study() && kind.name != "1 Hz, velocities") continue;
        SCOPED_TRACE(kind.name);
        for (const SpeedsSummary& one :
             study_speeds([&](std::uint64_t seed) { return certify_speeds(kind, seed); },
                          draws({.daily = 20, .study = 100}), 1, 1)) {
            SCOPED_TRACE(one.rule);
            EXPECT_GE(one.held, draws({.daily = 90, .study = 95}) / 100.0);
            EXPECT_LT(std::abs(one.mean_error), 0.2 * one.mean_expanded);
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
