#include <gtest/gtest.h>

#include <functional>

#include "motion/chain.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::Quad;
using test::QuadMatrix;
using test::QuadVector;

/// The measurements of an arc as one vector with its mean and covariance under the model, in 33
/// digits: generalised least squares with any column of errors is then a textbook formula.
template <int Axes>
class DenseTests {
  public:
    DenseTests(const std::vector<ArcEpoch<Axes>>& arc, const EstimationModel& model) : arc_(arc) {
        constexpr int n = state_size<Axes>;
        const auto prior = KalmanFilter<Axes>(model).prior(arc[0].measurement->position);
        std::vector<QuadMatrix> covariances{prior.covariance.template cast<Quad>()};
        std::vector<QuadVector> means{prior.mean.template cast<Quad>()};
        std::vector<QuadMatrix> transitions{QuadMatrix::Identity(n, n)};
        for (std::size_t k = 1; k < arc.size(); ++k) {
            const AxisStep step = test::step_between(model, arc[k - 1], arc[k]);
            const QuadMatrix f = transition<Axes>(step).template cast<Quad>();
            const QuadMatrix noise = process_noise<Axes>(step).template cast<Quad>();
            const QuadMatrix symmetric = (noise + noise.transpose()) / Quad(2);
            covariances.push_back(f * covariances.back() * f.transpose() + symmetric);
            means.push_back(f * means.back());
            transitions.push_back(f);
        }
        QuadMatrix design = QuadMatrix::Zero(Axes, n);
        design.leftCols(Axes).setIdentity();
        design.rightCols(Axes).setIdentity();
        const auto size = static_cast<Eigen::Index>(arc.size()) * Axes;
        QuadMatrix covariance = QuadMatrix::Zero(size, size);
        residual_ = QuadVector::Zero(size);
        const Quad scale = Quad(model.measurement_scale) * model.measurement_scale;
        for (std::size_t k = 0; k < arc.size(); ++k) {
            const auto at = static_cast<Eigen::Index>(k) * Axes;
            QuadMatrix carried = covariances[k];
            for (std::size_t j = k; j < arc.size(); ++j) {
                if (j > k) carried = transitions[j] * carried;
                const auto row = static_cast<Eigen::Index>(j) * Axes;
                covariance.block(row, at, Axes, Axes) = design * carried * design.transpose();
                covariance.block(at, row, Axes, Axes) =
                    covariance.block(row, at, Axes, Axes).transpose().eval();
            }
            // An epoch without a measurement has one that says nothing.
            const auto& measurement = arc[k].measurement;
            if (measurement) {
                residual_.segment(at, Axes) =
                    measurement->position.template cast<Quad>() - design * means[k];
                covariance.block(at, at, Axes, Axes) +=
                    scale * measurement->covariance.template cast<Quad>();
            } else {
                covariance.block(at, at, Axes, Axes) +=
                    Quad(1e24) * QuadMatrix::Identity(Axes, Axes);
            }
        }
        factor_.compute(covariance);
    }

    struct Result {
        double statistic;
        Eigen::VectorXd estimate;
        Eigen::MatrixXd covariance;
    };

    /// Errors of epoch k: `errors(k)` rows of the design matrix.
    Result test(const std::function<Eigen::MatrixXd(std::size_t)>& errors) const {
        const auto columns = errors(0).cols();
        QuadMatrix design(residual_.size(), columns);
        for (std::size_t k = 0; k < arc_.size(); ++k)
            design.middleRows(static_cast<Eigen::Index>(k) * Axes, Axes) = errors(k).cast<Quad>();
        const QuadMatrix normal = design.transpose() * factor_.solve(design);
        const QuadVector right = design.transpose() * factor_.solve(residual_);
        const Eigen::LLT<QuadMatrix> solver(normal);
        const QuadVector estimate = solver.solve(right);
        return {static_cast<double>(Quad(right.dot(estimate))), estimate.template cast<double>(),
                QuadMatrix(solver.solve(QuadMatrix::Identity(columns, columns)))
                    .template cast<double>()};
    }

  private:
    const std::vector<ArcEpoch<Axes>>& arc_;
    QuadVector residual_;
    Eigen::LLT<QuadMatrix> factor_;
};

