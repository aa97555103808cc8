#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "motion/likelihood.h"
#include "motion/speed.h"
#include "motion_test_support.h"

// The filter, the smoother and the covariance between epochs against statsmodels
// (Seabold & Perktold 2010; Fulton 2015), an independent program, which is told the model's
// parameters and makes its matrices itself.

namespace runcert::RUNCERT_FILE {
namespace {

using Json = nlohmann::json;
using test::sample_arc;

constexpr std::size_t epochs = 80;
constexpr std::size_t start = 25;
constexpr std::size_t end = 55;

std::vector<ArcEpoch<2>> arc_with_gaps() {
    auto arc = sample_arc<2>(epochs);
    arc[40].measurement.reset();
    arc[41].measurement.reset();
    return arc;
}

Json problem_of(const std::vector<ArcEpoch<2>>& arc, const EstimationModel& model) {
    const StateEstimate<2> prior = KalmanFilter<2>(model).prior(arc[0].measurement->position);
    Json problem = {{"jerk_density", model.motion.jerk_density},
                    {"error_tau", model.error.tau_s},
                    {"error_density", model.error.process_density},
                    {"start", start},
                    {"end", end},
                    {"left_out", measurements_of_the_prior}};
    if (std::isfinite(model.motion.acceleration_time_s))
        problem["acceleration_time"] = model.motion.acceleration_time_s;
    else
        problem["acceleration_time"] = nullptr;
    for (int i = 0; i < 8; ++i) {
        problem["prior_mean"].push_back(prior.mean(i));
        problem["prior_sigma"].push_back(std::sqrt(prior.covariance(i, i)));
    }
    const double scale = model.measurement_scale * model.measurement_scale;
    for (const ArcEpoch<2>& epoch : arc) {
        problem["time"].push_back(epoch.time_s);
        const auto measurement = epoch.measurement.value_or(PositionMeasurement<2>{});
        const Eigen::Matrix2d r = scale * measurement.covariance;
        problem["covariance"].push_back(
            Json::array({Json::array({r(0, 0), r(0, 1)}), Json::array({r(1, 0), r(1, 1)})}));
        if (epoch.measurement)
            problem["position"].push_back({measurement.position.x(), measurement.position.y()});
        else
            problem["position"].push_back(nullptr);
    }
    return problem;
}

/// What a shell command prints; the test fails where the command does.
std::string output_of(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) {
        ADD_FAILURE() << command;
        return {};
    }
    std::string output;
    std::array<char, 4096> part{};
    while (const std::size_t count = std::fread(part.data(), 1, part.size(), pipe))
        output.append(part.data(), count);
    EXPECT_EQ(pclose(pipe), 0) << command;
    return output;
}

/// The problem solved by statsmodels. Numbers are written with all their digits.
Json statsmodels(const std::vector<ArcEpoch<2>>& arc, const EstimationModel& model) {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    const std::string file = testing::TempDir() + "runcert_statsmodels_" + test->name() + ".json";
    std::ofstream(file) << problem_of(arc, model);
    const std::string output = output_of("/usr/bin/python3 -W error " RUNCERT_SOURCE_DIR
                                         "/tests/unit/data/statsmodels_smoother.py '" +
                                         file + "'");
    std::remove(file.c_str());
    return Json::parse(output, nullptr, false);
}

Eigen::MatrixXd matrix_of(const Json& rows) {
    Eigen::MatrixXd matrix(rows.size(), rows[0].size());
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (std::size_t j = 0; j < rows[i].size(); ++j)
            matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j];
    return matrix;
}

InnovationSums sums_of(const std::vector<ArcEpoch<2>>& arc, const EstimationModel& model) {
    const std::span<const ArcEpoch<2>> arcs[] = {arc};
    return innovation_sums<2>(arcs, model);
}

class Statsmodels : public testing::Test {
  protected:
    void SetUp() override {
        if (std::system("/usr/bin/python3 -c 'import statsmodels' 2> /dev/null") != 0)
            GTEST_SKIP() << "python3-statsmodels is not installed";
    }
};

/// Largest differences of means and covariances of an epoch, in units of standard deviations and of
/// correlations.
struct Difference {
    double mean = 0.0;
    double covariance = 0.0;
};
Difference difference(const StateEstimate<2>& ours, const Eigen::VectorXd& mean,
                      const Eigen::MatrixXd& covariance) {
    const StateVector<2> inverse = ours.covariance.diagonal().cwiseSqrt().cwiseInverse();
    return {inverse.cwiseProduct(ours.mean - mean).cwiseAbs().maxCoeff(),
            (inverse.asDiagonal() * (ours.covariance - covariance) * inverse.asDiagonal())
                .cwiseAbs()
                .maxCoeff()};
}

