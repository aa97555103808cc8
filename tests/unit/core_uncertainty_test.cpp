#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/failure.h"
#include "core/uncertainty.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Combine, GivesTheEndGaugeOfTheGuide) {
    // [GUM] H.1, table H.1, in nm: a 50 mm end gauge compared at -0.1 degC mean deviation from 20.
    const double length_nm = 50e6;
    const double expansion_per_k = 11.5e-6;
    const std::vector<InputQuantity> inputs = {
        {.standard_uncertainty = 25.0, .degrees_of_freedom = 18},
        {.standard_uncertainty = 9.7, .degrees_of_freedom = 25.6},
        // Thermal expansion and temperature: no first-order effect.
        {.standard_uncertainty = rectangular_uncertainty(2e-6), .sensitivity = 0.0},
        {.standard_uncertainty = 0.41, .sensitivity = 0.0},
        {.standard_uncertainty = rectangular_uncertainty(1e-6),
         .sensitivity = -length_nm * -0.1,
         .degrees_of_freedom = degrees_of_freedom(0.10)},
        {.standard_uncertainty = rectangular_uncertainty(0.05),
         .sensitivity = -length_nm * expansion_per_k,
         .degrees_of_freedom = degrees_of_freedom(0.50)}};
    EXPECT_NEAR(contribution(inputs[4]), 2.9, 0.05);
    EXPECT_NEAR(contribution(inputs[5]), -16.6, 0.05);

    const CombinedUncertainty combined = combine(inputs);
    EXPECT_NEAR(combined.standard_uncertainty, 32.0, 0.5);
    // Printed: u_c^2 = 1002 nm^2, 16.7 degrees of freedom, truncated to 16.
    EXPECT_NEAR(combined.standard_uncertainty * combined.standard_uncertainty, 1002.0, 2.0);
    ASSERT_TRUE(combined.effective_degrees_of_freedom);
    EXPECT_NEAR(*combined.effective_degrees_of_freedom, 16.7, 0.1);
    EXPECT_TRUE(combined.degrees_of_freedom_defined);
    const double factor = coverage_factor(0.99, std::floor(*combined.effective_degrees_of_freedom));
    EXPECT_NEAR(factor, 2.92, 0.005);
    EXPECT_NEAR(factor * combined.standard_uncertainty, 93.0, 0.7);
}

/// Voltage in V, current in A, phase in rad of [GUM] H.2, and what is made of them.
struct Impedance {
    double voltage, current, phase;
    std::array<double, 3> uncertainties;

    std::vector<InputQuantity> budget(double by_v, double by_i, double by_phase) const {
        return {{.standard_uncertainty = uncertainties[0], .sensitivity = by_v},
                {.standard_uncertainty = uncertainties[1], .sensitivity = by_i},
                {.standard_uncertainty = uncertainties[2], .sensitivity = by_phase}};
    }
    std::vector<InputQuantity> resistance() const {
        const double r = voltage / current * std::cos(phase);
        return budget(r / voltage, -r / current, -r * std::tan(phase));
    }
    std::vector<InputQuantity> reactance() const {
        const double x = voltage / current * std::sin(phase);
        return budget(x / voltage, -x / current, x / std::tan(phase));
    }
    std::vector<InputQuantity> magnitude() const {
        return budget(1.0 / current, -voltage / (current * current), 0.0);
    }
};

TEST(Combine, GivesTheCorrelatedImpedanceOfTheGuide) {
    // [GUM] H.2: the five simultaneous observations of table H.2; results of table H.3.
    Eigen::Matrix<double, 5, 3> observed;
    observed << 5.007, 19.663e-3, 1.0456,  //
        4.994, 19.639e-3, 1.0438,          //
        5.005, 19.640e-3, 1.0468,          //
        4.990, 19.685e-3, 1.0428,          //
        4.999, 19.678e-3, 1.0433;
    const Eigen::RowVector3d mean = observed.colwise().mean();
    const Eigen::Matrix<double, 5, 3> residual = observed.rowwise() - mean;
    const Eigen::Matrix3d covariance = residual.transpose() * residual / (5 * 4);
    const Eigen::Vector3d u = covariance.diagonal().cwiseSqrt();
    const Eigen::MatrixXd correlation = covariance.cwiseQuotient(u * u.transpose());
    EXPECT_NEAR(u[0], 0.0032, 0.00005);
    EXPECT_NEAR(u[1], 0.0095e-3, 0.00005e-3);
    EXPECT_NEAR(u[2], 0.00075, 0.000005);
    EXPECT_NEAR(correlation(0, 1), -0.36, 0.005);
    EXPECT_NEAR(correlation(0, 2), 0.86, 0.005);
    EXPECT_NEAR(correlation(1, 2), -0.65, 0.005);

    const Impedance z{mean[0], mean[1], mean[2], {u[0], u[1], u[2]}};
    EXPECT_NEAR(combine(z.resistance(), correlation).standard_uncertainty, 0.071, 0.0005);
    // Printed 0.295, from rounded intermediate figures.
    EXPECT_NEAR(combine(z.reactance(), correlation).standard_uncertainty, 0.295, 0.001);
    EXPECT_NEAR(combine(z.magnitude(), correlation).standard_uncertainty, 0.236, 0.0005);
    EXPECT_FALSE(combine(z.resistance(), correlation).effective_degrees_of_freedom);
}

