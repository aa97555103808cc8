#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "core/failure.h"
#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::DenseSolution;
using test::sample_arc;
using test::singer_with_error;
using test::solve_dense;

/// Differences in units of the standard deviations: as large for every unit of the state.
Eigen::MatrixXd correlation_scale(const Eigen::MatrixXd& matrix, const Eigen::VectorXd& row_sigma,
                                  const Eigen::VectorXd& column_sigma) {
    return row_sigma.cwiseInverse().asDiagonal() * matrix *
           column_sigma.cwiseInverse().asDiagonal();
}

template <int Axes>
void expect_equal_to_dense(const EstimationModel& model,
                           const std::vector<ArcEpoch<Axes>>& arc = sample_arc<Axes>(10)) {
    constexpr int n = state_size<Axes>;
    const Chain<Axes> smoothed = Chain<Axes>(arc, model);
    const DenseSolution dense = solve_dense<Axes>(arc, model);
    const Eigen::VectorXd sigma = dense.covariance.diagonal().cwiseSqrt();
    const auto measured = std::ranges::count_if(
        arc, [](const ArcEpoch<Axes>& epoch) { return epoch.measurement.has_value(); });
    double mean = 0.0;
    double covariance = 0.0;
    for (std::size_t s = 0; s < arc.size(); ++s) {
        const auto at = static_cast<Eigen::Index>(s) * n;
        const Eigen::VectorXd own = sigma.segment(at, n);
        mean =
            std::max(mean, ((smoothed.mean(s) - dense.states.segment(at, n)).array() / own.array())
                               .abs()
                               .maxCoeff());
        // Joint covariances too, some of them across the missing measurement.
        for (std::size_t e = s; e < arc.size(); ++e) {
            const auto to = static_cast<Eigen::Index>(e) * n;
            const Eigen::MatrixXd difference =
                smoothed.cross_covariance(s, e) - dense.covariance.block(at, to, n, n);
            covariance = std::max(
                covariance,
                correlation_scale(difference, own, sigma.segment(to, n)).cwiseAbs().maxCoeff());
        }
        EXPECT_EQ(smoothed.state(s).covariance, smoothed.state(s).covariance.transpose());
    }
    EXPECT_LT(mean, 1e-8);
    EXPECT_LT(covariance, 3e-8);
    EXPECT_EQ(smoothed.measurements(), measured);
}

TEST(Smoother, EqualsDenseLeastSquaresOnOneAxis) {
    expect_equal_to_dense<1>(singer_with_error);
}
TEST(Smoother, EqualsDenseLeastSquaresInThePlane) {
    expect_equal_to_dense<2>(singer_with_error);
}
TEST(Smoother, EqualsDenseLeastSquaresWithoutAnError) {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    expect_equal_to_dense<2>(model);
}
TEST(Smoother, EqualsDenseLeastSquaresWithAnErrorThatGrows) {
    EstimationModel model = singer_with_error;
    model.error = test::growing_error;
    expect_equal_to_dense<2>(model);
}

TEST(Smoother, EqualsDenseLeastSquaresWhereTheMotionChanges) {
    expect_equal_to_dense<1>(singer_with_error, test::with_changing_motion(sample_arc<1>(10)));
    expect_equal_to_dense<2>(singer_with_error, test::with_changing_motion(sample_arc<2>(10)));
    expect_equal_to_dense<2>(singer_with_error,
                             test::with_changing_motion(test::at_equal_steps(sample_arc<2>(10))));
}

TEST(Smoother, EqualsDenseLeastSquaresAcrossAGap) {
    // Within it the predictions are too vague for P - P N P.
    std::vector<ArcEpoch<2>> arc = sample_arc<2>(24);
    for (std::size_t k = 8; k < 16; ++k)
        arc[k].measurement.reset();
    for (std::size_t k = 12; k < arc.size(); ++k)
        arc[k].time_s += 30.0;
    expect_equal_to_dense<2>(singer_with_error, arc);
}

template <int Axes>
void expect_means_as_with_covariances() {
    const auto arc = test::with_changing_motion(sample_arc<Axes>(60));
    const Chain<Axes> whole(arc, singer_with_error);
    const ChainMeans<Axes> means(arc, singer_with_error);
    EXPECT_EQ(means.innovation_sum(), whole.innovation_sum());
    for (std::size_t k = 0; k < arc.size(); ++k)
        EXPECT_LT((means.mean(k) - whole.mean(k)).norm(), 1e-9 * (1.0 + whole.mean(k).norm())) << k;
}

TEST(Smoother, MeansAloneAreThoseBesideTheCovariances) {
    expect_means_as_with_covariances<1>();
    expect_means_as_with_covariances<2>();
}

TEST(Smoother, SumOfInnovationStatisticsIsTheMinimumOfLeastSquares) {
    const auto arc = sample_arc<2>(12);
    const Chain<2> smoothed = Chain<2>(arc, singer_with_error);
    const double minimum = solve_dense<2>(arc, singer_with_error).minimum;
    EXPECT_NEAR(smoothed.innovation_sum() / minimum, 1.0, 1e-10);
}

