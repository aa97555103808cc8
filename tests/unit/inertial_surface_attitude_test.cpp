#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "core/failure.h"
#include "core/random.h"
#include "inertial/surface_attitude.h"

// The attitude of a craft by the surface below it and its velocity, and where [FHB03] prints it
// otherwise.
namespace runcert::RUNCERT_FILE {
namespace {

constexpr double rad = radians_per_degree;
constexpr double deg = degrees_per_radian;

/// A triangle with a bank of 14 degrees and a velocity along it.
struct Example {
    Eigen::Vector3d normal, velocity{3.0, 70.0, 1.9};
    Example() {
        const Eigen::Vector3d a(10.0, 0.0, 10.0 * std::tan(14.0 * rad)), b(0.0, 10.0, 0.2);
        normal = a.cross(b).normalized();
    }
    Eigen::Matrix3d enu_from_body() const { return *attitude_on_surface({normal, velocity}); }
};

std::string problem_of(const SurfaceMotion& motion) {
    try {
        attitude_on_surface(motion);
    } catch (const Failure& failure) {
        EXPECT_EQ(failure.where(), "surface");
        EXPECT_FALSE(failure.remedy().empty());
        return failure.problem();
    }
    return "";
}

TEST(SurfaceAttitude, AnglesOfATriangleAndAVelocity) {
    const Example example;
    EXPECT_NEAR(example.normal.x(), -0.24187636, 1e-8);
    EXPECT_NEAR(example.normal.y(), -0.01940226, 1e-8);
    EXPECT_NEAR(example.normal.z(), 0.97011308, 1e-8);
    const EulerAngles angles = euler_angles(example.enu_from_body());
    EXPECT_NEAR(angles.roll * deg, -13.936612, 1e-6);
    EXPECT_NEAR(angles.pitch * deg, 1.744234, 1e-6);
    EXPECT_NEAR(angles.heading * deg, 2.406649, 1e-6);
}

TEST(SurfaceAttitude, IsExactForEveryAttitude) {
    RandomGenerator random(1);
    double most_deg = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const EulerAngles angles{.roll = 36.0 * rad * (2.0 * random.uniform() - 1.0),
                                 .pitch = 6.0 * rad * (2.0 * random.uniform() - 1.0),
                                 .heading = 2.0 * std::numbers::pi * random.uniform()};
        const Eigen::Matrix3d c = rotation_of(angles);
        const Eigen::Vector3d normal = -c.col(2);
        // A velocity that does not lie in the surface counts by the part that does.
        const Eigen::Vector3d velocity =
            (5.0 + 80.0 * random.uniform()) * c.col(0) + random.normal() * normal;
        const auto found = attitude_on_surface({normal, velocity});
        ASSERT_TRUE(found);
        EXPECT_LT((*found - c).norm(), 1e-13);
        const EulerAngles back = euler_angles(*found);
        most_deg = std::max(
            {most_deg, std::abs(back.roll - angles.roll) * deg,
             std::abs(back.pitch - angles.pitch) * deg,
             std::abs(std::remainder(back.heading - angles.heading, 2.0 * std::numbers::pi)) *
                 deg});
    }
    EXPECT_LT(most_deg, 1e-9);
}

// The printed angles are those of the right axis.
TEST(SurfaceAttitude, ThePrintedAnglesDiffer) {
    const auto beta_deg = [](const Eigen::Matrix3d& c) { return std::asin(c(2, 1)) * deg; };
    const auto gamma_deg = [](const Eigen::Matrix3d& c) {
        return std::atan2(c(0, 1), c(1, 1)) * deg;
    };
    const Eigen::Matrix3d example = Example().enu_from_body();
    EXPECT_NEAR(beta_deg(example), 13.930024, 1e-6);   // the roll is -13.936612
    EXPECT_NEAR(gamma_deg(example), 92.839412, 1e-6);  // the heading is 2.406649
    // Arguments in the order of a spreadsheet: minus the heading, and no better.
    EXPECT_NEAR(std::atan2(example(1, 1), example(0, 1)) * deg, -2.839412, 1e-6);
    struct Case {
        double roll_deg, pitch_deg, heading_error_deg, roll_error_deg;
    };
    for (const Case& one :
         {Case{14.0, 1.0, 0.25, 0.00}, Case{31.0, 2.0, 1.20, 0.02}, Case{36.0, 3.0, 2.18, 0.06},
          Case{36.0, 6.0, 4.34, 0.23}, Case{14.0, 0.0, 0.0, 0.0}}) {
        const double roll = one.roll_deg * rad, pitch = one.pitch_deg * rad;
        const Eigen::Matrix3d c =
            rotation_of({.roll = roll, .pitch = pitch, .heading = 50.0 * rad});
        EXPECT_NEAR(std::abs(gamma_deg(c) - 140.0), one.heading_error_deg, 0.006);
        EXPECT_NEAR(std::abs(gamma_deg(c) - 140.0),
                    std::atan(std::tan(roll) * std::sin(pitch)) * deg, 1e-9);
        EXPECT_NEAR(one.roll_deg + beta_deg(c), one.roll_error_deg, 0.006);
        EXPECT_NEAR(std::sin(beta_deg(c) * rad), -std::cos(pitch) * std::sin(roll), 1e-14);
        // With the sign as printed the roll is on the other side.
        EXPECT_NEAR(beta_deg(c) - one.roll_deg, -2.0 * one.roll_deg, 0.3);
    }
    // R_3[-90 degrees] of the axes gives the left axis; of the vector, the right.
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(-90.0 * rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    const Eigen::Vector3d ahead(0.0, 1.0, 0.0);
    EXPECT_LT((turn * ahead - Eigen::Vector3d::UnitX()).norm(), 1e-15);
    EXPECT_LT((turn.transpose() * ahead + Eigen::Vector3d::UnitX()).norm(), 1e-15);
}

// R_l^p where R_p^l is meant: the pitch vector leaves the surface.
TEST(SurfaceAttitude, ThePrintedTurnOfThePitchVectorLeavesTheSurface) {
    const Example example;
    Eigen::Matrix3d enu_from_plane;  // its first axis is along the edge that rises
    enu_from_plane.col(2) = example.normal;
    enu_from_plane.col(0) = Eigen::Vector3d(10.0, 0.0, 10.0 * std::tan(14.0 * rad)).normalized();
    enu_from_plane.col(1) = example.normal.cross(enu_from_plane.col(0));
    Eigen::Vector3d in_plane = enu_from_plane.transpose() * example.velocity;
    in_plane.z() = 0.0;
    const Eigen::Vector3d meant = enu_from_plane * in_plane.normalized();
    const Eigen::Vector3d printed = enu_from_plane.transpose() * in_plane.normalized();
    EXPECT_LT((meant - example.enu_from_body().col(0)).norm(), 1e-14);
    EXPECT_NEAR(std::asin(meant.z()) * deg, 1.744234, 1e-6);
    EXPECT_GT(std::abs(printed.dot(example.normal)), 0.01);
}

TEST(SurfaceAttitude, SlowMotionGivesNone) {
    const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    EXPECT_FALSE(attitude_on_surface({up, {0.0, 4.99, 0.0}}));
    EXPECT_FALSE(attitude_on_surface({up, {0.0, 0.0, 50.0}}));
    EXPECT_FALSE(attitude_on_surface({up, {0.0, 0.0, 0.0}}, 0.0));
    EXPECT_TRUE(attitude_on_surface({up, {0.0, 5.01, 0.0}}));
    EXPECT_NE(problem_of({-up, {0.0, 20.0, 0.0}}).find("upwards"), std::string::npos);
    EXPECT_NE(problem_of({up, {0.0, std::nan(""), 0.0}}).find("finite"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