template <class Test, class Result>
void expect_same(const Test& test, const Result& dense) {
    EXPECT_NEAR(test.statistic(), dense.statistic, 1e-6 * dense.statistic);
    EXPECT_LT((test.estimate() - dense.estimate).norm(), 1e-6 * dense.estimate.norm());
    EXPECT_LT((test.covariance() - dense.covariance).norm(), 1e-6 * dense.covariance.norm());
}

template <class Axes>
class DiagnosisAgainstDense : public testing::Test {
  public:
    static constexpr int axes = Axes::value;
    std::vector<ArcEpoch<axes>> arc = test::with_changing_motion(test::sample_arc<axes>(14));
    Chain<axes> diagnosis{arc, test::singer_with_error};
    DenseTests<axes> dense{arc, test::singer_with_error};

    static Eigen::MatrixXd unit() { return Eigen::MatrixXd::Identity(axes, axes); }
    static Eigen::MatrixXd none() { return Eigen::MatrixXd::Zero(axes, axes); }
};
using AxesTypes = testing::Types<std::integral_constant<int, 1>, std::integral_constant<int, 2>>;
TYPED_TEST_SUITE(DiagnosisAgainstDense, AxesTypes);

TYPED_TEST(DiagnosisAgainstDense, OutliersOfEveryEpoch) {
    for (std::size_t k = 0; k < this->arc.size(); ++k) {
        if (!this->arc[k].measurement) continue;
        expect_same(this->diagnosis.outlier(k), this->dense.test([&](std::size_t j) {
            return j == k ? this->unit() : this->none();
        }));
    }
}

TYPED_TEST(DiagnosisAgainstDense, StepsBetweenAnyTwoEpochs) {
    for (std::size_t k = 1; k < this->arc.size(); ++k)
        expect_same(this->diagnosis.step(k), this->dense.test([&](std::size_t j) {
            return j >= k ? this->unit() : this->none();
        }));
}

TYPED_TEST(DiagnosisAgainstDense, RampsFromAnyEpoch) {
    // One that begins with the last epoch has no effect on any measurement yet.
    for (std::size_t k = 1; k + 1 < this->arc.size(); ++k)
        expect_same(this->diagnosis.ramp(k), this->dense.test([&](std::size_t j) {
            const double since_s = this->arc[j].time_s - this->arc[k].time_s;
            return Eigen::MatrixXd(std::max(0.0, since_s) * this->unit());
        }));
}

TYPED_TEST(DiagnosisAgainstDense, ManoeuvresBeforeAnyEpoch) {
    // A change of the state that the motion carries on: nothing at k itself, a parabola after it,
    // less what the acceleration dies away. Of the last epochs a change tells nothing.
    constexpr int size = TestFixture::axes;
    for (std::size_t k = 1; k + 2 < this->arc.size(); ++k)
        expect_same(this->diagnosis.manoeuvre(k), this->dense.test([&](std::size_t j) {
            Eigen::MatrixXd state = Eigen::MatrixXd::Zero(state_size<size>, size);
            state.template middleRows<size>(2 * size).setIdentity();
            for (std::size_t i = k; i < j; ++i)
                state = (transition<size>(test::step_between(test::singer_with_error, this->arc[i],
                                                             this->arc[i + 1])) *
                         state)
                            .eval();
            return Eigen::MatrixXd(j < k ? 0.0 * state.template topRows<size>()
                                         : 1.0 * state.template topRows<size>());
        }));
}

TYPED_TEST(DiagnosisAgainstDense, BurstsOfEveryLength) {
    std::size_t visited = 0;
    this->diagnosis.for_each_burst(5, [&](std::size_t k, std::size_t length, const auto& test) {
        ++visited;
        const auto expected = this->dense.test(
            [&](std::size_t j) { return j >= k && j < k + length ? this->unit() : this->none(); });
        expect_same(test, expected);
        expect_same(this->diagnosis.burst(k, length), expected);
    });
    // Beginnings 1 to 13 - length, for lengths 2 to 5.
    EXPECT_EQ(visited, 11U + 10U + 9U + 8U);
}

