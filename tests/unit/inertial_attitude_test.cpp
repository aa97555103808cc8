#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "core/angle.h"
#include "core/random.h"
#include "inertial/alignment.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double pi = std::numbers::pi;

Eigen::Vector3d any_vector(RandomGenerator& random) {
    return {random.normal(), random.normal(), random.normal()};
}

Eigen::Matrix3d any_rotation(RandomGenerator& random) {
    return rotation_about(pi * (2.0 * random.uniform() - 1.0) * any_vector(random).normalized());
}

double difference(double a, double b) {
    return std::remainder(a - b, 2.0 * pi);
}

TEST(Attitude, AnglesGoThereAndBack) {
    RandomGenerator random(1);
    double most = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const EulerAngles angles{.roll = pi * (2.0 * random.uniform() - 1.0),
                                 .pitch = 0.5 * pi * (1.998 * random.uniform() - 0.999),
                                 .heading = 2.0 * pi * random.uniform()};
        const Eigen::Matrix3d c = rotation_of(angles);
        EXPECT_NEAR((c.transpose() * c - Eigen::Matrix3d::Identity()).norm(), 0.0, 1e-14);
        EXPECT_NEAR(c.determinant(), 1.0, 1e-14);
        const EulerAngles back = euler_angles(c);
        most = std::max({most, std::abs(difference(back.roll, angles.roll)),
                         std::abs(back.pitch - angles.pitch),
                         std::abs(difference(back.heading, angles.heading))});
        EXPECT_GE(back.heading, 0.0);
        EXPECT_LT(back.heading, 2.0 * pi);
    }
    EXPECT_LT(most * degrees_per_radian, 1e-9);
}

TEST(Attitude, RotationsGoThereAndBackByAngles) {
    RandomGenerator random(2);
    double most = 0.0;
    for (int i = 0; i < 20'000; ++i) {
        const Eigen::Matrix3d c = any_rotation(random);
        most = std::max(most, (rotation_of(euler_angles(c)) - c).norm());
    }
    // Steep pitches too: their roll and heading are uncertain, their rotation is not.
    for (const double pitch : {0.5 * pi, -0.5 * pi, 0.5 * pi - 1e-7}) {
        const Eigen::Matrix3d c = rotation_of({.roll = 0.3, .pitch = pitch, .heading = 1.0});
        EXPECT_LT((rotation_of(euler_angles(c)) - c).norm(), 1e-6) << pitch;
    }
    EXPECT_LT(most, 1e-12);
}

