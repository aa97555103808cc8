#include <gtest/gtest.h>

#include "estimation/sensitivity.h"
#include "estimation_test_support.h"

namespace runcert {
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
    const SmoothedArc<2> smoothed = smooth<2>(arc, model);
    double sum = 0.0;
    const Gradients<2> gradients = uneven();
    for (std::size_t i = 0; i < gradients.size(); ++i)
        sum += gradients[i].dot(smoothed.states[s + i].mean);
    return sum;
}

TEST(Sensitivity, IsWhatMovingOneMeasurementDoes) {
    // The smoother is linear: a difference of any size is the derivative.
    auto arc = test::sample_arc<2>(25);
    for (const std::size_t s : {std::size_t{0}, std::size_t{10}, std::size_t{22}}) {
        const auto weights = sensitivities<2>(arc, test::singer_with_error,
                                              smooth<2>(arc, test::singer_with_error), s, uneven());
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
    const auto weights = sensitivities<2>(
        arc, test::singer_with_error, smooth<2>(arc, test::singer_with_error), 15, displacement);
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& weight : weights)
        sum += weight;
    EXPECT_LT(sum.norm(), 1e-6);
}

}  // namespace
}  // namespace runcert
