#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/statistics.h"
#include "simulation/course_surface.h"
#include "simulation/craft_motion.h"

// The ground along a simulated course.

namespace runcert::RUNCERT_FILE {
namespace {

SimulationSpec ground_spec(CraftCourse course) {
    SimulationSpec spec;
    spec.run = {.top_speed_m_s = 60.0,
                .start_speed_m_s = 0.1,
                .half_speed_time_s = 10.0,
                .duration_s = 45.0,
                .rate_hz = 10,
                .bearing_deg = 62.0,
                .start = {.east_m = 30.0, .north_m = -20.0, .up_m = 2.0}};
    spec.place = Geodetic{Angle::from_degrees(-31.6), Angle::from_degrees(136.0), 110.0};
    spec.start_gps = parse_gps_iso("2026-03-14T03:20:18.000");
    spec.craft = {.course = course, .antenna = {0.0, 0.0, -1.0}};
    spec.surface = {.width_m = 30.0, .spacing_m = 10.0, .vertical_sd_m = 0.0, .below_m = 0.5};
    return spec;
}

/// The triangle over or under a place, by trying all.
const std::array<std::size_t, 3>* triangle_at(const CourseSurface& surface,
                                              const Eigen::Vector3d& place_m) {
    for (const auto& triangle : surface.triangles) {
        bool inside = true;
        for (std::size_t k = 0; k < 3; ++k) {
            const Eigen::Vector3d& a = surface.vertices_m[triangle[k]];
            const Eigen::Vector3d& b = surface.vertices_m[triangle[(k + 1) % 3]];
            const Eigen::Vector3d edge = b - a, to = place_m - a;
            inside = inside && edge.x() * to.y() - edge.y() * to.x() >= -1e-9;
        }
        if (inside) return &triangle;
    }
    return nullptr;
}

Eigen::Vector3d normal_of(const CourseSurface& surface,
                          const std::array<std::size_t, 3>& triangle) {
    const Eigen::Vector3d& a = surface.vertices_m[triangle[0]];
    return (surface.vertices_m[triangle[1]] - a)
        .cross(surface.vertices_m[triangle[2]] - a)
        .normalized();
}

TEST(SimulatedSurface, LiesLevelUnderALake) {
    const SimulationSpec spec = ground_spec(CraftCourse::straight);
    const CourseSurface surface = simulate_surface(spec);
    for (const Eigen::Vector3d& vertex_m : surface.vertices_m)
        EXPECT_NEAR(vertex_m.z(), 1.5, 1e-6);
    for (const auto& triangle : surface.triangles)
        EXPECT_NEAR(normal_of(surface, triangle).z(), 1.0, 1e-9);
    for (const SimulatedEpoch& epoch : simulate(spec))
        EXPECT_NE(triangle_at(surface, epoch.true_enu_m), nullptr) << epoch.time_s();
    // Half the width to either side, and not beyond.
    const Eigen::Vector3d aside(std::cos(62.0 * radians_per_degree),
                                -std::sin(62.0 * radians_per_degree), 0.0);
    const Eigen::Vector3d middle_m = simulate(spec)[300].true_enu_m;
    for (const double side : {-1.0, 1.0}) {
        EXPECT_NE(triangle_at(surface, middle_m + side * 14.99 * aside), nullptr);
        EXPECT_EQ(triangle_at(surface, middle_m + side * 15.01 * aside), nullptr);
    }
}

TEST(SimulatedSurface, LeansUnderAnOvalAsTheCraftOnIt) {
    const SimulationSpec spec = ground_spec(CraftCourse::oval);
    const CourseSurface surface = simulate_surface(spec);
    int straights = 0, turns = 0;
    for (const SimulatedEpoch& epoch : simulate(spec)) {
        const CraftTruth& craft = epoch.craft.value();
        const auto* triangle = triangle_at(surface, craft.reference_point_m);
        ASSERT_NE(triangle, nullptr) << epoch.time_s();
        const Eigen::Vector3d normal = normal_of(surface, *triangle);
        // Triangles of 10 m lie 4 cm beside an arc of 320 m radius, and so 1 cm off. Where the bank
        // changes, by up to 1.4 degrees in 10 m, their edges cut across a twisted strip.
        const double at_m = epoch.truth.distance_m;
        const bool steady = at_m < 580.0 || (at_m > 760.0 && at_m < 1595.0);
        const double above_m =
            normal.dot(craft.reference_point_m - surface.vertices_m[(*triangle)[0]]);
        EXPECT_NEAR(above_m, 0.5, steady ? 0.02 : 0.07) << epoch.time_s();
        const Eigen::Vector3d v = craft.reference_velocity_m_s.normalized();
        const double bank_deg =
            std::asin(normal.dot(Eigen::Vector3d(-v.y(), v.x(), 0.0))) * degrees_per_radian;
        if (at_m < 580.0) {
            ++straights;
            EXPECT_NEAR(bank_deg, 3.0, 0.01);
        } else if (steady) {
            ++turns;
            EXPECT_NEAR(bank_deg, 14.0, 0.1);
            // The body leans out by half a degree for each g; the rest of its roll is the ground's.
            const double lateral = epoch.truth.speed_m_s * epoch.truth.speed_m_s / 320.0;
            EXPECT_NEAR(craft.attitude.roll * degrees_per_radian - 0.5 * lateral / 9.81, -bank_deg,
                        0.1);
        }
    }
    EXPECT_GT(straights, 100);
    EXPECT_GT(turns, 100);
}

TEST(SimulatedSurface, IsOfOneLapAndFacesUp) {
    SimulationSpec spec = ground_spec(CraftCourse::oval);
    spec.run.duration_s = 120.0;
    const CourseSurface surface = simulate_surface(spec);
    double area_m2 = 0.0;
    for (const auto& triangle : surface.triangles) {
        const Eigen::Vector3d& a = surface.vertices_m[triangle[0]];
        const Eigen::Vector3d cross =
            (surface.vertices_m[triangle[1]] - a).cross(surface.vertices_m[triangle[2]] - a);
        EXPECT_GT(cross.z(), 0.0);
        area_m2 += 0.5 * cross.norm();
    }
    // One lap of 1200 m of straights and 2310.6 m of turns, less the 50 m that are left open and
    // with 40 m beyond both ends; chords of an arc of 320 m radius are a little shorter than it.
    EXPECT_NEAR(oval_lap_m, 3510.6, 0.1);
    EXPECT_NEAR(area_m2 / 30.0, oval_lap_m - 50.0 + 40.0, 10.0);
    std::vector<Eigen::Vector3d> ends{surface.vertices_m.front(), surface.vertices_m.back()};
    EXPECT_GT((ends[0] - ends[1]).norm(), 5.0);
}

TEST(SimulatedSurface, HasTheErrorsOfASurvey) {
    SimulationSpec spec = ground_spec(CraftCourse::straight);
    const CourseSurface exact = simulate_surface(spec);
    spec.surface->vertical_sd_m = 0.05;
    const CourseSurface surveyed = simulate_surface(spec);
    ASSERT_EQ(surveyed.vertices_m.size(), exact.vertices_m.size());
    std::vector<double> errors_m;
    for (std::size_t i = 0; i < exact.vertices_m.size(); ++i) {
        const Eigen::Vector3d off_m = surveyed.vertices_m[i] - exact.vertices_m[i];
        EXPECT_EQ(off_m.head<2>().norm(), 0.0);
        errors_m.push_back(off_m.z());
    }
    ASSERT_GT(errors_m.size(), 800U);  // which know a standard deviation to 2.5 %
    EXPECT_NEAR(standard_deviation(errors_m), 0.05, 0.005);
    EXPECT_NEAR(mean(errors_m), 0.0, 0.007);
}

TEST(SimulatedSurface, IsWrittenNorthBeforeEast) {
    const CourseSurface surface{.vertices_m = {{1.0, 2.0, 3.0}, {4.0, 2.5, 3.0}, {1.0, 5.0, -0.25}},
                                .triangles = {{0, 1, 2}}};
    const std::string text = landxml_text(surface, parse_gps_iso("2026-03-14T03:20:18.000"));
    for (const char* part : {"date=\"2026-03-14\" time=\"03:20:18\"", "linearUnit=\"meter\"",
                             "surfType=\"TIN\"", "<P id=\"1\">2.0000 1.0000 3.0000</P>",
                             "<P id=\"3\">5.0000 1.0000 -0.2500</P>", "<F>1 2 3</F>", "simulated"})
        EXPECT_NE(text.find(part), std::string::npos) << part << text;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
