#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/accuracy_measures.h"
#include "core/failure.h"
#include "core/random.h"

namespace runcert::RUNCERT_FILE {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;

Matrix2d diagonal(double a, double b) {
    return Vector2d(a * a, b * b).asDiagonal().toDenseMatrix();
}

Matrix3d diagonal(double a, double b, double c) {
    return Vector3d(a * a, b * b, c * c).asDiagonal().toDenseMatrix();
}

/// P(|x| <= r) in the plane by another formula: whitened polar coordinates, in which the radius
/// integrates to 1 - exp(-r^2 / 2 q), and the trapezoid rule over the angle, which is periodic.
double polar_2d(double a, double b, double r, int steps) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double t = 2.0 * pi * i / steps;
        const double q = std::pow(a * std::cos(t), 2) + std::pow(b * std::sin(t), 2);
        sum -= std::expm1(-0.5 * r * r / q);
    }
    return sum / steps;
}

/// The same in space: whitened spherical coordinates, Simpson's rule over the height.
double polar_3d(double a, double b, double c, double r, int heights, int angles) {
    const auto ring = [&](double z) {
        double sum = 0.0;
        for (int i = 0; i < angles; ++i) {
            const double t = 2.0 * pi * i / angles;
            const double q =
                (1.0 - z * z) * (std::pow(a * std::cos(t), 2) + std::pow(b * std::sin(t), 2)) +
                std::pow(c * z, 2);
            const double s = r / std::sqrt(q);
            sum += std::erf(s / std::numbers::sqrt2) -
                   std::sqrt(2.0 / pi) * s * std::exp(-0.5 * s * s);
        }
        return sum / angles;
    };
    double sum = ring(0.0) + ring(1.0);
    for (int i = 1; i < heights; ++i)
        sum += (i % 2 == 1 ? 4.0 : 2.0) * ring(double(i) / heights);
    return sum / (3.0 * heights);
}

struct Figure {
    double percent;
    double radius;
};

TEST(AccuracyMeasures, NavTableInOneDimension) {
    for (const Figure f : {Figure{68.3, 1.0}, {95.0, 1.96}, {99.7, 3.0}})
        EXPECT_NEAR(100 * probability_within_1d(1.0, f.radius), f.percent, 0.05);
    EXPECT_NEAR(lep(1.0), 0.67, 0.005);
    EXPECT_NEAR(r95_1d(1.0), 1.96, 0.005);
    EXPECT_NEAR(lep(3.0), 3.0 * 0.6744897501960817, 1e-14);
}

TEST(AccuracyMeasures, NavTableInThePlane) {
    const Matrix2d circle = Matrix2d::Identity();
    for (const Figure f :
         {Figure{63.2, std::sqrt(2.0)}, {86.5, 2.0}, {98.2, 2.0 * std::sqrt(2.0)}, {98.9, 3.0}})
        EXPECT_NEAR(100 * probability_within_2d(circle, f.radius), f.percent, 0.05);
    // The table prints 39.4 for 39.35, which is 39.347 rounded twice.
    EXPECT_NEAR(100 * probability_within_2d(circle, 1.0), 39.4, 0.06);
    EXPECT_NEAR(cep(circle), 1.18, 0.005);
    EXPECT_NEAR(drms(circle), 1.41, 0.005);
    EXPECT_NEAR(r95(circle), 2.45, 0.005);
    EXPECT_NEAR(two_drms(circle), 2.83, 0.005);
}

TEST(AccuracyMeasures, NavTableInSpace) {
    const Matrix3d sphere = Matrix3d::Identity();
    for (const Figure f : {Figure{19.9, 1.0}, {97.1, 3.0}})
        EXPECT_NEAR(100 * probability_within_3d(sphere, f.radius), f.percent, 0.05);
    // The table prints 73.8 at 2.00, cut from 73.85, and 61.0 at 1.73, which is 60.8: exactly,
    // erf(sqrt(3/2)) - sqrt(6/pi) exp(-3/2).
    EXPECT_NEAR(100 * probability_within_3d(sphere, 2.0), 73.8, 0.1);
    EXPECT_NEAR(100 * probability_within_3d(sphere, std::sqrt(3.0)), 61.0, 0.2);
    EXPECT_NEAR(probability_within_3d(sphere, std::sqrt(3.0)), 0.6083748237, 1e-10);
    // It prints 1.53 for SEP, "1.54 to more digits"; 2.80 for 95 %.
    EXPECT_NEAR(sep(sphere), 1.54, 0.005);
    EXPECT_NEAR(mrse(sphere), 1.73, 0.005);
    EXPECT_NEAR(radius_3d(sphere, 0.95), 2.80, 0.005);
}

