#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "core/failure.h"
#include "core/random.h"
#include "stages/screen/screen.h"

// Heights of positions against a course that is known: a strip that rises by 2 % and banks by 5 %.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double antenna_m = 1.5;

double ground_m(double east_m, double north_m) {
    return 3.0 + 0.02 * east_m + 0.05 * north_m;
}

Eigen::Vector3d normal() {
    return Eigen::Vector3d(-0.02, -0.05, 1.0).normalized();
}

/// The strip from -20 m to 20 m north, in squares of 10 m.
GroundBelow strip(double length_m = 1300.0) {
    SurfaceMesh mesh;
    const auto columns = static_cast<std::uint32_t>(length_m / 10.0);
    for (std::uint32_t column = 0; column <= columns; ++column)
        for (int row = -2; row <= 2; ++row)
            mesh.vertices.emplace_back(10.0 * column - 10.0, 10.0 * row,
                                       ground_m(10.0 * column - 10.0, 10.0 * row));
    for (std::uint32_t column = 0; column < columns; ++column)
        for (std::uint32_t row = 0; row < 4; ++row) {
            const std::uint32_t corner = 5 * column + row;
            mesh.triangles.push_back({corner, corner + 5, corner + 6});
            mesh.triangles.push_back({corner, corner + 6, corner + 1});
        }
    return {.surface = Triangulation(std::move(mesh)),
            .vertical_sd_m = 0.10,
            .antenna_height_m = antenna_m,
            .tilt_max_deg = 10.0,
            .undulation_m = 0.0,
            .place = "attempt.yaml:9:9"};
}

EnuTable run_over_it(std::size_t epochs, std::uint64_t seed = 1) {
    RandomGenerator random(seed);
    EnuTable table;
    table.facts = {.receiver = "primary",
                   .first_epoch = std::nullopt,
                   .georeferenced = true,
                   .vertical_measured = true,
                   .nominal_interval_s = 0.1};
    for (std::size_t k = 0; k < epochs; ++k) {
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = static_cast<std::int64_t>(k) + 1;
        row.time.nanoseconds = static_cast<std::int64_t>(k) * 100'000'000;
        const double east_m = 3.0 * static_cast<double>(k);
        const Eigen::Vector3d antenna =
            Eigen::Vector3d(east_m, 0.0, ground_m(east_m, 0.0)) + antenna_m * normal();
        row.east_m = antenna.x() + 0.01 * random.normal();
        row.north_m = antenna.y() + 0.01 * random.normal();
        row.up_m = antenna.z() + 0.02 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.01;
        row.sigma_up_m = 0.02;
        row.fix = FixType::fixed;
    }
    return table;
}

ScreenConfig config() {
    return screen_config(
        read_attempt("schema: attempt/1.0\nid: t\ncraft: {name: t, class: land-yacht}\n"
                     "receivers: [{id: primary, recording: r}]\nprofiles: [nalsa]\n",
                     "attempt"));
}

ScreenedTable screened_over(const EnuTable& table, const GroundBelow& ground) {
    const std::array beside{ScreeningWitnesses{.handed_in = {}, .ground = &ground}};
    return screen_receivers(std::span(&table, 1), config(), beside).front();
}

std::string refused(const EnuTable& table, const GroundBelow& ground) {
    try {
        (void)screened_over(table, ground);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "accepted";
}

bool says(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

std::int64_t marked(const ScreenedTable& table) {
    return std::ranges::count(table.rows, Reason::surface, &ScreenedEpoch::reason);
}

TEST(SurfaceCheck, HeightsOnTheSurfaceAreKeptAndChangeNothing) {
    const GroundBelow ground = strip();
    const EnuTable table = run_over_it(400);
    const ScreenedTable screened = screened_over(table, ground);
    ASSERT_TRUE(screened.basis.surface);
    const SurfaceComparison& found = *screened.basis.surface;
    EXPECT_EQ(found.compared, 400);
    EXPECT_EQ(found.outside, 0);
    EXPECT_EQ(found.rejected, 0);
    EXPECT_EQ(marked(screened), 0);
    EXPECT_FALSE(found.offset_removed);
    EXPECT_NEAR(found.offset_m, 0.0, 0.005);
    EXPECT_NEAR(found.scatter_m, 0.02, 0.004);
    // 10 cm of the survey and 2 cm of the position, and 1.5 m (1 - cos 10 deg).
    EXPECT_NEAR(found.sigma_offset_m, std::hypot(0.10, 0.02) + 0.0228, 0.002);
    // 400 epochs, each with 57 tests of two series, three limits and the surface.
    ASSERT_EQ(screened.basis.tests, 400 * (2 * 27 + 3 + 1));
    EXPECT_NEAR(found.detectable_m, (5.4776 + 0.8416) * found.sigma_offset_m, 1e-4);
    // A check and no measurement: positions are what they were.
    const ScreenedTable alone = screen(table, config());
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        EXPECT_EQ(screened.rows[k].up_m, alone.rows[k].up_m);
        EXPECT_EQ(screened.rows[k].usable, alone.rows[k].usable);
    }
}

TEST(SurfaceCheck, ASolutionNineTenthsOfAMetreTooHighForTenSecondsIsMarked) {
    EnuTable table = run_over_it(400);
    for (std::size_t k = 150; k < 250; ++k)
        *table.rows[k].up_m += 0.9;
    const ScreenedTable screened = screened_over(table, strip());
    const SurfaceComparison& found = *screened.basis.surface;
    EXPECT_FALSE(found.offset_removed);
    EXPECT_GE(found.rejected, 95);
    std::int64_t inside = 0;
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const ScreenedEpoch& row = screened.rows[k];
        if (row.reason != Reason::surface) continue;
        EXPECT_GE(k, 150U);
        EXPECT_LT(k, 250U);
        EXPECT_EQ(row.hypothesis, Hypothesis::surface);
        EXPECT_EQ(row.tested_axes, TestedAxes::vertical);
        EXPECT_GT(*row.statistic, *row.threshold);
        EXPECT_NEAR(*row.threshold, 5.4776, 1e-4);
        EXPECT_NEAR(*row.estimated.up_m, 0.9, 0.1);
        ++inside;
    }
    EXPECT_EQ(inside, found.rejected);
    for (std::size_t k = 150; k < 250; ++k)
        EXPECT_FALSE(screened.rows[k].usable) << k;
    // Without the surface the heights are only a step to and fro.
    const ScreenedTable alone = screen(table, config());
    EXPECT_TRUE(alone.rows[200].usable);
}

