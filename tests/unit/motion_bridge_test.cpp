#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "motion/linear_smoother.h"
#include "motion/smoother.h"
#include "motion/speed.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::Quad;
using test::QuadMatrix;
using test::QuadVector;
using test::sample_arc;
using test::simulate_arc;
using test::singer_with_error;

EstimationModel white_model() {
    EstimationModel model;
    model.motion.jerk_density = 0.6;
    return model;
}

EstimationModel bounding_model() {
    EstimationModel model = singer_with_error;
    model.error = GaussMarkovError::bounding(0.008, 0.5, 10.0);
    return model;
}

/// The arc with measured positions offset from an epoch on, and the step bridged.
template <int Axes>
std::vector<ArcEpoch<Axes>> with_step(std::vector<ArcEpoch<Axes>> arc, std::size_t at,
                                      double offset_m) {
    arc[at].step_before = true;
    for (std::size_t k = at; k < arc.size(); ++k)
        if (arc[k].measurement) arc[k].measurement->position.array() += offset_m;
    return arc;
}

/// An arc with two bridged steps, one of them before an epoch without a measurement.
template <int Axes>
std::vector<ArcEpoch<Axes>> arc_with_two_steps() {
    return with_step<Axes>(with_step<Axes>(sample_arc<Axes>(13), 4, 0.5), 9, -0.3);
}

/// Means and covariance of all states of an arc, positions free of the offsets, then of the
/// offsets: the offsets are unknowns of the measurements, and the states know nothing of them.
struct DenseBridged {
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
};

template <int Axes>
DenseBridged solve_dense_with_offsets(std::span<const ArcEpoch<Axes>> arc,
                                      const EstimationModel& model) {
    constexpr int n = state_size<Axes>;
    const auto states = static_cast<Eigen::Index>(arc.size()) * n;
    Eigen::Index size = states;
    for (const ArcEpoch<Axes>& epoch : arc)
        if (epoch.step_before) size += Axes;
    QuadMatrix normal = QuadMatrix::Zero(size, size);
    QuadVector right = QuadVector::Zero(size);
    const auto prior = KalmanFilter<Axes>(model).prior(arc[0].measurement->position);
    const QuadMatrix prior_weight = prior.covariance.template cast<Quad>().inverse();
    normal.topLeftCorner(n, n) += prior_weight;
    right.head(n) += prior_weight * prior.mean.template cast<Quad>();
    for (Eigen::Index i = states; i < size; ++i)
        normal(i, i) += Quad(1) / (Quad(100) * 100);
    Eigen::Index offsets = 0;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const auto at = static_cast<Eigen::Index>(k) * n;
        if (arc[k].step_before) offsets += Axes;
        if (arc[k].measurement) {
            QuadMatrix design = QuadMatrix::Zero(Axes, size);
            design.middleCols(at, Axes).setIdentity();
            design.middleCols(at + 3 * Axes, Axes).setIdentity();
            for (Eigen::Index i = 0; i < offsets; ++i)
                design(i % Axes, states + i) = 1;
            const Quad scale = Quad(model.measurement_scale) * model.measurement_scale;
            const QuadMatrix weight =
                (scale * arc[k].measurement->covariance.template cast<Quad>()).inverse();
            normal += design.transpose() * weight * design;
            right +=
                design.transpose() * (weight * arc[k].measurement->position.template cast<Quad>());
        }
        if (k == 0) continue;
        const AxisStep step = axis_step(model, test::step_s(arc[k - 1], arc[k]));
        QuadMatrix row(n, 2 * n);
        row << (-transition<Axes>(step)).template cast<Quad>(), QuadMatrix::Identity(n, n);
        const QuadMatrix noise = process_noise<Axes>(step).template cast<Quad>();
        const QuadMatrix weight = (noise + noise.transpose()).inverse() * Quad(2);
        normal.block(at - n, at - n, 2 * n, 2 * n) += row.transpose() * weight * row;
    }
    const Eigen::LLT<QuadMatrix> factor(normal);
    return {.mean = factor.solve(right).template cast<double>(),
            .covariance = factor.solve(QuadMatrix::Identity(size, size)).template cast<double>()};
}

