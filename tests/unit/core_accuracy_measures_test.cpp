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
using Eigen::Vector2d;
using std::numbers::pi;

Matrix2d diagonal(double a, double b) {
    return Vector2d(a * a, b * b).asDiagonal().toDenseMatrix();
}

/// P(|x| <= r) in the plane by another formula: whitened polar coordinates, in which the radius
/// integrates to 1 - exp(-r^2 / 2 q), and the trapezoid rule over the angle, which is periodic.
double polar(double a, double b, double r, int steps) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double t = 2.0 * pi * i / steps;
        const double q = std::pow(a * std::cos(t), 2) + std::pow(b * std::sin(t), 2);
        sum -= std::expm1(-0.5 * r * r / q);
    }
    return sum / steps;
}

struct Figure {
    double percent;
    double radius;
};

TEST(AccuracyMeasures, NavTableInThePlane) {
    const Matrix2d circle = Matrix2d::Identity();
    for (const Figure f :
         {Figure{63.2, std::sqrt(2.0)}, {86.5, 2.0}, {98.2, 2.0 * std::sqrt(2.0)}, {98.9, 3.0}})
        EXPECT_NEAR(100 * probability_within(circle, f.radius), f.percent, 0.05);
    // The table prints 39.4 for 39.35, which is 39.347 rounded twice.
    EXPECT_NEAR(100 * probability_within(circle, 1.0), 39.4, 0.06);
    EXPECT_NEAR(r95(circle), 2.45, 0.005);
}

TEST(AccuracyMeasures, CircleInClosedForm) {
    for (const double r : {1e-6, 0.01, 0.3, 1.0, 2.0, 5.0, 8.0, 20.0, 1e6}) {
        const double disc = -std::expm1(-0.5 * r * r);
        EXPECT_NEAR(probability_within(diagonal(1.0, 1.0), r), disc, 1e-12 * disc);
    }
    const double radius = std::sqrt(-2.0 * std::log(0.05));
    EXPECT_NEAR(r95(diagonal(0.01, 0.01)), 0.01 * radius, 1e-14);
    // A difference in the last bits must not matter.
    EXPECT_NEAR(r95(diagonal(1.0, 1.0 + 1e-15)), radius, 1e-12);
}

TEST(AccuracyMeasures, EllipseByAnotherFormula) {
    for (const double ratio : {0.9, 0.5, 0.1, 0.01, 1e-3})
        for (const double r : {0.003, 0.1, 0.5, 1.0, 2.0, 4.0})
            EXPECT_NEAR(probability_within(diagonal(ratio, 1.0), r), polar(1.0, ratio, r, 40'000),
                        1e-11)
                << ratio << " " << r;
}

TEST(AccuracyMeasures, DegenerateCovariances) {
    for (const double r : {1e-7, 1e-3, 0.3, 1.0, 2.5, 7.0}) {
        const double line = std::erf(r / std::numbers::sqrt2);
        EXPECT_EQ(probability_within(diagonal(1.0, 0.0), r), line);
        // A needle of thickness s = 1e-6 holds less by the share (s / r)^2 at most.
        const double near = 1e-12 + 1.01 * line * std::min(1.0, std::pow(1e-6 / r, 2));
        EXPECT_NEAR(probability_within(diagonal(1.0, 1e-6), r), line, near);
    }
    // Rank one along a diagonal, where the zero eigenvalue is only nearly zero.
    const Vector2d v(0.6, 0.8);
    EXPECT_NEAR(probability_within(v * v.transpose(), 1.0), std::erf(std::sqrt(0.5)), 1e-12);
    EXPECT_NEAR(r95(v * v.transpose()), 1.959963984540054, 1e-12);
    EXPECT_EQ(probability_within(Matrix2d::Zero(), 0.0), 1.0);
    EXPECT_EQ(probability_within(diagonal(1.0, 1.0), 0.0), 0.0);
    EXPECT_EQ(probability_within(diagonal(1.0, 2.0), std::numeric_limits<double>::infinity()), 1.0);
    EXPECT_EQ(r95(Matrix2d::Zero()), 0.0);
}

TEST(AccuracyMeasures, DependOnShapeAloneAndAgreeWithSimulation) {
    const Matrix2d shape = diagonal(1.0, 0.05);
    for (const double angle : {0.1, 1.0, 2.5}) {
        const Matrix2d turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
        Matrix2d turned = turn * shape * turn.transpose();
        turned = (0.5 * (turned + turned.transpose())).eval();
        EXPECT_NEAR(r95(turned), r95(shape), 1e-11);
        EXPECT_NEAR(r95(1e-4 * turned), 0.01 * r95(shape), 1e-13);
    }
    Matrix2d covariance;
    covariance << 4.0, 1.2, 1.2, 1.0;
    const Matrix2d factor = covariance.llt().matrixL();
    const double radius = r95(covariance);
    RandomGenerator random(12);
    constexpr int count = 400'000;
    int within = 0;
    for (int i = 0; i < count; ++i) {
        const double a = random.normal();
        if ((factor * Vector2d(a, random.normal())).norm() <= radius) ++within;
    }
    // Four standard errors.
    EXPECT_NEAR(double(within) / count, 0.95, 4 * std::sqrt(0.95 * 0.05 / count));
}

TEST(AccuracyMeasures, RadiusIsTheInverseOfTheProbabilityWhichGrows) {
    for (const double ratio : {1.0, 0.3, 1e-3, 1e-6, 0.0}) {
        const Matrix2d covariance = diagonal(1.0, ratio);
        EXPECT_NEAR(probability_within(covariance, r95(covariance)), 0.95, 1e-11);
    }
    double last = 0.0;
    for (int i = 1; i <= 400; ++i) {
        const double p = probability_within(diagonal(1.0, 0.02), 0.01 * i);
        EXPECT_GT(p, last);
        last = p;
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
        EXPECT_THROW(probability_within(bad, 1.0), Failure);
        EXPECT_THROW(r95(bad), Failure);
    }
    EXPECT_THROW(probability_within(Matrix2d::Identity(), -1.0), Failure);
    EXPECT_THROW(probability_within(Matrix2d::Identity(), nan), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
