#include <gtest/gtest.h>

#include <cmath>

#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::sample_arc;
using test::singer_with_error;
using test::solve_dense;

template <int Axes>
std::vector<StateEstimate<Axes>> filtered(std::span<const ArcEpoch<Axes>> arc) {
    std::vector<StateEstimate<Axes>> states;
    KalmanFilter<Axes> filter(singer_with_error);
    filter_along<Axes>(filter, arc,
                       [&](std::size_t, const StateEstimate<Axes>&, const Innovation<Axes>*,
                           const StateEstimate<Axes>& after) { states.push_back(after); });
    return states;
}

/// Largest difference of the means, in units of the reference's standard deviations, and of the
/// covariances, in those of its correlations.
template <int Axes>
double largest_difference(const StateEstimate<Axes>& found, const StateEstimate<Axes>& reference) {
    const StateVector<Axes> inverse = reference.covariance.diagonal().cwiseSqrt().cwiseInverse();
    const StateVector<Axes> mean = inverse.cwiseProduct(found.mean - reference.mean);
    const StateMatrix<Axes> covariance =
        inverse.asDiagonal() * (found.covariance - reference.covariance) * inverse.asDiagonal();
    return std::max(mean.cwiseAbs().maxCoeff(), covariance.cwiseAbs().maxCoeff());
}

template <int Axes>
void expect_filter_and_smoother_at_the_ends() {
    const auto arc = sample_arc<Axes>(30);
    const auto filter = filtered<Axes>(arc);
    const auto smoother = test::states_of(Chain<Axes>(arc, singer_with_error));
    const auto no_lag = Chain<Axes>(arc, singer_with_error).fixed_lag(0);
    ASSERT_EQ(no_lag.size(), 30U);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        EXPECT_EQ(no_lag[k].mean, filter[k].mean) << k;
        EXPECT_EQ(no_lag[k].covariance, filter[k].covariance) << k;
    }
    for (const std::size_t lag : {std::size_t{29}, std::size_t{30}, std::size_t{1000}, SIZE_MAX}) {
        const auto states = Chain<Axes>(arc, singer_with_error).fixed_lag(lag);
        ASSERT_EQ(states.size(), 30U);
        for (std::size_t k = 0; k < arc.size(); ++k)
            EXPECT_LT(largest_difference(states[k], smoother[k]), 1e-12) << k;
    }
}

TEST(FixedLag, IsTheFilterWithoutALagAndTheSmootherWithALongOne) {
    expect_filter_and_smoother_at_the_ends<1>();
    expect_filter_and_smoother_at_the_ends<2>();
}

TEST(FixedLag, KnowsTheMeasurementsUpToTheLagAndNoOther) {
    // The state of epoch k with lag 5 is that of an arc that ends at k + 5: by the dense solution
    // of that arc; what comes later changes nothing.
    const auto arc = sample_arc<2>(16, 9);
    const auto states = Chain<2>(arc, singer_with_error).fixed_lag(5);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const std::span<const ArcEpoch<2>> known(arc.data(), std::min<std::size_t>(k + 6, 16));
        const auto dense = solve_dense<2>(known, singer_with_error);
        const auto at = 8 * static_cast<Eigen::Index>(k);
        StateEstimate<2> expected;
        expected.mean = dense.states.segment<8>(at);
        expected.covariance = dense.covariance.block<8, 8>(at, at);
        EXPECT_LT(largest_difference(states[k], expected), 1e-7) << k;
        auto later = arc;
        for (std::size_t j = k + 6; j < arc.size(); ++j)
            if (later[j].measurement) later[j].measurement->position.array() += 1.0;
        const auto same = Chain<2>(later, singer_with_error).fixed_lag(5)[k];
        EXPECT_EQ(same.mean, states[k].mean) << k;
    }
}

TEST(FixedLag, VarianceFallsWithTheLag) {
    const auto arc = sample_arc<2>(60);
    std::vector<StateEstimate<2>> before = Chain<2>(arc, singer_with_error).fixed_lag(0);
    for (std::size_t lag = 1; lag < 60; ++lag) {
        const auto states = Chain<2>(arc, singer_with_error).fixed_lag(lag);
        for (std::size_t k = 0; k < arc.size(); ++k)
            for (int i = 0; i < 8; ++i)
                EXPECT_LE(states[k].covariance(i, i), before[k].covariance(i, i) * (1.0 + 1e-8))
                    << lag << " " << k << " " << i;
        // An epoch that is known to the lag's end gains by each further measurement.
        EXPECT_LT(states[20].covariance(0, 0) / before[20].covariance(0, 0),
                  lag < 10 ? 1.0 - 1e-6 : 1.0 + 1e-9)
            << lag;
        before = states;
    }
}

TEST(FixedLag, OfFourSecondsIsAlmostTheSmoother) {
    RandomGenerator random(3);
    const auto arc = test::simulate_arc<2>(singer_with_error, 200, 0.1, 0.003, random).arc;
    const auto smoother = test::states_of(Chain<2>(arc, singer_with_error));
    const auto states = Chain<2>(arc, singer_with_error).fixed_lag(40);
    double largest = 0.0;
    for (std::size_t k = 0; k < arc.size(); ++k)
        largest = std::max(largest, largest_difference(states[k], smoother[k]));
    // A thousandth of a standard deviation.
    EXPECT_LT(largest, 1e-3);
}

TEST(FixedLag, OfOneEpochIsTheFilter) {
    const auto arc = sample_arc<2>(1);
    const auto states = Chain<2>(arc, singer_with_error).fixed_lag(3);
    ASSERT_EQ(states.size(), 1U);
    EXPECT_EQ(states[0].mean, filtered<2>(arc)[0].mean);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