/// The same with the offsets in the positions, as the smoother has them, and states alone.
template <int Axes>
DenseBridged in_offset_frame(std::span<const ArcEpoch<Axes>> arc, const DenseBridged& dense) {
    const auto states = static_cast<Eigen::Index>(arc.size()) * state_size<Axes>;
    Eigen::MatrixXd map = Eigen::MatrixXd::Identity(states, dense.mean.size());
    Eigen::Index offsets = 0;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (arc[k].step_before) offsets += Axes;
        for (Eigen::Index i = 0; i < offsets; ++i)
            map(static_cast<Eigen::Index>(k) * state_size<Axes> + i % Axes, states + i) = 1.0;
    }
    return {.mean = map * dense.mean, .covariance = map * dense.covariance * map.transpose()};
}

template <int Axes>
void expect_states_of_dense(const EstimationModel& model) {
    constexpr int n = state_size<Axes>;
    const auto arc = arc_with_two_steps<Axes>();
    const SmoothedArc<Axes> smoothed = smooth<Axes>(arc, model);
    const DenseBridged dense =
        in_offset_frame<Axes>(arc, solve_dense_with_offsets<Axes>(arc, model));
    const Eigen::VectorXd sigma = dense.covariance.diagonal().cwiseSqrt();
    double mean = 0.0;
    double covariance = 0.0;
    for (std::size_t s = 0; s < arc.size(); ++s) {
        const auto at = static_cast<Eigen::Index>(s) * n;
        const Eigen::VectorXd inverse = sigma.segment(at, n).cwiseInverse();
        const Eigen::VectorXd difference = smoothed.states[s].mean - dense.mean.segment(at, n);
        mean = std::max(mean, difference.cwiseProduct(inverse).cwiseAbs().maxCoeff());
        for (std::size_t e = s; e < arc.size(); ++e) {
            const auto to = static_cast<Eigen::Index>(e) * n;
            const Eigen::MatrixXd of_both =
                smoothed.cross_covariance(s, e) - dense.covariance.block(at, to, n, n);
            covariance = std::max(covariance, (inverse.asDiagonal() * of_both *
                                               sigma.segment(to, n).cwiseInverse().asDiagonal())
                                                  .cwiseAbs()
                                                  .maxCoeff());
        }
    }
    EXPECT_LT(mean, 3e-8);
    EXPECT_LT(covariance, 2e-7);  // the offset's prior of 1e4 m^2 takes its digits
    EXPECT_EQ(smoothed.repaired, 0);
}

TEST(Bridge, StatesAreThoseOfLeastSquaresWithOffsetsAsUnknowns) {
    for (const EstimationModel& model : {white_model(), singer_with_error, bounding_model()}) {
        expect_states_of_dense<1>(model);
        expect_states_of_dense<2>(model);
    }
}

/// Largest differences from least squares with the offsets as unknowns, between any two epochs: of
/// displacements, relative to their standard uncertainty, and of their covariances, relative.
template <int Axes>
std::pair<double, double> displacement_differences(std::span<const ArcEpoch<Axes>> arc,
                                                   const EstimationModel& model) {
    constexpr Eigen::Index n = state_size<Axes>;
    const SmoothedArc<Axes> smoothed = smooth<Axes>(arc, model);
    const DenseBridged dense = solve_dense_with_offsets<Axes>(arc, model);
    std::pair<double, double> largest;
    for (std::size_t s = 0; s < arc.size(); ++s)
        for (std::size_t e = s + 1; e < arc.size(); ++e) {
            Eigen::MatrixXd map = Eigen::MatrixXd::Zero(2, dense.mean.size());
            map.middleCols(static_cast<Eigen::Index>(s) * n, 2) = -Eigen::Matrix2d::Identity();
            map.middleCols(static_cast<Eigen::Index>(e) * n, 2) = Eigen::Matrix2d::Identity();
            const Eigen::Matrix2d covariance = map * dense.covariance * map.transpose();
            const Eigen::Vector2d displaced = map * dense.mean;
            const double mean =
                (displacement(smoothed, s, e) - displaced).norm() / std::sqrt(covariance.trace());
            const double relative =
                (displacement_covariance(smoothed, s, e) - covariance).norm() / covariance.norm();
            largest = {std::max(largest.first, mean), std::max(largest.second, relative)};
        }
    return largest;
}

TEST(Bridge, DisplacementsAreThoseOfLeastSquaresWithOffsetsAsUnknowns) {
    for (const EstimationModel& model : {white_model(), singer_with_error, bounding_model()}) {
        const auto plane = displacement_differences<2>(arc_with_two_steps<2>(), model);
        EXPECT_LT(plane.first, 1e-6);
        EXPECT_LT(plane.second, 1e-6);
    }
}

