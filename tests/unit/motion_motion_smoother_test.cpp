#include <gtest/gtest.h>

#include "core/failure.h"
#include "motion/chain.h"
#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::sample_arc;
using test::singer_with_error;

/// Differences of states and variances from the RTS smoother's, in standard deviations.
template <int Axes>
void expect_as_by_rts(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model) {
    const Chain<Axes> expected = Chain<Axes>(arc, model);
    MotionSmoother<Axes> at(arc, model);
    EXPECT_NEAR(at.innovation_sum(), expected.innovation_sum, 1e-9 * expected.innovation_sum);
    EXPECT_EQ(at.measurements(), expected.measurements);
    std::size_t k = arc.size();
    for (; !at.done(); at.step_back()) {
        ASSERT_EQ(at.epoch(), --k);
        const StateEstimate<Axes>& state = expected.states[k];
        const StateVector<Axes> sigma = state.covariance.diagonal().cwiseSqrt();
        const StateVector<Axes> off = (at.mean() - state.mean).cwiseQuotient(sigma);
        EXPECT_LT(off.cwiseAbs().maxCoeff(), 1e-7) << "epoch " << k;
        const StateVector<Axes> inverse = sigma.cwiseInverse();
        const StateMatrix<Axes> difference =
            inverse.asDiagonal() * (at.covariance() - state.covariance) * inverse.asDiagonal();
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-7) << "epoch " << k;
        for (const int kind : {0, 1, 2}) {
            const PositionMatrix<Axes> block =
                state.covariance.template block<Axes, Axes>(kind * Axes, kind * Axes);
            EXPECT_TRUE(at.covariance(kind).isApprox(block, 1e-7)) << "epoch " << k;
        }
    }
    EXPECT_EQ(k, 0U);
}

TEST(MotionSmoother, IsTheSmootherOnOneAxisAndInThePlane) {
    // Less than a piece, a piece, and several with a rest.
    for (const std::size_t epochs : {1U, 5U, 255U, 256U, 257U, 700U}) {
        expect_as_by_rts<1>(sample_arc<1>(epochs), singer_with_error);
        expect_as_by_rts<2>(sample_arc<2>(epochs), singer_with_error);
    }
}

TEST(MotionSmoother, IsTheSmootherAcrossStepsAndGaps) {
    std::vector<ArcEpoch<2>> arc = sample_arc<2>(600, 256);
    arc[100].step_before = true;
    arc[512].step_before = true;
    for (std::size_t k = 300; k < 340; ++k)
        arc[k].measurement.reset();
    EstimationModel persistent = singer_with_error;
    persistent.motion.acceleration_time_s = std::numeric_limits<double>::infinity();
    expect_as_by_rts<2>(arc, persistent);
    expect_as_by_rts<2>(arc, singer_with_error);
}

TEST(MotionSmoother, IsTheSmootherWhereTheMotionChanges) {
    std::vector<ArcEpoch<2>> arc = test::with_changing_motion(sample_arc<2>(600, 256));
    expect_as_by_rts<2>(arc, singer_with_error);
    // Vague states, which are smoothed by RTS itself.
    arc[100].step_before = true;
    for (std::size_t k = 300; k < 340; ++k)
        arc[k].measurement.reset();
    arc = test::at_equal_steps(arc);
    expect_as_by_rts<2>(arc, singer_with_error);
}

TEST(MotionSmoother, AccuraciesThatCannotBeAreAFailureThatNamesATime) {
    std::vector<ArcEpoch<2>> arc = sample_arc<2>(20);
    arc[10].measurement->covariance(0, 1) = arc[10].measurement->covariance(1, 0) = 1.0;
    try {
        MotionSmoother<2> smoother(arc, singer_with_error);
        FAIL();
    } catch (const Failure& failure) {
        EXPECT_NE(std::string(failure.what()).find("time 3.0"), std::string::npos)
            << failure.what();
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
