#include <gtest/gtest.h>

#include <cmath>

#include "motion/likelihood.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::at_equal_steps;
using test::Quad;
using test::QuadMatrix;
using test::QuadVector;
using test::sample_arc;
using test::singer_with_error;
using test::with_changing_motion;

template <int Axes>
InnovationSums sums_of(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model) {
    const std::span<const ArcEpoch<Axes>> arcs[] = {arc};
    return innovation_sums<Axes>(arcs, model);
}

/// Statistic and log determinant of the joint normal distribution of the first measurements of an
/// arc, stacked.
struct JointNormal {
    Quad statistic = 0;
    Quad log_determinant = 0;
    int values = 0;
};

template <int Axes>
JointNormal joint_of_first(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model,
                           int measurements) {
    constexpr int n = state_size<Axes>;
    const auto prior = KalmanFilter<Axes>(model).prior(arc[0].measurement->position);
    const auto rows = static_cast<Eigen::Index>(measurements) * Axes;
    QuadMatrix design = QuadMatrix::Zero(Axes, n);
    design.leftCols(Axes).setIdentity();
    design.rightCols(Axes).setIdentity();
    // Covariance between the state of now and each measurement so far, and of these.
    QuadMatrix state = prior.covariance.template cast<Quad>();
    QuadVector mean = prior.mean.template cast<Quad>();
    QuadMatrix with_past = QuadMatrix::Zero(n, rows);
    QuadMatrix covariance = QuadMatrix::Zero(rows, rows);
    QuadVector residual = QuadVector::Zero(rows);
    Eigen::Index at = 0;
    for (std::size_t k = 0; at < rows; ++k) {
        if (k > 0) {
            const AxisStep step = test::step_between(model, arc[k - 1], arc[k]);
            const QuadMatrix f = transition<Axes>(step).template cast<Quad>();
            const QuadMatrix noise = process_noise<Axes>(step).template cast<Quad>();
            state = (f * state * f.transpose() + noise).eval();
            with_past = (f * with_past).eval();
            mean = (f * mean).eval();
        }
        if (!arc[k].measurement) continue;
        const QuadMatrix seen = design * with_past.leftCols(at);
        covariance.block(at, 0, Axes, at) = seen;
        covariance.block(0, at, at, Axes) = seen.transpose();
        covariance.block(at, at, Axes, Axes) =
            design * state * design.transpose() +
            Quad(model.measurement_scale) * model.measurement_scale *
                arc[k].measurement->covariance.template cast<Quad>();
        residual.segment(at, Axes) =
            arc[k].measurement->position.template cast<Quad>() - design * mean;
        with_past.middleCols(at, Axes) = state * design.transpose();
        at += Axes;
    }
    const Eigen::LLT<QuadMatrix> factor(covariance);
    JointNormal joint;
    joint.values = measurements * Axes;
    joint.statistic = residual.dot(factor.solve(residual));
    for (Eigen::Index i = 0; i < rows; ++i)
        joint.log_determinant += 2 * log(Quad(factor.matrixLLT()(i, i)));
    return joint;
}

template <int Axes>
void expect_conditional_density(const EstimationModel& model,
                                const std::vector<ArcEpoch<Axes>>& arc) {
    const InnovationSums sums = sums_of(arc, model);
    const JointNormal all = joint_of_first(arc, model, 13);
    const JointNormal first = joint_of_first(arc, model, measurements_of_the_prior);
    const auto statistic = static_cast<double>(Quad(all.statistic - first.statistic));
    const auto determinant = static_cast<double>(Quad(all.log_determinant - first.log_determinant));
    EXPECT_EQ(sums.values, all.values - first.values);
    EXPECT_NEAR(sums.statistic / statistic, 1.0, 1e-9);
    EXPECT_NEAR(sums.log_determinant / determinant, 1.0, 1e-11);
    EXPECT_NEAR(sums.log_likelihood() / (-0.5 * (statistic + determinant)), 1.0, 1e-9);
}

TEST(Likelihood, IsTheDensityOfTheMeasurementsGivenTheFirstThree) {
    EstimationModel white;
    white.motion.jerk_density = 0.6;
    for (const EstimationModel& model : {white, singer_with_error})
        for (const std::size_t missing : {2U, 7U}) {
            expect_conditional_density(model, sample_arc<1>(14, missing));
            expect_conditional_density(model, sample_arc<2>(14, missing));
            expect_conditional_density(model, with_changing_motion(sample_arc<2>(14, missing)));
            expect_conditional_density(
                model, with_changing_motion(at_equal_steps(sample_arc<2>(14, missing))));
        }
}