TEST(Bridge, DisplacementsHoldOverLongStepsToo) {
    // Over 2 s velocity and acceleration at both ends tell the motion to a decimetre only.
    for (const EstimationModel& model : {white_model(), singer_with_error}) {
        auto arc = arc_with_two_steps<2>();
        for (std::size_t k = 9; k < arc.size(); ++k) {
            arc[k].measurement->position += Eigen::Vector2d(22.0, 26.0 + 4.0 * arc[k].time_s);
            arc[k].time_s += 2.0;
        }
        const auto largest = displacement_differences<2>(arc, model);
        EXPECT_LT(largest.first, 1e-5);
        EXPECT_LT(largest.second, 1e-5);
    }
}

TEST(Bridge, MotionOverAStepIsThatOfHermite) {
    auto arc = sample_arc<1>(6);
    arc[3].step_before = true;
    const double dt_s = test::step_s(arc[2], arc[3]);
    EstimationModel model = white_model();
    for (const double acceleration_time_s : {std::numeric_limits<double>::infinity(), 1e4}) {
        model.motion.acceleration_time_s = acceleration_time_s;
        const SmoothedArc<1> smoothed = smooth<1>(arc, model);
        ASSERT_EQ(smoothed.bridged.size(), 1U);
        const BridgedStep& step = smoothed.bridged[0];
        EXPECT_EQ(step.epoch, 3U);
        EXPECT_NEAR(step.velocity_before_s / (dt_s / 2.0), 1.0, 1e-4);
        EXPECT_NEAR(step.velocity_after_s / (dt_s / 2.0), 1.0, 1e-4);
        EXPECT_NEAR(step.acceleration_before_s2 / (dt_s * dt_s / 12.0), 1.0, 1e-4);
        EXPECT_NEAR(step.acceleration_after_s2 / (-dt_s * dt_s / 12.0), 1.0, 1e-4);
        EXPECT_NEAR(step.variance_m2 / (0.36 * std::pow(dt_s, 5) / 720.0), 1.0, 1e-4);
    }
}

/// First-order uncertainty of a function of all unknowns by numeric derivatives.
template <class Function>
double dense_uncertainty(const DenseBridged& dense, const Function& function) {
    Eigen::VectorXd gradient(dense.mean.size());
    for (Eigen::Index i = 0; i < gradient.size(); ++i) {
        constexpr double h = 1e-4;
        Eigen::VectorXd moved = dense.mean;
        moved(i) += h;
        const double right = function(moved);
        moved(i) -= 2.0 * h;
        gradient(i) = (right - function(moved)) / (2.0 * h);
    }
    return std::sqrt(gradient.dot(dense.covariance * gradient));
}

TEST(Bridge, SpeedsAreThoseOfLeastSquaresWithOffsetsAsUnknowns) {
    constexpr std::size_t s = 1;
    constexpr std::size_t e = 11;
    const auto arc = arc_with_two_steps<2>();
    const SmoothedArc<2> smoothed = smooth<2>(arc, singer_with_error);
    const DenseBridged dense = solve_dense_with_offsets<2>(arc, singer_with_error);
    const double duration_s = arc[e].time_s - arc[s].time_s;
    const auto part = [](const Eigen::VectorXd& x, std::size_t k, Eigen::Index from) {
        return Eigen::Vector2d(x.segment<2>(static_cast<Eigen::Index>(k) * 8 + from));
    };
    const auto expect = [&](const SpeedEstimate& speed, const auto& function) {
        EXPECT_NEAR(speed.speed_m_s / function(dense.mean), 1.0, 1e-9);
        EXPECT_NEAR(speed.standard_uncertainty_m_s / dense_uncertainty(dense, function), 1.0, 1e-6);
    };
    expect(displacement_speed(smoothed, s, e, duration_s), [&](const Eigen::VectorXd& x) {
        return (part(x, e, 0) - part(x, s, 0)).norm() / duration_s;
    });
    expect(path_speed(smoothed, s, e, duration_s), [&](const Eigen::VectorXd& x) {
        double length_m = 0.0;
        for (std::size_t k = s; k < e; ++k)
            length_m += (part(x, k + 1, 0) - part(x, k, 0)).norm();
        return length_m / duration_s;
    });
    expect(mean_speed(smoothed, s, e), [&](const Eigen::VectorXd& x) {
        double sum_m_s = 0.0;
        for (std::size_t k = s; k <= e; ++k)
            sum_m_s += part(x, k, 2).norm();
        return sum_m_s / static_cast<double>(e - s + 1);
    });
}

