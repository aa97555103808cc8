#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/failure.h"
#include "core/random.h"
#include "draws.h"
#include "surface/height_grid.h"

// The ground that earlier passes show, on a banked oval of 600 m straights and turns of 320 m
// radius, 30 m wide, whose ground is known.
namespace runcert::RUNCERT_FILE {
namespace {

constexpr double straight_m = 600.0, radius_m = 320.0, half_width_m = 15.0;
constexpr double turn_m = std::numbers::pi * radius_m;
constexpr double lap_m = 2.0 * (straight_m + turn_m);

/// A place on the oval: its centre line, the unit direction along it, and the bank there, which
/// rises outwards from 3 degrees on the straights to 14 in the turns.
struct OvalPlace {
    Eigen::Vector2d centre, along;
    double slope = 0.0;

    Eigen::Vector2d outwards() const { return {along.y(), -along.x()}; }
    Eigen::Vector3d ground(double offset_m) const {
        Eigen::Vector3d point;
        point << centre + offset_m * outwards(), 20.0 + offset_m * slope;
        return point;
    }
    /// Unit normal of the ground, but for how the bank changes along the way.
    Eigen::Vector3d normal() const {
        const Eigen::Vector2d level = -slope * outwards();
        return Eigen::Vector3d(level.x(), level.y(), 1.0).normalized();
    }
};

/// By how much of its bend a turn is entered, smoothly over 150 m, as `simulate`'s oval.
double bend_at(double along_m) {
    const double in_half = std::fmod(along_m, lap_m / 2.0);
    const auto rise = [](double x) {
        const double u = std::clamp(x / 150.0, 0.0, 1.0);
        return u * u * (3.0 - 2.0 * u);
    };
    return rise(in_half - straight_m + 75.0) - rise(in_half - lap_m / 2.0 + 75.0) +
           rise(75.0 - in_half);
}

/// Whether the oval is rolled out: its centre line straight, its bank as it is.
enum class Course { rolled_out, oval };

OvalPlace oval_at(double along_m, Course course) {
    const double bank_deg = 3.0 + 11.0 * bend_at(std::fmod(along_m, lap_m));
    const double slope = std::tan(Angle::from_degrees(bank_deg).radians());
    if (course == Course::rolled_out) return {{along_m, 0.0}, {1.0, 0.0}, slope};
    along_m = std::fmod(along_m, lap_m);
    const bool second = along_m >= lap_m / 2.0;
    const double in_half = second ? along_m - lap_m / 2.0 : along_m;
    const double turned = std::max(0.0, in_half - straight_m) / radius_m;
    OvalPlace place;
    place.along = {std::cos(turned), std::sin(turned)};
    place.centre = Eigen::Vector2d(std::min(in_half, straight_m) - straight_m / 2.0, -radius_m) +
                   radius_m * Eigen::Vector2d(std::sin(turned), 1.0 - std::cos(turned));
    if (second) {
        place.along = -place.along;
        place.centre = -place.centre;
    }
    place.slope = slope;
    return place;
}

/// Normal of the oval's ground by differences, with how its bank changes along the way.
Eigen::Vector3d ground_normal(double along_m, double offset_m) {
    constexpr double step = 0.5;
    const Eigen::Vector3d forth = oval_at(along_m + step, Course::oval).ground(offset_m) -
                                  oval_at(along_m + lap_m - step, Course::oval).ground(offset_m);
    const OvalPlace place = oval_at(along_m, Course::oval);
    const Eigen::Vector3d out = place.ground(offset_m + step) - place.ground(offset_m - step);
    return out.cross(forth).normalized();
}

struct PassErrors {
    double white_m = 0.0;
    double slow_m = 0.0;
    double slow_s = 10.0;
};

/// Positions at 10 Hz of passes of one lap each, whose lines lie evenly over the width (two passes:
/// side by side, 2.5 m apart) and weave a little; the antenna is 1.2 m above the ground.
std::vector<AntennaPosition> passes(int count, const PassErrors& errors, Course course,
                                    std::uint64_t seed) {
    constexpr double step_m = 7.5, step_s = 0.1, antenna_m = 1.2;
    RandomGenerator random(seed);
    std::vector<AntennaPosition> positions;
    for (int pass = 0; pass < count; ++pass) {
        const double line_m = count < 3 ? 2.5 * (pass - 0.5) : -13.0 + 26.0 * pass / (count - 1.0);
        const double weave_m = 300.0 + 200.0 * random.uniform();
        const double phase = 6.28 * random.uniform();
        const double kept = std::exp(-step_s / errors.slow_s);
        double slow_m = errors.slow_m * random.normal();
        for (double along = 0.0; along < lap_m; along += step_m) {
            const OvalPlace place = oval_at(along, course);
            const double offset = line_m + 1.5 * std::sin(phase + 6.28 * along / weave_m);
            slow_m = kept * slow_m + errors.slow_m * std::sqrt(1.0 - kept * kept) * random.normal();
            AntennaPosition& position = positions.emplace_back();
            position.enu_m = place.ground(offset) + antenna_m * place.normal();
            position.enu_m.z() += slow_m + errors.white_m * random.normal();
            position.direction = place.along;
            position.sigma_up_m = errors.white_m;
            position.antenna_height_m = antenna_m;
        }
    }
    return positions;
}

/// Root mean squares over the track's width, where the triangles are of some kind.
struct GroundErrors {
    double along_deg = 0.0, across_deg = 0.0, height_m = 0.0;
    double covered = 0.0;  ///< share of the places
};

GroundErrors errors_of(const HeightGrid& grid, bool supported_only, Course course) {
    const Triangulation surface(supported_only ? supported_part(grid) : grid.mesh);
    // Rolled out, the same triangles with the heights that the ground has at their corners.
    SurfaceMesh known = surface.mesh();
    for (Eigen::Vector3d& vertex : known.vertices)
        vertex.z() = oval_at(std::max(0.0, vertex.x()), Course::rolled_out).ground(-vertex.y()).z();
    const Triangulation truth(std::move(known));
    double along = 0.0, across = 0.0, height = 0.0, count = 0.0, all = 0.0;
    for (double s = 1.0; s < lap_m; s += 3.1)
        for (double offset = -half_width_m + 1.0; offset < half_width_m; offset += 1.3) {
            const OvalPlace place = oval_at(s, course);
            const Eigen::Vector3d ground = place.ground(offset);
            all += 1.0;
            const auto found = surface.at(ground.head<2>());
            if (!found) continue;
            const bool rolled_out = course == Course::rolled_out;
            const Eigen::Vector3d normal =
                rolled_out ? truth.normal_of(found->triangle) : ground_normal(s, offset);
            const double up_m = rolled_out ? truth.at(ground.head<2>())->up_m : ground.z();
            const Eigen::Vector3d error = found->normal - normal;
            along += std::pow(error.head<2>().dot(place.along), 2);
            across += std::pow(error.head<2>().dot(place.outwards()), 2);
            height += std::pow(found->up_m - up_m, 2);
            count += 1.0;
        }
    const auto degrees = [&](double sum) {
        return Angle::from_radians(std::sqrt(sum / count)).degrees();
    };
    return {degrees(along), degrees(across), std::sqrt(height / count), count / all};
}

GroundErrors mean_errors(int count, const PassErrors& errors, bool supported_only, Course course,
                         double spacing_m = HeightGridSettings{}.spacing_m) {
    GroundErrors mean;
    const int runs = draws({.daily = 4, .study = 24});
    for (int run = 0; run < runs; ++run) {
        const GroundErrors one = errors_of(
            fit_height_grid(passes(count, errors, course, static_cast<std::uint64_t>(run) + 1),
                            {.spacing_m = spacing_m}),
            supported_only, course);
        mean.along_deg += one.along_deg / runs;
        mean.across_deg += one.across_deg / runs;
        mean.height_m += one.height_m / runs;
        mean.covered += one.covered / runs;
    }
    return mean;
}

}  // namespace

// What earlier passes are worth on a grid of 10 m, from 2 to 20 of them, with white and
// time-correlated errors of 15 and 12 mm, or of 50 mm each: normals against those of the same
// triangles with true heights. The figures are of another simulation of such an oval, whose passes
// had lines of their own. Those decide for two passes: most of the width is extrapolated, and at 2,
// 4 and 8 m from each other heights err by 75, 47 and 23 mm. Here they are 2.5 m apart. More passes
// lie evenly here, which is better where errors last longer than a pass: by a factor of 1.9 across
// in the fourth row. Along the course the changing bank decides: entered within 100 m in place of
// 150, it makes normals along of the five rows 0.16, 0.05, 0.05, 0.08 and 0.06 degrees. Four draws
// tell the mean from one 1.6 times as large.
TEST(SurfaceOfPasses, AreWorthWhatTheirNumberAndNoiseSay) {
    struct Row {
        int count;
        PassErrors errors;
        double along_deg, across_deg, height_m;
    };
    const PassErrors small{.white_m = 0.015, .slow_m = 0.012},
        large{.white_m = 0.05, .slow_m = 0.05};
    for (const Row& row : {Row{2, small, 0.05, 0.48, 0.083}, Row{5, small, 0.03, 0.09, 0.013},
                           Row{20, small, 0.03, 0.10, 0.008}, Row{5, large, 0.04, 0.33, 0.051},
                           Row{20, large, 0.03, 0.12, 0.022}}) {
        SCOPED_TRACE(fmt::format("{} passes, {} m", row.count, row.errors.white_m));
        const GroundErrors found =
            mean_errors(row.count, row.errors, false, Course::rolled_out, 10.0);
        EXPECT_GT(found.height_m, row.height_m / 2.0);
        EXPECT_LT(found.height_m, row.height_m * 1.6);
        EXPECT_GT(found.across_deg, row.across_deg / 2.0);
        EXPECT_LT(found.across_deg, row.across_deg * 1.6);
        EXPECT_GT(found.along_deg, row.along_deg / 1.6);
        // What two passes extrapolate has the changing bank in it: 2.1 times in the mean.
        EXPECT_LT(found.along_deg, row.along_deg * (row.count == 2 ? 2.6 : 1.8));
        EXPECT_GT(found.covered, 0.9);
    }
}

// Of two passes what lies outside of them is left out, and what is left is as good as its height.
TEST(SurfaceOfPasses, WithoutPositionsOnBothSidesTrianglesAreLeftOut) {
    const PassErrors errors{.white_m = 0.015, .slow_m = 0.012};
    const GroundErrors all = mean_errors(2, errors, false, Course::rolled_out);
    const GroundErrors kept = mean_errors(2, errors, true, Course::rolled_out);
    EXPECT_LT(kept.height_m, 0.022);
    EXPECT_LT(kept.height_m, 0.6 * all.height_m);
    EXPECT_LT(kept.covered, 0.2);
    EXPECT_GT(mean_errors(5, errors, true, Course::rolled_out).covered, 0.85);
    // One line of positions has nothing on either side.
    std::vector<AntennaPosition> line;
    for (int i = 0; i < 200; ++i)
        line.push_back({.enu_m = {7.0 * i, 3.0, 1.0}});
    EXPECT_TRUE(supported_part(fit_height_grid(line)).triangles.empty());
}

// On the oval itself normals are bound by the triangles, however many passes there are: a flat one
// has one normal, and that of a banked turn turns along it. Smaller triangles are better, with
// heights no worse; a grid that followed the course would have flat triangles, too.
TEST(SurfaceOfPasses, OfAnOvalAreBoundByTheFacets) {
    const PassErrors errors{.white_m = 0.015, .slow_m = 0.012};
    for (const int count : {5, 20}) {
        SCOPED_TRACE(count);
        const GroundErrors wide = mean_errors(count, errors, true, Course::oval, 10.0);
        const GroundErrors found = mean_errors(count, errors, true, Course::oval);
        EXPECT_NEAR(wide.along_deg, 0.18, 0.02);
        EXPECT_NEAR(found.along_deg, 0.09, 0.01);
        EXPECT_NEAR(wide.across_deg, 0.175, 0.02);
        EXPECT_NEAR(found.across_deg, 0.105, 0.02);
        EXPECT_LT(found.height_m, wide.height_m);
        EXPECT_LT(found.height_m, 0.012);
        EXPECT_GT(found.covered, 0.85);
    }
}

// A plane is a plane: errors of rounding alone, the antenna's height taken off along its normal.
TEST(SurfaceOfPasses, APlaneIsFoundExactly) {
    std::vector<AntennaPosition> positions;
    const Eigen::Vector3d normal = Eigen::Vector3d(-0.2, 0.05, 1.0).normalized();
    for (int line = -3; line <= 3; ++line)
        for (int i = 0; i < 60; ++i) {
            const Eigen::Vector2d place(8.0 * i, 4.0 * line + 0.01 * i);
            positions.push_back(
                {.enu_m = Eigen::Vector3d(place.x(), place.y(),
                                          50.0 + 0.2 * place.x() - 0.05 * place.y()) +
                          2.0 * normal,
                 .antenna_height_m = 2.0});
        }
    const HeightGrid grid = fit_height_grid(positions);
    const Triangulation surface(supported_part(grid));
    ASSERT_FALSE(surface.mesh().triangles.empty());
    for (std::size_t t = 0; t < surface.mesh().triangles.size(); ++t)
        EXPECT_LT((surface.normal_of(t) - normal).norm(), 1e-5);
    EXPECT_NEAR(surface.at({200.0, 5.0})->up_m, 50.0 + 40.0 - 0.25, 1e-4);
    EXPECT_LT(grid.residual_m, 1e-4);
}

TEST(SurfaceOfPasses, TooFewPositionsOrRunsAllOverTheCountryAreRefused) {
    std::vector<AntennaPosition> positions(5);
    EXPECT_THROW(fit_height_grid(positions), Failure);
    positions.resize(20);
    for (std::size_t i = 0; i < positions.size(); ++i)
        positions[i].enu_m = {static_cast<double>(i % 5) * 1e5, static_cast<double>(i / 5) * 1e5,
                              0};
    EXPECT_THROW(fit_height_grid(positions), Failure);
}

}  // namespace runcert::RUNCERT_FILE