TEST(Combine, AgreesWithTheCovarianceForm) {
    // [GUM] (13) by hand: c = (1, -2), u = (3, 4), r = 0.5: 9 + 64 - 2 * 3 * 8 * 0.5 = 49.
    const std::array<InputQuantity, 2> inputs = {
        InputQuantity{.standard_uncertainty = 3.0},
        InputQuantity{.standard_uncertainty = 4.0, .sensitivity = -2.0}};
    Eigen::MatrixXd correlation = Eigen::Matrix2d::Identity();
    correlation(0, 1) = correlation(1, 0) = 0.5;
    EXPECT_DOUBLE_EQ(combine(inputs, correlation).standard_uncertainty, 7.0);
    EXPECT_DOUBLE_EQ(combine(inputs).standard_uncertainty, std::sqrt(73.0));
}

TEST(Combine, TakesFullCorrelation) {
    const std::array<InputQuantity, 2> inputs = {
        InputQuantity{.standard_uncertainty = 0.1, .sensitivity = 3.0},
        InputQuantity{.standard_uncertainty = 0.3}};
    EXPECT_NEAR(combine(inputs, Eigen::Matrix2d::Ones()).standard_uncertainty, 0.6, 1e-15);
    const Eigen::Matrix2d opposite{{1.0, -1.0}, {-1.0, 1.0}};
    // [GUM] 5.2.2, note 1: contributions add with their signs; equal ones cancel.
    EXPECT_NEAR(combine(inputs, opposite).standard_uncertainty, 0.0, 1e-8);
}

TEST(Combine, IdentityIsTheIndependentForm) {
    const std::vector<InputQuantity> inputs = {
        {.standard_uncertainty = 0.3, .sensitivity = 1.7, .degrees_of_freedom = 4.5},
        {.standard_uncertainty = 0.7, .sensitivity = -0.1},
        {.standard_uncertainty = 0.2, .sensitivity = 2.0, .degrees_of_freedom = 9}};
    const CombinedUncertainty plain = combine(inputs);
    const CombinedUncertainty same = combine(inputs, Eigen::Matrix3d::Identity());
    EXPECT_EQ(plain.standard_uncertainty, same.standard_uncertainty);
    EXPECT_EQ(plain.effective_degrees_of_freedom, same.effective_degrees_of_freedom);
    EXPECT_TRUE(same.effective_degrees_of_freedom && same.degrees_of_freedom_defined);
}

TEST(Combine, DoesNotCallCorrelatedFiniteDegreesInfinite) {
    std::vector<InputQuantity> inputs = {{.standard_uncertainty = 1.0, .degrees_of_freedom = 4},
                                         {.standard_uncertainty = 1.0}};
    Eigen::MatrixXd correlation = Eigen::Matrix2d::Identity();
    correlation(0, 1) = correlation(1, 0) = 0.1;
    EXPECT_FALSE(combine(inputs, correlation).degrees_of_freedom_defined);
    EXPECT_FALSE(combine(inputs, correlation).effective_degrees_of_freedom);
    inputs[0].degrees_of_freedom.reset();
    EXPECT_TRUE(combine(inputs, correlation).degrees_of_freedom_defined);
}

TEST(Combine, WelchSatterthwaiteOfEqualInputsAddsTheirDegrees) {
    // n equal contributions of nu: (n u^2)^2 / (n u^4 / nu) = n nu.
    const std::vector<InputQuantity> inputs(
        5, {.standard_uncertainty = 1e-3, .sensitivity = -7.0, .degrees_of_freedom = 3});
    EXPECT_NEAR(*combine(inputs).effective_degrees_of_freedom, 15.0, 1e-12);
}

TEST(Combine, SmallBudgets) {
    const CombinedUncertainty none = combine(std::vector<InputQuantity>{});
    EXPECT_EQ(none.standard_uncertainty, 0.0);
    EXPECT_FALSE(none.effective_degrees_of_freedom);
    EXPECT_EQ(combine(std::vector<InputQuantity>{}, Eigen::MatrixXd(0, 0)).standard_uncertainty,
              0.0);

    const std::vector<InputQuantity> zeros(3, {.degrees_of_freedom = 5});
    EXPECT_EQ(combine(zeros).standard_uncertainty, 0.0);
    EXPECT_FALSE(combine(zeros).effective_degrees_of_freedom);
    EXPECT_EQ(combine(zeros, Eigen::Matrix3d::Ones()).standard_uncertainty, 0.0);

    const std::vector<InputQuantity> one = {
        {.standard_uncertainty = 0.25, .sensitivity = -2.0, .degrees_of_freedom = 6.5}};
    EXPECT_EQ(combine(one).standard_uncertainty, 0.5);
    EXPECT_DOUBLE_EQ(*combine(one).effective_degrees_of_freedom, 6.5);
}