TEST(Bridge, PathAndDisplacementAgreeOnAStraightRun) {
    std::vector<ArcEpoch<2>> arc(60);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].time_s = 0.1 * static_cast<double>(k);
        arc[k].measurement =
            PositionMeasurement<2>{.position = Eigen::Vector2d(18.0, 24.0) * arc[k].time_s,
                                   .covariance = 1e-4 * Eigen::Matrix2d::Identity()};
    }
    const SmoothedArc<2> smoothed = smooth<2>(with_step<2>(arc, 30, 0.5), singer_with_error);
    const SpeedEstimate displaced = displacement_speed(smoothed, 15, 45, 3.0);
    const SpeedEstimate path = path_speed(smoothed, 15, 45, 3.0);
    EXPECT_NEAR(displaced.speed_m_s, 30.0, 1e-5);  // the vague prior of the offset: 1e-8 of it
    EXPECT_NEAR(path.speed_m_s, displaced.speed_m_s, 1e-8);
    EXPECT_NEAR(path.standard_uncertainty_m_s / displaced.standard_uncertainty_m_s, 1.0, 1e-6);
}

TEST(Bridge, SpeedAcrossAStepIsRightWithinItsLargerUncertainty) {
    RandomGenerator random(17);
    const auto [truth, arc] = simulate_arc<2>(singer_with_error, 101, 0.1, 0.003, random);
    const double expected = (truth[65] - truth[35]).head<2>().norm() / 3.0;
    const SpeedEstimate whole = displacement_speed(smooth<2>(arc, singer_with_error), 35, 65, 3.0);
    auto stepped = with_step<2>(arc, 50, 0.5);
    const SmoothedArc<2> smoothed = smooth<2>(stepped, singer_with_error);
    const SpeedEstimate bridged = displacement_speed(smoothed, 35, 65, 3.0);
    EXPECT_LT(std::abs(bridged.speed_m_s - expected), 3.0 * bridged.standard_uncertainty_m_s);
    EXPECT_GT(bridged.standard_uncertainty_m_s, 1.05 * whole.standard_uncertainty_m_s);
    EXPECT_LT(bridged.standard_uncertainty_m_s, 0.02);
    // Of any size it is the same speed.
    const SmoothedArc<2> larger = smooth<2>(with_step<2>(stepped, 50, 5.0), singer_with_error);
    EXPECT_NEAR(displacement_speed(larger, 35, 65, 3.0).speed_m_s, bridged.speed_m_s, 1e-6);
    // Windows that do not span the step are not touched by it: at either side, up to its epochs.
    for (const auto& [s, e] : {std::pair(20U, 49U), std::pair(50U, 80U)}) {
        EXPECT_TRUE(smoothed.bridged_between(s, e).empty());
        EXPECT_EQ(displacement(smoothed, s, e),
                  (smoothed.states[e].mean - smoothed.states[s].mean).head<2>());
    }
    EXPECT_EQ(smoothed.bridged_between(49, 50).size(), 1U);
    // Not bridged, it would be half a metre in three seconds.
    stepped[50].step_before = false;
    const SpeedEstimate blind =
        displacement_speed(smooth<2>(stepped, singer_with_error), 35, 65, 3.0);
    EXPECT_GT(std::abs(blind.speed_m_s - expected), 0.1);
}

/// Mean square of error over stated uncertainty of displacement and path over the 30 steps around
/// a bridged one, over runs drawn from the very model.
Eigen::Array2d mean_square_of_normalised_errors(const EstimationModel& model, double dt_s,
                                                int runs) {
    RandomGenerator random(29);
    constexpr std::size_t s = 10;
    constexpr std::size_t e = 40;
    const double duration_s = 30.0 * dt_s;
    Eigen::Array2d sum = Eigen::Array2d::Zero();
    for (int run = 0; run < runs; ++run) {
        const auto [truth, arc] = simulate_arc<2>(model, 51, dt_s, 0.003, random);
        const SmoothedArc<2> smoothed = smooth<2>(with_step<2>(arc, 25, 0.5), model);
        double length_m = 0.0;
        for (std::size_t k = s; k < e; ++k)
            length_m += (truth[k + 1] - truth[k]).head<2>().norm();
        const SpeedEstimate displaced = displacement_speed(smoothed, s, e, duration_s);
        const SpeedEstimate path = path_speed(smoothed, s, e, duration_s);
        const double displaced_m_s = (truth[e] - truth[s]).head<2>().norm() / duration_s;
        sum(0) +=
            std::pow((displaced.speed_m_s - displaced_m_s) / displaced.standard_uncertainty_m_s, 2);
        sum(1) +=
            std::pow((path.speed_m_s - length_m / duration_s) / path.standard_uncertainty_m_s, 2);
    }
    return sum / runs;
}