template <int Axes>
void expect_variance_of_dense() {
    constexpr int n = state_size<Axes>;
    const auto arc = sample_arc<Axes>(10);
    const Chain<Axes> smoothed = Chain<Axes>(arc, singer_with_error);
    const DenseSolution dense = solve_dense<Axes>(arc, singer_with_error);
    RandomGenerator random(5);
    double largest = 0.0;
    for (std::size_t s = 0; s < arc.size(); ++s)
        for (std::size_t count = 1; s + count <= arc.size(); ++count) {
            Gradients<Axes> gradients(count);
            Eigen::VectorXd all = Eigen::VectorXd::Zero(dense.states.size());
            for (std::size_t i = 0; i < count; ++i) {
                const auto at = static_cast<Eigen::Index>(s + i) * n;
                for (int j = 0; j < n; ++j)
                    gradients[i](j) = random.normal() / std::sqrt(dense.covariance(at + j, at + j));
                all.segment(at, n) = gradients[i];
            }
            const double expected = all.dot(dense.covariance * all);
            largest = std::max(largest, std::abs(smoothed.variance(s, gradients) / expected - 1.0));
        }
    EXPECT_LT(largest, 3e-8);
}

TEST(Smoother, VarianceOfAnyFunctionalIsThatOfTheDenseSolution) {
    expect_variance_of_dense<1>();
    expect_variance_of_dense<2>();
}

TEST(Smoother, VarianceOfADifferenceIsThatOfBothEndsLessTheirCovariance) {
    const auto arc = sample_arc<2>(80);
    const Chain<2> smoothed = Chain<2>(arc, singer_with_error);
    StateVector<2> u;
    u << 0.6, 0.8, 0.1, -0.2, 0.02, 0.03, 0.5, -0.4;
    for (const auto& [s, e] : {std::pair(0U, 79U), std::pair(20U, 50U), std::pair(30U, 31U)}) {
        Gradients<2> gradients(e - s + 1, StateVector<2>::Zero());
        gradients.front() = -u;
        gradients.back() = u;
        const StateMatrix<2> cross = smoothed.cross_covariance(s, e);
        const double expected = u.dot((smoothed.state(s).covariance + smoothed.state(e).covariance -
                                       cross - cross.transpose()) *
                                      u);
        EXPECT_NEAR(smoothed.variance(s, gradients) / expected, 1.0, 1e-12) << s << " " << e;
    }
    // Without the covariance between the ends it would be another figure.
    Gradients<2> gradients(31, StateVector<2>::Zero());
    gradients.front() = -u;
    gradients.back() = u;
    const double apart = u.dot((smoothed.state(20).covariance + smoothed.state(50).covariance) * u);
    EXPECT_GT(std::abs(apart / smoothed.variance(20, gradients) - 1.0), 1e-3);
}

TEST(Smoother, ErrorKnownToBeSmallChangesNothing) {
    // A size of zero is taken as 10 um; even 50 um changes positions by less than 1 % of 5 mm.
    const auto arc = sample_arc<2>(40);
    EstimationModel model;
    const Chain<2> none = Chain<2>(arc, model);
    model.error = GaussMarkovError::steady(5e-5, 3.0);
    const Chain<2> small = Chain<2>(arc, model);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        EXPECT_LT((none.mean(k) - small.mean(k)).head<2>().norm(), 5e-5) << k;
        EXPECT_NEAR(small.state(k).covariance(0, 0) / none.state(k).covariance(0, 0), 1.0, 1e-2);
    }
}

/// An arc of one axis whose stated standard deviations, from 10 nm to 1 m, and steps, from 0.1 s to
/// 10 s, no covariance of doubles can hold together.
std::vector<ArcEpoch<1>> extreme_arc(std::uint64_t seed) {
    RandomGenerator random(seed);
    std::vector<ArcEpoch<1>> arc(12);
    std::int64_t time_ns = 0;
    for (ArcEpoch<1>& epoch : arc) {
        epoch.time_s = static_cast<double>(time_ns) * 1e-9;
        const double sigma_m = std::pow(10.0, -8.0 * random.uniform());
        epoch.measurement =
            PositionMeasurement<1>{.position = PositionVector<1>(epoch.time_s),
                                   .covariance = PositionMatrix<1>(sigma_m * sigma_m)};
        time_ns += std::llround(std::pow(10.0, 8.0 + 2.0 * random.uniform()));
    }
    return arc;
}

TEST(Smoother, WhereDefinitenessIsLostItIsRestoredOrNamed) {
    EstimationModel model;
    model.motion.jerk_density = 1e-6;
    int estimated = 0;
    int failed = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const auto arc = extreme_arc(seed);
        try {
            const auto states = test::states_of(Chain<1>(arc, model));
            ++estimated;
            const DenseSolution dense = solve_dense<1>(arc, model);
            for (std::size_t k = 0; k < arc.size(); ++k) {
                const auto at = 4 * static_cast<Eigen::Index>(k);
                EXPECT_NEAR(states[k].mean(0), dense.states(at),
                            1e-3 * std::sqrt(dense.covariance(at, at)))
                    << seed << " " << k;
            }
        } catch (const Failure& failure) {
            ++failed;
            EXPECT_NE(failure.where().find("time "), std::string::npos);
            EXPECT_NE(failure.problem().find("not positive definite"), std::string::npos);
        }
    }
    EXPECT_GT(estimated, 0);
    EXPECT_GT(failed, 0);
}

TEST(Smoother, AccuraciesThatCannotBeAreAFailureThatNamesATime) {
    for (const double variance : {std::nan(""), std::numeric_limits<double>::infinity(), -1e-4}) {
        auto arc = sample_arc<2>(20);
        arc[10].measurement->covariance = variance * Eigen::Matrix2d::Identity();
        try {
            Chain<2>(arc, singer_with_error);
            ADD_FAILURE() << variance;
        } catch (const Failure& failure) {
            double time_s = 0.0;
            EXPECT_EQ(std::sscanf(failure.where().c_str(), "time %lf s", &time_s), 1);
            EXPECT_GE(time_s, arc[10].time_s - 1e-3);
            EXPECT_LE(time_s, arc[19].time_s + 1e-3);
            EXPECT_NE(failure.remedy().find("stated standard deviations"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