void expect_same_states(const Chain<2>& ours, const Json& theirs) {
    const Eigen::MatrixXd states = matrix_of(theirs["states"]);
    ASSERT_EQ(states.rows(), static_cast<Eigen::Index>(epochs));
    for (std::size_t k = 0; k < epochs; ++k) {
        const Eigen::VectorXd mean = states.row(static_cast<Eigen::Index>(k)).transpose();
        EXPECT_LT((ours.mean(k) - mean).norm(), 1e-9 * mean.norm()) << k;
        const Difference found =
            difference(ours.state(k), mean, matrix_of(theirs["covariances"][k]));
        EXPECT_LT(found.mean, k < 10 ? 2e-8 : 1e-9) << k;
        // Its smoother subtracts P N P from P, and loses what a prior of 300 m/s squared takes of
        // sixteen digits: all in the first two epochs, where we agree with the dense solution.
        if (k < 2) continue;
        EXPECT_LT(found.covariance, k < 3 ? 1e-5 : k < 10 ? 2e-8 : 1e-9) << k;
    }
}

/// u' [P_s + P_e - C - C'] u / T^2, with u along the displacement.
void expect_same_displacement(const Chain<2>& ours, const Json& theirs, double duration_s) {
    const Eigen::MatrixXd between = matrix_of(theirs["between"]);
    EXPECT_TRUE(ours.cross_covariance(start, end).isApprox(between, 1e-9));
    const Eigen::MatrixXd states = matrix_of(theirs["states"]);
    const Eigen::Vector2d displacement = (states.row(end) - states.row(start)).head<2>();
    const Eigen::MatrixXd covariance = matrix_of(theirs["covariances"][start]) +
                                       matrix_of(theirs["covariances"][end]) - between -
                                       between.transpose();
    const Eigen::Vector2d u = displacement.normalized();
    const double variance = u.dot(covariance.topLeftCorner<2, 2>() * u) / (duration_s * duration_s);
    const SpeedEstimate speed =
        horizontal_speed(runcert::displacement(ours, start, end) / duration_s,
                         displacement_covariance(ours, start, end) / (duration_s * duration_s));
    EXPECT_NEAR(speed.speed_m_s / (displacement.norm() / duration_s), 1.0, 1e-9);
    EXPECT_NEAR(std::pow(speed.standard_uncertainty_m_s, 2) / variance, 1.0, 1e-9);
    Gradients<2> gradients(end - start + 1, StateVector<2>::Zero());
    gradients.front().head<2>() = -u / duration_s;
    gradients.back().head<2>() = u / duration_s;
    EXPECT_NEAR(ours.variance(start, gradients) / variance, 1.0, 1e-9);
}

void expect_agreement(const EstimationModel& model) {
    const auto arc = arc_with_gaps();
    const Json theirs = statsmodels(arc, model);
    ASSERT_TRUE(theirs.is_object());
    const Chain<2> ours = Chain<2>(arc, model);
    expect_same_states(ours, theirs);
    expect_same_displacement(ours, theirs, arc[end].time_s - arc[start].time_s);
    const InnovationSums sums = sums_of(arc, model);
    EXPECT_EQ(sums.values, 2 * (ours.measurements() - measurements_of_the_prior));
    EXPECT_NEAR(sums.statistic / theirs["statistic"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(sums.log_determinant / theirs["log_determinant"].get<double>(), 1.0, 1e-9);
    EXPECT_NEAR(sums.log_likelihood() / theirs["log_likelihood"].get<double>(), 1.0, 1e-9);
}

EstimationModel plain() {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    return model;
}
EstimationModel persistent_with_error() {
    EstimationModel model = test::singer_with_error;
    model.motion.acceleration_time_s = std::numeric_limits<double>::infinity();
    return model;
}

TEST_F(Statsmodels, SmoothsAsWeDoWithoutAnError) {
    expect_agreement(plain());
}
TEST_F(Statsmodels, SmoothsAsWeDoWithAnError) {
    expect_agreement(persistent_with_error());
}
TEST_F(Statsmodels, SmoothsAsWeDoWithSinger) {
    expect_agreement(test::singer_with_error);
}

TEST_F(Statsmodels, LikelihoodOfTwoModelsDiffersAsOurs) {
    const auto arc = arc_with_gaps();
    EstimationModel other = test::singer_with_error;
    other.motion.jerk_density = 2.0;
    other.error = GaussMarkovError::steady(0.02, 1.2);
    const Json first = statsmodels(arc, test::singer_with_error);
    const Json second = statsmodels(arc, other);
    ASSERT_TRUE(first.is_object() && second.is_object());
    const double theirs =
        first["log_likelihood"].get<double>() - second["log_likelihood"].get<double>();
    const double ours = sums_of(arc, test::singer_with_error).log_likelihood() -
                        sums_of(arc, other).log_likelihood();
    ASSERT_GT(std::abs(theirs), 5.0);
    EXPECT_NEAR(ours / theirs, 1.0, 1e-9);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