TEST(Bridge, UncertaintiesHoldUnderTheModel) {
    // The standard deviation of 2000 normalised errors has a relative standard error of 0.016.
    constexpr int runs = 2000;
    const double limit = 3.0 / std::sqrt(2.0 * runs);
    for (const EstimationModel& model : {white_model(), singer_with_error})
        for (const double dt_s : {0.1, 1.0}) {
            const Eigen::Array2d ratio = mean_square_of_normalised_errors(model, dt_s, runs).sqrt();
            EXPECT_NEAR(ratio(0), 1.0, limit) << dt_s;
            EXPECT_NEAR(ratio(1), 1.0, limit) << dt_s;
        }
}

TEST(Bridge, LinearSmootherAgreesWithTheDisplacementsOfTheSmoother) {
    RandomGenerator random(3);
    const auto drawn = simulate_arc<2>(singer_with_error, 80, 0.1, 0.003, random).arc;
    const auto arc = with_step<2>(with_step<2>(drawn, 40, 0.5), 60, -3.0);
    std::vector<PositionVector<2>> measured;
    for (const ArcEpoch<2>& epoch : arc)
        measured.push_back(epoch.measurement->position);
    const auto positions = LinearSmoother<2>(arc, singer_with_error)(measured);
    const SmoothedArc<2> smoothed = smooth<2>(arc, singer_with_error);
    for (std::size_t s = 0; s < arc.size(); ++s)
        for (std::size_t e = s + 1; e < arc.size(); ++e)
            EXPECT_LT((positions[e] - positions[s] - displacement(smoothed, s, e)).norm(), 1e-9)
                << s << " " << e;
    EXPECT_LT((positions[0] - smoothed.states[0].mean.head<2>()).norm(), 1e-9);
}

TEST(Bridge, FixedLagIsTheSmootherOfTheEpochsItKnows) {
    const auto arc = arc_with_two_steps<2>();
    constexpr std::size_t lag = 3;
    const auto states = smooth_fixed_lag<2>(arc, singer_with_error, lag);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        const std::span<const ArcEpoch<2>> known(arc.data(), std::min(k + lag + 1, arc.size()));
        const StateEstimate<2> expected = smooth<2>(known, singer_with_error).states[k];
        EXPECT_TRUE(states[k].mean.isApprox(expected.mean, 1e-9)) << k;
        EXPECT_TRUE(states[k].covariance.isApprox(expected.covariance, 1e-9)) << k;
    }
}

TEST(Bridge, AStepBeforeTheFirstEpochSaysNothing) {
    auto arc = sample_arc<2>(10);
    const SmoothedArc<2> without = smooth<2>(arc, singer_with_error);
    arc[0].step_before = true;
    const SmoothedArc<2> with = smooth<2>(arc, singer_with_error);
    EXPECT_TRUE(with.bridged.empty());
    for (std::size_t k = 0; k < arc.size(); ++k)
        EXPECT_EQ(with.states[k].covariance, without.states[k].covariance) << k;
}

TEST(Bridge, TheMeasurementThatTellsTheOffsetTestsNothing) {
    auto arc = sample_arc<2>(12, 7);  // the seventh has no measurement
    const auto testing = [&] {
        std::vector<std::size_t> epochs;
        KalmanFilter<2> filter(singer_with_error);
        filter_along<2>(filter, std::span<const ArcEpoch<2>>(arc),
                        [&](std::size_t k, const StateEstimate<2>&, const Innovation<2>* seen,
                            const StateEstimate<2>&) {
                            if (seen && seen->tests_model) epochs.push_back(k);
                        });
        return epochs;
    };
    EXPECT_EQ(testing(), (std::vector<std::size_t>{3, 4, 5, 6, 8, 9, 10, 11}));
    arc[5].step_before = true;
    EXPECT_EQ(testing(), (std::vector<std::size_t>{3, 4, 6, 8, 9, 10, 11}));
    // Two without a measurement between them are told by one; one among the first three adds to
    // them.
    arc[7].step_before = arc[8].step_before = true;
    EXPECT_EQ(testing(), (std::vector<std::size_t>{3, 4, 6, 9, 10, 11}));
    arc[1].step_before = true;
    EXPECT_EQ(testing(), (std::vector<std::size_t>{4, 6, 9, 10, 11}));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