/// An arc whose positions are as accurate east as north, but for rounding.
std::vector<ArcEpoch<2>> with_axes_alike(std::vector<ArcEpoch<2>> arc, double rounding) {
    for (ArcEpoch<2>& epoch : arc)
        if (epoch.measurement) {
            Eigen::Matrix2d& covariance = epoch.measurement->covariance;
            covariance = covariance(0, 0) * Eigen::Matrix2d::Identity();
            covariance(1, 1) *= 1.0 + rounding;
        }
    return arc;
}

TEST(Likelihood, OfAxesThatAreAlikeIsThatOfBoth) {
    expect_conditional_density(singer_with_error, with_axes_alike(sample_arc<2>(14, 7), 0.0));
    expect_conditional_density(singer_with_error, with_axes_alike(sample_arc<2>(14, 7), 1e-3));
    const InnovationSums same = sums_of(with_axes_alike(sample_arc<2>(60), 0.0), singer_with_error);
    const InnovationSums rounded =
        sums_of(with_axes_alike(sample_arc<2>(60), 1e-7), singer_with_error);
    EXPECT_NEAR(rounded.log_likelihood(), same.log_likelihood(), 1e-5);
}

/// The same sums from the filter in plain form.
template <int Axes>
InnovationSums plain_sums(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model) {
    InnovationSums sums;
    KalmanFilter<Axes> filter(model);
    filter_along<Axes>(filter, std::span<const ArcEpoch<Axes>>(arc),
                       [&](std::size_t, const StateEstimate<Axes>&, const Innovation<Axes>* seen,
                           const StateEstimate<Axes>&) {
                           if (!seen || !seen->tests_model) return;
                           sums.statistic += seen->statistic();
                           for (const auto& one : seen->coordinates.values)
                               sums.log_determinant += std::log(one.variance);
                           sums.values += Axes;
                       });
    return sums;
}

template <int Axes>
void expect_as_plain(const std::vector<ArcEpoch<Axes>>& arc) {
    std::vector<EstimationModel> models(5, singer_with_error);
    models[1].motion = {.jerk_density = 0.01};
    models[2].measurement_scale = 0.02;
    models[3].error = GaussMarkovError::steady(0.0, 0.5);
    models[4].error = test::growing_error;
    const std::span<const ArcEpoch<Axes>> arcs[] = {arc};
    const std::vector<InnovationSums> together = innovation_sums_of<Axes>(arcs, models);
    ASSERT_EQ(together.size(), models.size());
    for (std::size_t i = 0; i < models.size(); ++i) {
        const InnovationSums alone = innovation_sums<Axes>(arcs, models[i]);
        EXPECT_EQ(together[i].statistic, alone.statistic);
        EXPECT_EQ(together[i].log_determinant, alone.log_determinant);
        EXPECT_EQ(together[i].values, alone.values);
        const InnovationSums plain = plain_sums(arc, models[i]);
        EXPECT_NEAR(alone.statistic / plain.statistic, 1.0, 1e-9);
        EXPECT_NEAR(alone.log_determinant / plain.log_determinant, 1.0, 1e-10);
        EXPECT_EQ(alone.values, plain.values);
    }
}

TEST(Likelihood, OfSeveralModelsTogetherIsThatOfEachAndOfTheFilterInPlainForm) {
    expect_as_plain(sample_arc<1>(400));
    expect_as_plain(sample_arc<2>(400));
    expect_as_plain(with_changing_motion(sample_arc<2>(400)));
}

TEST(Likelihood, AStepOfAnotherMotionIsThatOfAModelWithItsDensity) {
    auto arc = sample_arc<2>(60);
    EstimationModel harder = singer_with_error;
    harder.motion.jerk_density *= 4.0;
    const InnovationSums expected = sums_of(arc, harder);
    for (ArcEpoch<2>& epoch : arc)
        epoch.jerk_factor = 4.0;
    const InnovationSums sums = sums_of(arc, singer_with_error);
    EXPECT_NEAR(sums.statistic / expected.statistic, 1.0, 1e-11);
    EXPECT_NEAR(sums.log_determinant / expected.log_determinant, 1.0, 1e-12);
    EXPECT_GT(
        std::abs(expected.statistic / sums_of(sample_arc<2>(60), singer_with_error).statistic -
                 1.0),
        0.01);
}