// What each angle means, axis by axis.
TEST(Attitude, EachAngleTurnsTheCraftAsItIsDefined) {
    const Eigen::Vector3d forward(1, 0, 0), right(0, 1, 0), down(0, 0, 1);
    const Eigen::Matrix3d level = rotation_of({});
    EXPECT_LT((level * forward - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);  // north
    EXPECT_LT((level * right - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);    // east
    EXPECT_LT((level * down - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15);
    EXPECT_LT((rotation_of({.roll = 0.2}) * right).z(), 0.0);       // right side down
    EXPECT_GT((rotation_of({.pitch = 0.2}) * forward).z(), 0.0);    // nose up
    EXPECT_GT((rotation_of({.heading = 0.2}) * forward).x(), 0.0);  // towards east
}

TEST(Attitude, JacobianOfAnglesIsThatOfDifferences) {
    RandomGenerator random(3);
    for (int i = 0; i < 200; ++i) {
        const Eigen::Matrix3d c = rotation_of({.roll = 3.0 * (random.uniform() - 0.5),
                                               .pitch = 2.4 * (random.uniform() - 0.5),
                                               .heading = 1.0 + 5.0 * random.uniform()});
        const Eigen::Matrix3d analytic = euler_jacobian(c);
        for (int axis = 0; axis < 3; ++axis) {
            constexpr double h = 1e-5;
            const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(axis);
            const EulerAngles plus = euler_angles(rotation_about(step) * c);
            const EulerAngles minus = euler_angles(rotation_about(-step) * c);
            const Eigen::Vector3d numeric(difference(plus.roll, minus.roll),
                                          difference(plus.pitch, minus.pitch),
                                          difference(plus.heading, minus.heading));
            EXPECT_LT((numeric / (2.0 * h) - analytic.col(axis)).norm(), 1e-6) << i;
        }
    }
}

TEST(Attitude, RotationVectorsGoThereAndBack) {
    RandomGenerator random(4);
    for (const double size : {0.0, 1e-13, 1e-9, 1e-5, 9.9e-5, 1.1e-4, 0.1, 1.0, 3.0, 3.1415}) {
        const Eigen::Vector3d phi = size * any_vector(random).normalized();
        EXPECT_LT((rotation_vector(rotation_about(phi)) - phi).norm(), 1e-11 + 1e-15 * size)
            << size;
        const Eigen::Matrix3d c = rotation_about(phi);
        EXPECT_LT((c.transpose() * c - Eigen::Matrix3d::Identity()).norm(), 1e-14) << size;
    }
}

TEST(Attitude, NearestRotationLeavesRotationsAndMeansThem) {
    RandomGenerator random(5);
    const Eigen::Matrix3d c = any_rotation(random);
    EXPECT_LT((nearest_rotation(3.0 * c) - c).norm(), 1e-14);
    const Eigen::Vector3d phi(0.1, -0.2, 0.05);
    EXPECT_LT((nearest_rotation(rotation_about(phi) * c + rotation_about(-phi) * c) - c).norm(),
              1e-14);
    EXPECT_NEAR(nearest_rotation(Eigen::Vector3d(1.0, 1.0, -0.1).asDiagonal()).determinant(), 1.0,
                1e-14);
}

// Wahba's problem: directions without error give the rotation, and errors of the stated size a
// scatter of the stated covariance.
TEST(Attitude, DirectionsGiveTheRotationAndItsCovariance) {
    RandomGenerator random(6);
    Eigen::Matrix3d normalised = Eigen::Matrix3d::Zero();
    constexpr int runs = 2'000;
    for (int i = 0; i < runs; ++i) {
        const Eigen::Matrix3d c = any_rotation(random);
        const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
        const Eigen::Vector3d ahead = Eigen::Vector3d(random.normal(), random.normal(), 0.0);
        const Eigen::Vector3d right = ahead.cross(up);
        // Gravity to 0.02 rad about both horizontal axes, a course to 0.05 about the vertical one.
        const Eigen::Matrix3d of_gravity =
            information_about(ahead, 0.02) + information_about(right, 0.02);
        const Eigen::Matrix3d of_course = information_about(up, 0.05);
        const auto solved = [&](const Eigen::Vector3d& tilt, double turn) {
            return attitude_by_directions(std::array{
                DirectionPair{c.transpose() * up, 9.8 * rotation_about(tilt) * up, of_gravity},
                DirectionPair{5.0 * c.transpose() * ahead, rotation_about(turn * up) * ahead,
                              of_course}});
        };
        const auto exact = solved(Eigen::Vector3d::Zero(), 0.0);
        ASSERT_TRUE(exact);
        EXPECT_LT((exact->enu_from_body - c).norm(), 1e-9);
        const Eigen::Vector3d tilt(0.02 * random.normal(), 0.02 * random.normal(), 0.0);
        const auto found = solved(tilt, 0.05 * random.normal());
        ASSERT_TRUE(found);
        const Eigen::Vector3d error = rotation_vector(c * found->enu_from_body.transpose());
        const Eigen::Vector3d white = found->covariance_rad2.llt().matrixL().solve(error);
        normalised += white * white.transpose() / runs;
    }
    EXPECT_LT((normalised - Eigen::Matrix3d::Identity()).norm(), 0.2) << normalised;
}

// Of three directions with equal weights the answer is the rotation nearest to their sum (Kabsch).
TEST(Attitude, EqualWeightsGiveTheNearestRotation) {
    RandomGenerator random(8);
    const Eigen::Matrix3d c = any_rotation(random);
    std::vector<DirectionPair> pairs;
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d body = any_vector(random).normalized();
        const Eigen::Vector3d enu = rotation_about(1e-4 * any_vector(random)) * c * body;
        pairs.push_back({body, enu, Eigen::Matrix3d::Identity() - enu * enu.transpose()});
        sum += enu * body.transpose();
    }
    const auto found = attitude_by_directions(pairs);
    ASSERT_TRUE(found);
    EXPECT_LT((found->enu_from_body - nearest_rotation(sum)).norm(), 1e-7);
    EXPECT_FALSE(attitude_by_directions(std::span(pairs).first(1)));
}

TEST(Attitude, QuaternionTurnsAsTheRotation) {
    RandomGenerator random(7);
    for (int i = 0; i < 500; ++i) {
        const Eigen::Matrix3d c = any_rotation(random);
        const Eigen::Quaterniond q = quaternion_of(c);
        EXPECT_GE(q.w(), 0.0);
        EXPECT_NEAR(q.norm(), 1.0, 1e-15);
        EXPECT_LT((q.toRotationMatrix() - c).norm(), 1e-14);
    }
}

// At 0 N 0 E east, north and up are the Earth's y, z and x.
TEST(Attitude, AgainstTheEarthItIsTurnedByThePlace) {
    const Eigen::Matrix3d level = rotation_of({});
    const Eigen::Matrix3d at_zero = ecef_from_body({}, level);
    EXPECT_LT((at_zero.col(0) - Eigen::Vector3d(0, 0, 1)).norm(), 1e-15);
    EXPECT_LT((at_zero.col(1) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-15);
    EXPECT_LT((at_zero.col(2) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
    const Geodetic place{.latitude = Angle::from_degrees(-31.6),
                         .longitude = Angle::from_degrees(136.0),
                         .height_m = 110.0};
    const LocalFrame frame(place);
    const Eigen::Vector3d ahead = ecef_from_body(place, level).col(0);
    const Eigen::Vector3d moved =
        frame.ecef_from_enu(Enu{{0, 1, 0}}).m - frame.ecef_from_enu(Enu{{0, 0, 0}}).m;
    EXPECT_LT((ahead - moved).norm(), 1e-8);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