TEST(Combine, RefusesWhatIsNoBudget) {
    for (const InputQuantity& input :
         {InputQuantity{.standard_uncertainty = -1.0}, InputQuantity{.standard_uncertainty = kNan},
          InputQuantity{.standard_uncertainty = kInfinity}, InputQuantity{.sensitivity = kNan},
          InputQuantity{.degrees_of_freedom = 0.0}, InputQuantity{.degrees_of_freedom = kNan},
          InputQuantity{.degrees_of_freedom = kInfinity}})
        EXPECT_THROW(combine(std::vector<InputQuantity>{input}), Failure);
}

TEST(Combine, RefusesWhatIsNoCorrelationMatrix) {
    const std::vector<InputQuantity> inputs(3, {.standard_uncertainty = 1.0});
    const auto refused = [&](const Eigen::MatrixXd& matrix) {
        EXPECT_THROW(combine(inputs, matrix), Failure) << matrix;
    };
    refused(Eigen::MatrixXd::Identity(2, 2));
    refused(Eigen::MatrixXd::Identity(3, 2));
    refused(2.0 * Eigen::Matrix3d::Identity());
    refused(Eigen::Matrix3d::Constant(kNan));
    Eigen::Matrix3d lopsided = Eigen::Matrix3d::Identity();
    lopsided(0, 1) = 0.5;
    refused(lopsided);
    Eigen::Matrix3d above_one = Eigen::Matrix3d::Identity();
    above_one(0, 2) = above_one(2, 0) = 1.001;
    refused(above_one);
    // Each pair is possible; all three are not: the determinant is negative.
    refused(Eigen::Matrix3d{{1.0, 0.9, -0.9}, {0.9, 1.0, 0.9}, {-0.9, 0.9, 1.0}});
}

TEST(CoverageFactor, GivesTheTableOfTheGuide) {
    // [GUM] table G.2. Its last line has infinite degrees of freedom, which are empty here. Its
    // 68.27 %, 95.45 % and 99.73 % stand for k = 1, 2, 3 of the normal distribution, given here
    // to more digits.
    struct Row {
        std::optional<double> degrees;
        std::array<double, 6> factors;
    };
    const std::array<double, 6> probabilities = {0.682689492, 0.90, 0.95,
                                                 0.954499736, 0.99, 0.997300204};
    for (const Row& row : {Row{1.0, {1.84, 6.31, 12.71, 13.97, 63.66, 235.80}},
                           Row{10.0, {1.05, 1.81, 2.23, 2.28, 3.17, 3.96}},
                           Row{50.0, {1.01, 1.68, 2.01, 2.05, 2.68, 3.16}},
                           Row{std::nullopt, {1.000, 1.645, 1.960, 2.000, 2.576, 3.000}}})
        for (std::size_t i = 0; i < probabilities.size(); ++i)
            EXPECT_NEAR(coverage_factor(probabilities[i], row.degrees), row.factors[i],
                        row.degrees ? 0.005 : 0.0005)
                << probabilities[i] << " " << row.degrees.value_or(kInfinity);
}

TEST(CoverageFactor, FollowsTheClosedForms) {
    // nu = 1: tan(pi p / 2). nu = 2: t = p sqrt(2 / (1 - p^2)).
    for (const double p : {0.01, 0.5, 0.95, 0.999}) {
        EXPECT_NEAR(coverage_factor(p, 1.0) / std::tan(std::acos(-1.0) * p / 2), 1.0, 1e-12);
        EXPECT_NEAR(coverage_factor(p, 2.0) / (p * std::sqrt(2 / (1 - p * p))), 1.0, 1e-12);
    }
    EXPECT_NEAR(coverage_factor(0.95, 1e9), coverage_factor(0.95, std::nullopt), 1e-8);
    EXPECT_GT(coverage_factor(0.95, 16.0), coverage_factor(0.95, 16.7));
}

TEST(CoverageFactor, RefusesWhatIsNoProbability) {
    for (const double p : {0.0, 1.0, -0.5, 95.0, kNan})
        EXPECT_THROW(coverage_factor(p, 10.0), Failure);
    for (const double degrees : {0.0, -1.0, kNan, kInfinity})
        EXPECT_THROW(coverage_factor(0.95, degrees), Failure);
}

TEST(TypeB, HalfWidths) {
    // [GUM] 4.4.5: within +-4 degC, 96 to 104: u = 2.3 rectangular.
    EXPECT_NEAR(rectangular_uncertainty(4.0), 2.3, 0.05);
    EXPECT_EQ(rectangular_uncertainty(0.0), 0.0);
    EXPECT_THROW(rectangular_uncertainty(-1.0), Failure);
    EXPECT_THROW(rectangular_uncertainty(kNan), Failure);
}

TEST(TypeB, DegreesOfFreedomOfAnUncertainUncertainty) {
    // [GUM] G.4.2: an uncertainty good to 25 % has 8 degrees of freedom.
    EXPECT_DOUBLE_EQ(*degrees_of_freedom(0.25), 8.0);
    EXPECT_FALSE(degrees_of_freedom(0.0));
    EXPECT_THROW(degrees_of_freedom(-0.1), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