TEST(AccuracyMeasures, CircleAndSphereInClosedForm) {
    for (const double r : {1e-6, 0.01, 0.3, 1.0, 2.0, 5.0, 8.0, 20.0, 1e6}) {
        const double disc = -std::expm1(-0.5 * r * r);
        EXPECT_NEAR(probability_within_2d(diagonal(1.0, 1.0), r), disc, 1e-12 * disc);
        const double ball =
            std::erf(r / std::numbers::sqrt2) - std::sqrt(2.0 / pi) * r * std::exp(-0.5 * r * r);
        EXPECT_NEAR(probability_within_3d(diagonal(1.0, 1.0, 1.0), r), ball, 1e-12);
    }
    EXPECT_NEAR(cep(diagonal(0.01, 0.01)), 0.01 * std::sqrt(2.0 * std::numbers::ln2), 1e-14);
    // A difference in the last bits must not matter.
    EXPECT_NEAR(cep(diagonal(1.0, 1.0 + 1e-15)), std::sqrt(2.0 * std::numbers::ln2), 1e-12);
}

TEST(AccuracyMeasures, EllipseByAnotherFormula) {
    for (const double ratio : {0.9, 0.5, 0.1, 0.01, 1e-3})
        for (const double r : {0.003, 0.1, 0.5, 1.0, 2.0, 4.0})
            EXPECT_NEAR(probability_within_2d(diagonal(ratio, 1.0), r),
                        polar_2d(1.0, ratio, r, 40'000), 1e-11)
                << ratio << " " << r;
}

TEST(AccuracyMeasures, EllipsoidByAnotherFormula) {
    const Vector3d shapes[] = {{1.0, 0.8, 0.5}, {1.0, 1.0, 0.3}, {1.0, 0.3, 0.3}, {1.0, 0.2, 0.1}};
    for (const Vector3d& s : shapes)
        for (const double r : {0.2, 0.7, 1.0, 2.0, 4.0})
            EXPECT_NEAR(probability_within_3d(diagonal(s[1], s[2], s[0]), r),
                        polar_3d(s[0], s[1], s[2], r, 4000, 400), 1e-10)
                << s.transpose() << " " << r;
}

TEST(AccuracyMeasures, DegenerateCovariances) {
    for (const double r : {1e-7, 1e-3, 0.3, 1.0, 2.5, 7.0}) {
        const double line = probability_within_1d(1.0, r);
        const double disc = probability_within_2d(diagonal(1.0, 0.4), r);
        EXPECT_EQ(probability_within_2d(diagonal(1.0, 0.0), r), line);
        EXPECT_EQ(probability_within_3d(diagonal(0.0, 1.0, 0.0), r), line);
        EXPECT_EQ(probability_within_3d(diagonal(0.4, 0.0, 1.0), r), disc);
        // A needle and a sheet of thickness s = 1e-6 hold less by the share (s / r)^2 at most.
        const double near = 1e-12 + 1.01 * line * std::min(1.0, std::pow(1e-6 / r, 2));
        EXPECT_NEAR(probability_within_2d(diagonal(1.0, 1e-6), r), line, near);
        EXPECT_NEAR(probability_within_3d(diagonal(1e-6, 1.0, 1e-6), r), line, near);
        EXPECT_NEAR(probability_within_3d(diagonal(1e-6, 1.0, 0.4), r), disc, near);
    }
    // Rank one along a diagonal, where the zero eigenvalue is only nearly zero.
    const Vector2d v(0.6, 0.8);
    EXPECT_NEAR(probability_within_2d(v * v.transpose(), 1.0), std::erf(std::sqrt(0.5)), 1e-12);
    EXPECT_NEAR(cep(v * v.transpose()), lep(1.0), 1e-12);
    EXPECT_EQ(probability_within_2d(Matrix2d::Zero(), 0.0), 1.0);
    EXPECT_EQ(probability_within_3d(Matrix3d::Zero(), 1.0), 1.0);
    EXPECT_EQ(probability_within_2d(diagonal(1.0, 1.0), 0.0), 0.0);
    EXPECT_EQ(cep(Matrix2d::Zero()), 0.0);
    EXPECT_EQ(sep(Matrix3d::Zero()), 0.0);
    EXPECT_EQ(probability_within_3d(diagonal(1, 2, 3), std::numeric_limits<double>::infinity()),
              1.0);
}

TEST(AccuracyMeasures, NeedleInsideItsOwnThickness) {
    // For r far below the largest axis its density is flat: P = sqrt(2/pi) E[sqrt(r^2 - y^2)]+ / a.
    // With a sheet's other axis b, y = b z; Simpson over z in sine of an angle.
    const double a = 1.0;
    const double b = 1e-6;
    const double r = 2e-6;
    double sum = 0.0;
    constexpr int steps = 2000;
    for (int i = 0; i <= steps; ++i) {
        const double t = pi / 2 * i / steps;
        const double z = r / b * std::sin(t);
        const double f = std::exp(-0.5 * z * z) * r / b * std::pow(std::cos(t), 2) * r;
        sum += (i == 0 || i == steps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0) * f;
    }
    const double expected = 2.0 / pi / a * sum * (pi / 2 / steps / 3.0);
    EXPECT_NEAR(probability_within_2d(diagonal(a, b), r) / expected, 1.0, 1e-9);
}

TEST(AccuracyMeasures, DependOnShapeAlone) {
    RandomGenerator random(11);
    for (int i = 0; i < 20; ++i) {
        const Matrix3d turn =
            Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
                .normalized()
                .toRotationMatrix();
        const Matrix3d shape = diagonal(1.0, 0.4, 0.05);
        Matrix3d turned = turn * shape * turn.transpose();
        turned = (0.5 * (turned + turned.transpose())).eval();
        EXPECT_NEAR(sep(turned), sep(shape), 1e-11);
        EXPECT_NEAR(mrse(turned), mrse(shape), 1e-13);
        EXPECT_NEAR(sep(1e-4 * turned), 0.01 * sep(shape), 1e-13);
    }
}

TEST(AccuracyMeasures, AgreeWithSimulation) {
    Matrix3d covariance;
    covariance << 4.0, 1.2, -0.8, 1.2, 1.0, 0.3, -0.8, 0.3, 2.0;
    const Matrix3d factor = covariance.llt().matrixL();
    const double radius = sep(covariance);
    const Matrix2d plane = covariance.topLeftCorner<2, 2>();
    const double radius_95 = r95(plane);
    RandomGenerator random(12);
    constexpr int count = 400'000;
    int within_3d = 0;
    int within_2d = 0;
    for (int i = 0; i < count; ++i) {
        const double a = random.normal();
        const double b = random.normal();
        const Vector3d x = factor * Vector3d(a, b, random.normal());
        if (x.norm() <= radius) ++within_3d;
        if (x.head<2>().norm() <= radius_95) ++within_2d;
    }
    // Four standard errors.
    EXPECT_NEAR(double(within_3d) / count, 0.5, 4 * std::sqrt(0.5 * 0.5 / count));
    EXPECT_NEAR(double(within_2d) / count, 0.95, 4 * std::sqrt(0.95 * 0.05 / count));
}

TEST(AccuracyMeasures, RadiusIsTheInverseAndGrows) {
    for (const Vector3d& s : {Vector3d(1, 1, 1), Vector3d(1, 0.3, 0.1), Vector3d(1, 1e-3, 1e-6),
                              Vector3d(0, 0.3, 1), Vector3d(0, 0, 1)}) {
        const Matrix3d space = diagonal(s[0], s[1], s[2]);
        const Matrix2d plane = space.bottomRightCorner<2, 2>();
        double last_2d = 0.0;
        double last_3d = 0.0;
        for (const double p : {1e-6, 0.1, 0.5, 0.683, 0.95, 0.997, 1.0 - 1e-9}) {
            const double r_2d = radius_2d(plane, p);
            const double r_3d = radius_3d(space, p);
            EXPECT_NEAR(probability_within_2d(plane, r_2d), p, 1e-11);
            EXPECT_NEAR(probability_within_3d(space, r_3d), p, 1e-11);
            EXPECT_GT(r_2d, last_2d);
            EXPECT_GT(r_3d, last_3d);
            EXPECT_GE(r_3d, r_2d * (1 - 1e-9));
            last_2d = r_2d;
            last_3d = r_3d;
        }
        EXPECT_EQ(radius_3d(space, 0.0), 0.0);
        EXPECT_LT(radius_3d(space, 1.0 - 1e-16), 10.0);
    }
}

TEST(AccuracyMeasures, ProbabilityGrowsWithTheRadius) {
    double last_2d = 0.0;
    double last_3d = 0.0;
    for (int i = 1; i <= 400; ++i) {
        const double r = 0.01 * i;
        const double p_2d = probability_within_2d(diagonal(1.0, 0.02), r);
        const double p_3d = probability_within_3d(diagonal(1.0, 0.02, 0.3), r);
        EXPECT_GT(p_2d, last_2d);
        EXPECT_GT(p_3d, last_3d);
        EXPECT_LT(p_3d, p_2d);
        last_2d = p_2d;
        last_3d = p_3d;
    }
}

TEST(AccuracyMeasures, RefuseWhatIsNoCovariance) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    Matrix2d skew = Matrix2d::Identity();
    skew(0, 1) = 0.1;
    Matrix2d indefinite;
    indefinite << 1.0, 2.0, 2.0, 1.0;
    Matrix2d missing = Matrix2d::Identity();
    missing(1, 1) = nan;
    const Matrix2d negative = -Matrix2d::Identity();
    for (const Matrix2d& bad : {skew, indefinite, missing, negative}) {
        EXPECT_THROW(probability_within_2d(bad, 1.0), Failure);
        EXPECT_THROW(cep(bad), Failure);
        EXPECT_THROW(drms(bad), Failure);
        Matrix3d bad_3d = Matrix3d::Identity();
        bad_3d.topLeftCorner<2, 2>() = bad;
        EXPECT_THROW(sep(bad_3d), Failure);
        EXPECT_THROW(mrse(bad_3d), Failure);
    }
    const Matrix2d good = Matrix2d::Identity();
    EXPECT_THROW(probability_within_2d(good, -1.0), Failure);
    EXPECT_THROW(probability_within_2d(good, nan), Failure);
    EXPECT_THROW(probability_within_1d(-1.0, 1.0), Failure);
    for (const double p : {1.0, -0.1, nan})
        EXPECT_THROW(radius_2d(good, p), Failure);
    EXPECT_THROW(lep(nan), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
