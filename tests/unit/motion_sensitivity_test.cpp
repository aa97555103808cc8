#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A functional that weighs positions, velocities and errors of three states unevenly.
Gradients<2> uneven() {
    Gradients<2> gradients(3, StateVector<2>::Zero());
    gradients[0] << 0.5, -1.0, 0.2, 0.0, 0.0, 0.1, 0.3, 0.0;
    gradients[1] << 0.0, 0.0, -0.7, 0.4, 0.0, 0.0, 0.0, 0.2;
    gradients[2] << -0.5, 2.0, 0.0, 0.3, 0.05, 0.0, 0.0, -0.6;
    return gradients;
}

double value(const std::vector<ArcEpoch<2>>& arc, const EstimationModel& model, std::size_t s) {
    const Chain<2> smoothed = Chain<2>(arc, model);
    double sum = 0.0;
    const Gradients<2> gradients = uneven();
    for (std::size_t i = 0; i < gradients.size(); ++i)
        sum += gradients[i].dot(smoothed.mean(s + i));
    return sum;
}

TEST(Sensitivity, IsWhatMovingOneMeasurementDoes) {
    // The smoother is linear: a difference of any size is the derivative.
    auto arc = test::sample_arc<2>(25);
    for (const std::size_t s : {std::size_t{0}, std::size_t{10}, std::size_t{22}}) {
        const auto weights = Chain<2>(arc, test::singer_with_error).weights(s, uneven());
        ASSERT_EQ(weights.size(), arc.size());
        const double before = value(arc, test::singer_with_error, s);
        // The prior's mean is the first measurement itself; moving it moves that too.
        for (std::size_t k = 1; k < arc.size(); ++k) {
            if (!arc[k].measurement) {
                EXPECT_EQ(weights[k].norm(), 0.0);
                continue;
            }
            for (int axis = 0; axis < 2; ++axis) {
                auto moved = arc;
                moved[k].measurement->position(axis) += 1.0;
                EXPECT_NEAR(weights[k](axis), value(moved, test::singer_with_error, s) - before,
                            2e-7)
                    << "epoch " << k << ", functional from " << s;
            }
        }
    }
}

TEST(Sensitivity, ADisplacementDoesNotFollowAShiftOfAllPositions) {
    const auto arc = test::sample_arc<2>(40);
    Gradients<2> displacement(11, StateVector<2>::Zero());
    displacement.front()(0) = -1.0;
    displacement.back()(0) = 1.0;
    const auto weights = Chain<2>(arc, test::singer_with_error).weights(15, displacement);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& weight : weights)
        sum += weight;
    EXPECT_LT(sum.norm(), 1e-6);
}

/// Covariance of a Gauss-Markov error between two epochs, the later one second.
double covariance_between(const GaussMarkovError& error, double start_s, double a_s, double b_s) {
    const double steady_m2 = 0.5 * error.tau_s * error.process_density * error.process_density;
    const double initial_m2 = error.initial_sigma_m * error.initial_sigma_m;
    const double at_a_m2 =
        steady_m2 + (initial_m2 - steady_m2) * std::exp(-2.0 * (a_s - start_s) / error.tau_s);
    return at_a_m2 * std::exp(-(b_s - a_s) / error.tau_s);
}

/// An arc whose steps have all kinds of lengths, and weights of any sign.
struct Weighted {
    std::vector<ArcEpoch<2>> arc;
    std::vector<Eigen::Vector2d> weights;

    explicit Weighted(std::uint64_t seed) {
        RandomGenerator random(seed);
        arc = test::with_changing_motion(test::sample_arc<2>(60, 20));
        for (std::size_t k = 30; k < arc.size(); ++k)
            arc[k].time_s = arc[k - 1].time_s + (k < 45 ? 0.1 : 5.0 * random.uniform());
        for (const ArcEpoch<2>& epoch : arc)
            weights.push_back(epoch.measurement ? Eigen::Vector2d(random.normal(), random.normal())
                                                : Eigen::Vector2d::Zero().eval());
    }
    double variance(const GaussMarkovError& error) const {
        return weighted_variance<2>(arc, error, weights);
    }
};

TEST(WeightedVariance, OfASlowErrorIsThatOfItsCovarianceBetweenAllEpochs) {
    const Weighted one(3);
    for (const GaussMarkovError& error :
         {GaussMarkovError::steady(0.008, 2.0), test::growing_error}) {
        double expected = 0.0;
        for (std::size_t k = 0; k < one.arc.size(); ++k)
            for (std::size_t l = 0; l < one.arc.size(); ++l)
                expected += one.weights[k].dot(one.weights[l]) *
                            covariance_between(error, one.arc.front().time_s,
                                               one.arc[std::min(k, l)].time_s,
                                               one.arc[std::max(k, l)].time_s);
        EXPECT_NEAR(one.variance(error) / expected, 1.0, 1e-10);
    }
}

TEST(WeightedVariance, OfWhiteNoiseIsThatOfTheStatedCovariances) {
    const Weighted one(3);
    double expected = 0.0;
    for (std::size_t k = 0; k < one.arc.size(); ++k)
        if (k != 20)
            expected +=
                1.69 * one.weights[k].dot(one.arc[k].measurement->covariance * one.weights[k]);
    EXPECT_NEAR(weighted_variance<2>(one.arc, 1.3, one.weights) / expected, 1.0, 1e-12);
}

TEST(WeightedVariance, OfEstimatesWeightsAndMotionIsThatOfTheSmoother) {
    // The weights of a speed hold all that its variance has of the errors: what is left is the
    // motion's, which a model with hardly any motion does not have.
    const auto arc = test::sample_arc<2>(60, 20);
    EstimationModel model = test::singer_with_error;
    const auto parts = [&](double jerk_density) {
        model.motion.jerk_density = jerk_density;
        const Chain<2> smoothed = Chain<2>(arc, model);
        Gradients<2> gradients(31, StateVector<2>::Zero());
        gradients.front()(0) = -1.0 / 3.0;
        gradients.back()(0) = 1.0 / 3.0;
        const auto weights = smoothed.weights(15, gradients);
        return std::pair(smoothed.variance(15, gradients),
                         weighted_variance<2>(arc, model.measurement_scale, weights) +
                             weighted_variance<2>(arc, model.error, weights));
    };
    const auto [stiff, stiff_errors] = parts(1e-6);
    EXPECT_NEAR(stiff_errors / stiff, 1.0, 1e-3);
    const auto [soft, soft_errors] = parts(3.0);
    EXPECT_LT(soft_errors, 0.99 * soft);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
