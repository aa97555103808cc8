#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <ctime>
#include <numbers>

#include "core/random.h"
#include "surface/triangulation.h"

// Triangles against brute force, planes that are known, and the worked example of section 3 of the
// method's surface attitude.
namespace runcert::RUNCERT_FILE {
namespace {

/// A field of `side` by `side` squares of 10 m, each of two triangles, over a function of plan.
template <class Height>
SurfaceMesh field(std::uint32_t side, const Height& height) {
    SurfaceMesh mesh;
    for (std::uint32_t row = 0; row <= side; ++row)
        for (std::uint32_t column = 0; column <= side; ++column) {
            const double x = 10.0 * column, y = 10.0 * row;
            mesh.vertices.emplace_back(x, y, height(x, y));
        }
    for (std::uint32_t row = 0; row < side; ++row)
        for (std::uint32_t column = 0; column < side; ++column) {
            const std::uint32_t corner = row * (side + 1) + column;
            mesh.triangles.push_back({corner, corner + 1, corner + side + 2});
            mesh.triangles.push_back({corner, corner + side + 2, corner + side + 1});
        }
    return mesh;
}

/// Every triangle looked at, in order.
std::optional<std::size_t> holding(const SurfaceMesh& mesh, const Eigen::Vector2d& place) {
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Eigen::Matrix3d corners;
        for (Eigen::Index i = 0; i < 3; ++i)
            corners.col(i)
                << mesh.vertices[mesh.triangles[t][static_cast<std::size_t>(i)]].head<2>(),
                1.0;
        const Eigen::Vector3d weights =
            corners.inverse() * Eigen::Vector3d(place.x(), place.y(), 1.0);
        if (weights.minCoeff() >= -1e-9) return t;
    }
    return std::nullopt;
}

}  // namespace

TEST(Triangulation, GivesPlaneNormalAndDistanceOfAnAnalyticPlane) {
    const double bank = 14.0 * std::numbers::pi / 180.0;
    const auto plane = [&](double x, double y) { return 5.0 + x * std::tan(bank) + 0.01 * y; };
    const Triangulation surface(field(20, plane));
    const Eigen::Vector3d normal = Eigen::Vector3d(-std::tan(bank), -0.01, 1.0).normalized();
    RandomGenerator random(3);
    int measured = 0;
    for (int i = 0; i < 1000; ++i) {
        const Eigen::Vector2d place(200.0 * random.uniform(), 200.0 * random.uniform());
        const auto ground = surface.at(place);
        ASSERT_TRUE(ground);
        EXPECT_NEAR(ground->up_m, plane(place.x(), place.y()), 1e-9);
        EXPECT_LT((ground->normal - normal).norm(), 1e-12);
        EXPECT_NEAR(ground->weights.sum(), 1.0, 1e-12);
        // A point above the plane along its normal is so far from it.
        const Eigen::Vector3d above =
            Eigen::Vector3d(place.x(), place.y(), ground->up_m) + 1.25 * normal;
        const auto distance = surface.normal_distance_m(above);
        EXPECT_NEAR(distance.value_or(1.25), 1.25, 1e-9);
        measured += distance ? 1 : 0;
    }
    EXPECT_GT(measured, 990);
    EXPECT_FALSE(surface.at({-0.1, 50.0}));
    EXPECT_FALSE(surface.at({50.0, 200.1}));
    EXPECT_FALSE(surface.normal_distance_m({300.0, 300.0, 5.0}));
}

TEST(Triangulation, NormalOfTheWorkedExample) {
    SurfaceMesh mesh;
    const double slope = std::tan(14.0 * std::numbers::pi / 180.0);
    mesh.vertices = {{0, 0, 10}, {10, 0, 10 + 10 * slope}, {0, 10, 10.2}};
    mesh.triangles = {{0, 1, 2}};
    const Eigen::Vector3d normal = Triangulation(mesh).normal_of(0);
    EXPECT_NEAR(normal.x(), -0.24187636, 1e-8);
    EXPECT_NEAR(normal.y(), -0.01940226, 1e-8);
    EXPECT_NEAR(normal.z(), 0.97011308, 1e-8);
}

TEST(Triangulation, FindsWhatBruteForceFindsAndOnAnEdgeTheLowerNumber) {
    RandomGenerator random(11);
    SurfaceMesh mesh =
        field(12, [](double x, double y) { return std::sin(0.02 * x) * std::cos(0.03 * y); });
    // Irregular triangles, in no order, with holes.
    for (Eigen::Vector3d& vertex : mesh.vertices)
        vertex.head<2>() += Eigen::Vector2d(3.0 * random.uniform(), 3.0 * random.uniform());
    for (std::size_t t = mesh.triangles.size() - 1; t > 0; --t)
        std::swap(mesh.triangles[t],
                  mesh.triangles[static_cast<std::size_t>(random.uniform() * 0.999999 *
                                                          static_cast<double>(t + 1))]);
    mesh.triangles.resize(mesh.triangles.size() * 9 / 10);
    const Triangulation surface(mesh);
    int inside = 0;
    for (int i = 0; i < 3000; ++i) {
        const Eigen::Vector2d place(140.0 * random.uniform() - 10.0,
                                    140.0 * random.uniform() - 10.0);
        const auto ground = surface.at(place);
        const auto expected = holding(mesh, place);
        ASSERT_EQ(ground.has_value(), expected.has_value()) << i;
        if (!ground) continue;
        EXPECT_EQ(ground->triangle, *expected);
        ++inside;
    }
    EXPECT_GT(inside, 2000);
    // Corners, and points on edges, are in several: the lowest number is taken.
    for (const Corners& corners : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::Vector2d a = mesh.vertices[corners[i]].head<2>();
            const Eigen::Vector2d b = mesh.vertices[corners[(i + 1) % 3]].head<2>();
            for (const Eigen::Vector2d& place : {a, Eigen::Vector2d(0.5 * (a + b))}) {
                const auto ground = surface.at(place);
                ASSERT_TRUE(ground);
                EXPECT_EQ(ground->triangle, *holding(mesh, place));
            }
        }
}