TEST(Likelihood, AlongAnArcIsWhatEachStretchAddsToThatOfItsBeginning) {
    const auto arc = sample_arc<2>(400);
    std::vector<EstimationModel> models(3, singer_with_error);
    models[1].motion.jerk_density = 0.01;
    models[2].measurement_scale = 0.2;
    // Within the first measurements, of one epoch without a measurement, an epoch twice an end.
    const std::vector<std::size_t> ends{2, 4, 5, 60, 60, 211, 400};
    for (const auto& one : {arc, with_changing_motion(arc)}) {
        const std::span<const ArcEpoch<2>> whole(one);
        const auto along = innovation_sums_along<2>(whole, models, ends);
        ASSERT_EQ(along.size(), models.size());
        for (std::size_t i = 0; i < models.size(); ++i) {
            ASSERT_EQ(along[i].size(), ends.size());
            InnovationSums sum;
            for (std::size_t b = 0; b < ends.size(); ++b) {
                sum.statistic += along[i][b].statistic;
                sum.log_determinant += along[i][b].log_determinant;
                sum.values += along[i][b].values;
                const std::span<const ArcEpoch<2>> beginning[] = {whole.first(ends[b])};
                const InnovationSums expected = innovation_sums<2>(beginning, models[i]);
                EXPECT_EQ(sum.values, expected.values);
                EXPECT_NEAR(sum.statistic, expected.statistic, 1e-9 * expected.statistic);
                EXPECT_NEAR(sum.log_determinant, expected.log_determinant, 1e-9);
            }
            EXPECT_EQ(along[i][2].values, 0) << "one epoch without a measurement";
            EXPECT_EQ(along[i][4].statistic, 0.0) << "an empty stretch";
            EXPECT_GT(along[i][6].statistic, 0.0);
        }
    }
}

TEST(Likelihood, LeavesOutThreeMeasurementsOfEachArc) {
    EXPECT_EQ(sums_of(sample_arc<2>(3), singer_with_error).values, 0);
    EXPECT_EQ(sums_of(sample_arc<2>(3), singer_with_error).statistic, 0.0);
    EXPECT_EQ(sums_of(sample_arc<2>(4), singer_with_error).values, 2);
    // The fifth epoch has no measurement.
    EXPECT_EQ(sums_of(sample_arc<2>(6), singer_with_error).values, 4);
}

TEST(Likelihood, OfTwoArcsIsTheProductOfBoth) {
    const auto one = sample_arc<2>(20);
    const auto other = sample_arc<2>(35, 11);
    const std::span<const ArcEpoch<2>> arcs[] = {one, other};
    const InnovationSums both = innovation_sums<2>(arcs, singer_with_error);
    const InnovationSums first = sums_of(one, singer_with_error);
    const InnovationSums second = sums_of(other, singer_with_error);
    EXPECT_NEAR(both.log_likelihood(), first.log_likelihood() + second.log_likelihood(), 1e-10);
    EXPECT_NEAR(both.statistic, first.statistic + second.statistic, 1e-11);
    EXPECT_EQ(both.values, first.values + second.values);
}

/// All variances of a model multiplied by the square of a scale.
EstimationModel scaled(EstimationModel model, double scale) {
    model.measurement_scale *= scale;
    model.motion.jerk_density *= scale;
    model.error.process_density *= scale;
    model.error.initial_sigma_m *= scale;
    return model;
}

TEST(Likelihood, AtBestScaleIsTheMaximumOverTheScale) {
    const auto arc = sample_arc<2>(60);
    const InnovationSums sums = sums_of(arc, singer_with_error);
    const double best = std::sqrt(sums.statistic / static_cast<double>(sums.values));
    ASSERT_GT(std::abs(best - 1.0), 0.05);
    // By the filter itself, with the model at that scale. The prior keeps its size, which is why
    // the two agree to its little information alone.
    const double at_best = sums_of(arc, scaled(singer_with_error, best)).log_likelihood();
    EXPECT_NEAR(at_best, sums.log_likelihood_at_best_scale(), 1e-3);
    for (const double off : {0.5, 0.9, 0.99, 1.01, 1.1, 2.0}) {
        const double there = sums_of(arc, scaled(singer_with_error, best * off)).log_likelihood();
        const auto n = static_cast<double>(sums.values);
        EXPECT_LT(there, at_best) << off;
        EXPECT_NEAR(at_best - there, n * (std::log(off) + 0.5 / (off * off) - 0.5), 1e-2) << off;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