// At 3.29 standard deviations two of 2000 heights were marked by chance, where one recording in a
// thousand is promised to have any.
TEST(SurfaceCheck, TheFamilyWiseRateHoldsForAllHeightsTogether) {
    GroundBelow ground = strip(6100.0);
    ground.vertical_sd_m = 0.001;
    ground.tilt_max_deg = 0.0;
    std::int64_t rejected = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        rejected += screened_over(run_over_it(2000, seed), ground).basis.surface->rejected;
    EXPECT_EQ(rejected, 0);
}

TEST(SurfaceCheck, AConstantOffsetIsSaidAndMarksNothing) {
    EnuTable table = run_over_it(400);
    for (EnuEpoch& row : table.rows)
        *row.up_m -= 0.8;
    for (std::size_t k = 100; k < 120; ++k)
        *table.rows[k].up_m += 0.8;
    const ScreenedTable screened = screened_over(table, strip());
    const SurfaceComparison& found = *screened.basis.surface;
    EXPECT_TRUE(found.offset_removed);
    EXPECT_NEAR(found.offset_m, -0.8 * normal().z(), 0.01);
    // What differs from the rest is marked still: by this test, or by those of outliers.
    for (std::size_t k = 0; k < table.rows.size(); ++k)
        EXPECT_EQ(screened.rows[k].usable, k < 100 || k >= 120) << k;
}

TEST(SurfaceCheck, AHeightAboveTheGeoidIsNamedWithItsMetres) {
    EnuTable table = run_over_it(100);
    for (EnuEpoch& row : table.rows)
        *row.up_m += 36.4;
    GroundBelow ground = strip();
    ground.undulation_m = 0.5;
    const std::string text = refused(table, ground);
    EXPECT_TRUE(says(text, "attempt.yaml:9:9: the antenna is 36.4")) << text;
    EXPECT_TRUE(says(text, "heights above the geoid are taken for ellipsoidal ones"));
    EXPECT_TRUE(says(text, "undulation_m: 36.9")) << text;
}

TEST(SurfaceCheck, AnotherSurfaceIsRefused) {
    EnuTable table = run_over_it(100);
    for (EnuEpoch& row : table.rows)
        *row.north_m += 5000.0;
    const std::string elsewhere = refused(table, strip());
    EXPECT_TRUE(says(elsewhere,
                     "none of the 100 usable positions lies over the surface: its "
                     "nearest vertex is 5.0 km"))
        << elsewhere;
    // A hillside under a level run.
    table = run_over_it(100);
    for (std::size_t k = 0; k < 100; ++k)
        *table.rows[k].up_m += 0.1 * static_cast<double>(k);
    EXPECT_TRUE(says(refused(table, strip()), "not the surface that the craft ran on"));
    // One whose median fits, and most of it not.
    table = run_over_it(100);
    for (std::size_t k = 0; k < 100; ++k)
        *table.rows[k].up_m += 0.02 * (static_cast<double>(k) - 50.0);
    const std::string misfit = refused(table, strip());
    EXPECT_TRUE(says(misfit, "of 100 heights contradict the surface, by a scatter of 0.7"))
        << misfit;
    EXPECT_TRUE(says(misfit, "it is not the one that the craft ran on")) << misfit;
}

TEST(SurfaceCheck, OutsideOfTheSurfaceNothingIsSaid) {
    EnuTable table = run_over_it(400);
    for (std::size_t k = 200; k < 300; ++k)
        *table.rows[k].up_m += 0.5;
    const ScreenedTable screened = screened_over(table, strip(400.0));
    const SurfaceComparison& found = *screened.basis.surface;
    EXPECT_GT(found.outside, 250);
    EXPECT_EQ(found.compared + found.outside, 400);
    EXPECT_EQ(found.rejected, 0);
    table.facts.vertical_measured = false;
    for (EnuEpoch& row : table.rows) {
        row.up_m.reset();
        row.sigma_up_m.reset();
    }
    EXPECT_FALSE(screened_over(table, strip()).basis.surface);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