TYPED_TEST(DiagnosisAgainstDense, SetsWithAnErrorEach) {
    for (const auto& [first, last] :
         {std::pair<std::size_t, std::size_t>{6, 8}, {2, 6}, {11, 13}}) {
        std::vector<std::size_t> set;
        for (std::size_t k = first; k <= last; ++k)
            if (this->arc[k].measurement) set.push_back(k);
        const auto columns = static_cast<Eigen::Index>(set.size()) * this->axes;
        const auto expected = this->dense.test([&](std::size_t j) {
            Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(this->axes, columns);
            for (std::size_t i = 0; i < set.size(); ++i)
                if (set[i] == j)
                    rows.middleCols(static_cast<Eigen::Index>(i) * this->axes, this->axes) =
                        this->unit();
            return rows;
        });
        const SetTest test = this->diagnosis.own_errors(first, last);
        EXPECT_EQ(test.degrees_of_freedom, columns);
        EXPECT_NEAR(test.statistic, expected.statistic, 1e-6 * expected.statistic);
    }
}

TYPED_TEST(DiagnosisAgainstDense, ALateStampIsAJumpAlongTheMotion) {
    // By the definition of the hypothesis: minus (velocity + acceleration (t - t_k)), as predicted
    // at k; the decay of the acceleration changes it by little over one step.
    constexpr int size = TestFixture::axes;
    KalmanFilter<size> filter(test::singer_with_error);
    std::vector<StateVector<size>> predictions;
    filter_along<size>(filter, this->arc,
                       [&](std::size_t, const auto& predicted, const auto*, const auto&) {
                           predictions.push_back(predicted.mean);
                       });
    const std::size_t k = this->arc.size() - 2;
    const auto test = this->diagnosis.time_shift(k);
    ASSERT_TRUE(test);
    StateVector<size> state = StateVector<size>::Zero();
    state.template head<size>() = -predictions[k].template segment<size>(size);
    state.template segment<size>(size) = -predictions[k].template segment<size>(2 * size);
    expect_same(*test, this->dense.test([&](std::size_t j) {
        if (j < k) return Eigen::MatrixXd(Eigen::MatrixXd::Zero(size, 1));
        StateVector<size> carried = state;
        for (std::size_t i = k; i < j; ++i)
            carried = transition<size>(test::step_between(test::singer_with_error, this->arc[i],
                                                          this->arc[i + 1])) *
                      carried;
        return Eigen::MatrixXd(carried.template head<size>());
    }));
    EXPECT_FALSE(this->diagnosis.time_shift(1)) << "one epoch does not tell a speed";
}

TYPED_TEST(DiagnosisAgainstDense, AMeasurementLeftOutIsTestedAsIfItWereIn) {
    const std::size_t k = 7;
    auto without = this->arc;
    without[k].measurement.reset();
    const auto inside = this->diagnosis.outlier(k);
    const auto outside = Chain<TestFixture::axes>(without, test::singer_with_error)
                             .left_out(k, *this->arc[k].measurement);
    EXPECT_NEAR(outside.statistic(), inside.statistic(), 1e-6 * inside.statistic());
    EXPECT_LT((outside.estimate() - inside.estimate()).norm(), 1e-6 * inside.estimate().norm());
}

TYPED_TEST(DiagnosisAgainstDense, AStepThatWasFoundIsTestedAsIfItWereNot) {
    for (const std::size_t k : {5U, 8U}) {
        auto known = this->arc;
        known[k].step_before = true;
        const auto unknown = this->diagnosis.step(k);
        const auto found = Chain<TestFixture::axes>(known, test::singer_with_error).known_step(k);
        // The vague prior of the offset takes half the digits.
        EXPECT_NEAR(found.statistic(), unknown.statistic(), 0.02) << k;
        EXPECT_LT((found.estimate() - unknown.estimate()).norm(), 1e-4 * unknown.estimate().norm())
            << k;
    }
}

TEST(Filter, TheMeasurementThatTellsTheOffsetOfAStepTestsNothing) {
    auto arc = test::sample_arc<2>(12, 7);  // the seventh has no measurement
    const auto testing = [&] {
        std::vector<std::size_t> epochs;
        KalmanFilter<2> filter(test::singer_with_error);
        filter_along<2>(filter, std::span<const ArcEpoch<2>>(arc),
                        [&](std::size_t k, const StateEstimate<2>&, const Innovation<2>* seen,
                            const StateEstimate<2>&) {
                            if (seen && seen->tests_model) epochs.push_back(k);
                        });
        return epochs;
    };
    EXPECT_EQ(testing(), (std::vector<std::size_t>{3, 4, 5, 6, 8, 9, 10, 11}));
    arc[0].step_before = true;  // means nothing
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