TEST(Triangulation, TrianglesOfVeryDifferentSizesNeedNoMoreCellsThanTriangles) {
    SurfaceMesh mesh = field(10, [](double, double) { return 0.0; });
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(200.0, 0.0, 1.0);
    mesh.vertices.emplace_back(1.0e6, 0.0, 1.0);
    mesh.vertices.emplace_back(1.0e6, 1.0e6, 1.0);
    mesh.triangles.push_back({first, first + 1, first + 2});
    EXPECT_LT(PlanGrid(mesh).cells(), 20 * mesh.triangles.size());
    const Triangulation surface(mesh);
    EXPECT_EQ(surface.at({5.0e5, 1.0e5})->triangle, mesh.triangles.size() - 1);
    EXPECT_EQ(surface.at({95.0, 91.0})->triangle, 2 * 99U);
    EXPECT_FALSE(Triangulation(SurfaceMesh{}).at({0.0, 0.0}));
}

// What METHOD.md says of the surface as a measurement of a float solution: linear least squares of
// a prior (0.5 m horizontally, 1 m in height) and one distance along the normal, good to 10 cm.
TEST(NormalConstraint, AsAMeasurementImprovesTheHeightAndNoHorizontalSpeed) {
    const double bank = 14.0 * std::numbers::pi / 180.0;
    const Eigen::Vector3d normal(-std::sin(bank), 0.0, std::cos(bank));
    const Eigen::Matrix3d prior = Eigen::Vector3d(0.25, 0.25, 1.0).asDiagonal();
    const Eigen::Matrix3d after =
        (prior.inverse() + normal * normal.transpose() / (0.10 * 0.10)).inverse();
    EXPECT_NEAR(std::sqrt(normal.dot(prior * normal)), 0.98, 0.005);
    EXPECT_NEAR(std::sqrt(normal.dot(after * normal)), 0.10, 0.005);
    EXPECT_NEAR(std::sqrt(after(2, 2)), 0.16, 0.005);
    EXPECT_NEAR(std::sqrt(after(0, 0)), 0.496, 0.0005);
    EXPECT_NEAR(std::sqrt(after(1, 1)), 0.5, 1e-12);
    EXPECT_NEAR(3.29 * 0.10, 0.33, 0.005);
    EXPECT_NEAR(4.132 * 0.10, 0.41, 0.005);
    EXPECT_NEAR(std::sin(bank), 0.24, 0.005);
}

TEST(OverlappingTriangles, AreNamedAndNeighboursAreNot) {
    SurfaceMesh mesh = field(6, [](double x, double) { return 0.1 * x; });
    EXPECT_FALSE(overlapping_triangles(mesh));
    // Neighbours that do not share their vertices, rounded to a millimetre.
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(60.0, 0.0, 6.0);
    mesh.vertices.emplace_back(70.0, 0.0, 7.0);
    mesh.vertices.emplace_back(59.9995, 10.0, 6.0);
    mesh.triangles.push_back({first, first + 1, first + 2});
    EXPECT_FALSE(overlapping_triangles(mesh));
    // A bridge over the field.
    mesh.vertices[first + 2].x() = 59.5;
    EXPECT_EQ(overlapping_triangles(mesh), (std::pair<std::size_t, std::size_t>(10, 72)));
    // The same triangle twice.
    mesh.vertices[first + 2].x() = 60.0;
    mesh.triangles.push_back(mesh.triangles[3]);
    EXPECT_EQ(overlapping_triangles(mesh), (std::pair<std::size_t, std::size_t>(3, 73)));
}

TEST(DegenerateTriangles, HaveNoAreaInPlan) {
    SurfaceMesh mesh;
    mesh.vertices = {{0, 0, 0}, {10, 0, 0}, {20, 0, 3}, {10, 1e-3, 0}, {0, 0, 5}};
    EXPECT_TRUE(is_degenerate(mesh, {0, 1, 2}));
    EXPECT_TRUE(is_degenerate(mesh, {0, 1, 1}));
    EXPECT_TRUE(is_degenerate(mesh, {0, 1, 4}));
    EXPECT_FALSE(is_degenerate(mesh, {0, 2, 3}));
    EXPECT_GT(twice_area_in_plan(mesh, {0, 2, 3}), 0.0);
    EXPECT_LT(twice_area_in_plan(mesh, {0, 3, 2}), 0.0);
}

TEST(Triangulation, AMillionTrianglesAreLookedThroughInSeconds) {
    const SurfaceMesh mesh = field(708, [](double x, double y) { return 1e-4 * x * y; });
    ASSERT_GT(mesh.triangles.size(), 1'000'000U);
    const std::clock_t before = std::clock();
    EXPECT_FALSE(overlapping_triangles(mesh));
    const Triangulation surface(mesh);
    RandomGenerator random(5);
    for (int i = 0; i < 100'000; ++i)
        ASSERT_TRUE(surface.at({7080.0 * random.uniform(), 7080.0 * random.uniform()}));
    EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 20.0);
}

}  // namespace runcert::RUNCERT_FILE
