#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "core/geodesy.h"
#include "core/random.h"
#include "witness/surface_input.h"
#include "surface_of_runs/surface_of_runs.h"

// A course that earlier runs show: a plane that rises 1 % along and 4 % across.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double antenna_m = 1.2;

Geodetic place_at(double latitude_deg, double longitude_deg, double height_m) {
    return {.latitude = Angle::from_degrees(latitude_deg),
            .longitude = Angle::from_degrees(longitude_deg),
            .height_m = height_m};
}

const Geodetic course = place_at(-31.6, 136.0, 110.0);

double ground_m(double east_m, double north_m) {
    return 2.0 + 0.01 * east_m + 0.04 * north_m;
}

/// A run along a line at `north_m`, in the frame of an origin of its own.
ScreenedTable run_along(double north_m, const Geodetic& own_origin, std::uint64_t seed,
                        double vertical_m = 0.015) {
    RandomGenerator random(seed);
    const LocalFrame frame(course), own(own_origin);
    ScreenedTable table;
    table.facts = {.receiver = "primary", .first_epoch = std::nullopt};
    table.origin = FrameOrigin{.position = own_origin, .source = "first_epoch"};
    for (std::int64_t k = 0; k < 150; ++k) {
        const double east_m = 4.0 * static_cast<double>(k);
        // The normal leans by 4 % against north and 1 % against east.
        const double up_m = ground_m(east_m, north_m) + antenna_m / std::hypot(1.0, 0.01, 0.04);
        const double scale = antenna_m / std::hypot(1.0, 0.01, 0.04);
        const Enu antenna{
            {east_m - 0.01 * scale, north_m - 0.04 * scale, up_m + vertical_m * random.normal()}};
        const Eigen::Vector3d there = own.enu_from_ecef(frame.ecef_from_enu(antenna)).m;
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time.nanoseconds = k * 100'000'000;
        row.east_m = there.x();
        row.north_m = there.y();
        row.up_m = there.z();
        row.sigma_up_m = vertical_m;
        row.usable = k != 50;
        row.arc = 1;
    }
    *table.rows[50].up_m += 9.0;  // an outlier, marked
    return table;
}

struct Runs {
    std::vector<ScreenedTable> tables;
    std::vector<EarlierRun> runs;

    explicit Runs(int count) {
        for (int i = 0; i < count; ++i)
            tables.push_back(run_along(6.0 * i, place_at(-31.6, 136.0 + 0.001 * i, 100.0 + i),
                                       static_cast<std::uint64_t>(i) + 1));
        for (int i = 0; i < count; ++i)
            runs.push_back({.id = fmt::format("run-{}", i),
                            .recordings = {fmt::format("hash-{}", i)},
                            .positions = &tables[static_cast<std::size_t>(i)],
                            .antenna_height_m = antenna_m});
    }
};

std::string refused(const std::vector<EarlierRun>& runs) {
    try {
        (void)surface_of_runs(runs);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "accepted";
}

TEST(SurfaceOfRuns, IsTheGroundUnderRunsWithOriginsOfTheirOwn) {
    const Runs five(5);
    // As it is written and read.
    const SurfaceTable table =
        read_surface(write_surface(surface_of_runs(five.runs)), "course.ecsv");
    EXPECT_TRUE(table.georeferenced);
    ASSERT_EQ(table.made_from.size(), 5U);
    EXPECT_EQ(table.made_from[3].id, "run-3");
    EXPECT_EQ(table.made_from[3].recordings, std::vector<std::string>{"hash-3"});
    EXPECT_EQ(table.made_from[3].positions, 148);  // the first has no direction, one is left out
    EXPECT_NEAR(table.vertical_sd_m, 0.015, 0.003);
    const Triangulation surface =
        surface_of(table, FrameOrigin{.position = course, .source = "attempt"});
    double worst_m = 0.0;
    int inside = 0;
    for (double east_m = 20.0; east_m < 580.0; east_m += 7.0)
        for (double north_m = 3.0; north_m < 22.0; north_m += 3.0) {
            const auto point = surface.at({east_m, north_m});
            if (!point) continue;
            ++inside;
            worst_m = std::max(worst_m, std::abs(point->up_m - ground_m(east_m, north_m)));
            EXPECT_NEAR(point->normal.y(), -0.04, 0.01);
        }
    EXPECT_GT(inside, 400);
    EXPECT_LT(worst_m, 0.03);
    EXPECT_FALSE(surface.at({300.0, 60.0}));
}

TEST(SurfaceOfRuns, OfRunsThatCannotShowItIsRefused) {
    Runs two(2);
    EXPECT_NE(refused({two.runs[0]}).find("no part of the course has positions on both sides"),
              std::string::npos);
    std::vector<EarlierRun> twice = two.runs;
    twice[1].recordings = twice[0].recordings;
    EXPECT_NE(refused(twice).find("is that of another run, too"), std::string::npos);
    two.tables[1].facts.georeferenced = false;
    EXPECT_NE(refused(two.runs).find("not in one coordinate system"), std::string::npos);
    two.tables[1].facts.georeferenced = true;
    two.tables[1].facts.vertical_measured = false;
    EXPECT_NE(refused(two.runs).find("has no heights"), std::string::npos);
    EXPECT_NE(refused({}).find("no run is named"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
