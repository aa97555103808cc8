#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <span>
#include <vector>

#include "motion/kalman.h"

// Tests for supposed errors in an arc's measurements, from one forward pass of the filter and one
// backward pass of scores [JP98]. Every test uses all measurements of the arc, before and after the
// supposed error. It equals the likelihood-ratio test against the model with that error as an
// unknown: Baarda's w-test [Baarda68] and its generalisation to several unknowns [Teunissen18].

namespace runcert {

/// The derivative of the log-likelihood with respect to an unknown that is zero under the model,
/// and the variance of that derivative. Both serve to test whether the unknown is zero and to
/// estimate it if not.
template <int Size>
struct ScoreTest {
    using Vector = Eigen::Matrix<double, Size, 1>;
    using Matrix = Eigen::Matrix<double, Size, Size>;
    Vector score = Vector::Zero();
    Matrix precision = Matrix::Identity();  ///< variance of the score, inverse of the estimate's
                                            ///< covariance

    /// Chi-squared with Size degrees of freedom where the unknown is zero.
    double statistic() const { return score.dot(precision.llt().solve(score)); }
    Vector estimate() const { return precision.llt().solve(score); }
    Matrix covariance() const { return precision.llt().solve(Matrix::Identity()); }
};

/// The joint test of a set of measurements, each with its own error.
struct SetTest {
    double statistic = 0.0;
    int degrees_of_freedom = 0;
};

/// Velocity (m/s) and acceleration (m/s^2) with their covariances.
template <int Axes>
struct MotionEstimate {
    PositionVector<Axes> velocity;
    PositionVector<Axes> acceleration;
    PositionMatrix<Axes> velocity_covariance;
    PositionMatrix<Axes> acceleration_covariance;
};

/// Tests for every supposed error of an arc. Of epochs without a measurement only the time counts.
/// The cost is linear in the epochs, about twice the filter's, with 1.5 kB per epoch for two axes.
template <int Axes>
class ArcDiagnosis {
  public:
    using Test = ScoreTest<Axes>;

    /// The arc must outlive the diagnosis, begin with a measurement and have increasing times.
    ArcDiagnosis(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    std::size_t size() const { return epochs_.size(); }

    /// The forward filter's innovation statistic, chi-squared with Axes degrees of freedom. Empty
    /// without a measurement, and for the first ones, which a vague prior cannot test.
    std::optional<double> innovation(std::size_t k) const { return epochs_[k].innovation; }

    /// Tests for an error (m), in any direction, of epoch k's measurement alone. Epoch k must have
    /// one.
    Test outlier(std::size_t k) const;

    /// Tests a position measured at epoch k but left out of the arc: the result of `outlier` if it
    /// were included.
    Test left_out(std::size_t k, const PositionMeasurement<Axes>& measurement) const;

    /// Tests for a constant error (m) of all measurements from epoch k on. It compares the forward
    /// prediction of epoch k with the information of the measurements from k on, under their joint
    /// covariance. The transition carries positions unchanged, so the error of the measurements is
    /// a jump of the state.
    Test step(std::size_t k) const;

    /// Tests for the offset (m) of a bridged step just before epoch k. The arc must bridge a step
    /// there.
    Test bridged_step(std::size_t k) const;

    /// Tests for an error of all measurements from epoch k on that grows linearly from zero at k
    /// (m/s).
    Test ramp(std::size_t k) const;

    /// Tests for a change of the craft's acceleration (m/s^2) just before epoch k. This is no error
    /// but a motion that the model considers less likely than it is.
    Test manoeuvre(std::size_t k) const;

    /// Tests for time stamps of all measurements from epoch k on that are late by a constant time
    /// (s). The positions then jump along the motion, with the speed and acceleration predicted
    /// from the epochs before k. Empty if that prediction leaves the speed uncertain by more
    /// than a tenth.
    std::optional<ScoreTest<1>> time_shift(std::size_t k) const;

    /// Tests for a constant error (m) of the measurements of epochs k to k + length - 1, for every
    /// k >= 1 and every length from 2 to `longest` that ends before the arc does. Calls visit(k,
    /// length, const Test&).
    template <class Visit>
    void for_each_burst(std::size_t longest, Visit&& visit) const;

    /// Tests for one such burst.
    Test burst(std::size_t k, std::size_t length) const;

    /// Tests epochs `first` to `last` for measurements that each have their own error. The
    /// statistic is the decrease of the least-squares minimum if all of them were left out.
    SetTest own_errors(std::size_t first, std::size_t last) const;

    /// The state at epoch k given all measurements of the arc.
    StateEstimate<Axes> smoothed(std::size_t k) const;

    /// Velocity and acceleration of the smoothed state, at a third of its cost.
    MotionEstimate<Axes> motion(std::size_t k) const;

  private:
    using Gain = typename KalmanFilter<Axes>::GainMatrix;
    using Positions = Eigen::Matrix<double, state_size<Axes>, Axes>;  ///< columns of a state matrix

    struct Epoch {
        StateEstimate<Axes> predicted;
        bool measured = false;
        std::optional<double> innovation;
        Gain gain = Gain::Zero();
        PositionMatrix<Axes> innovation_information = PositionMatrix<Axes>::Zero();
        PositionVector<Axes> weighted_residual = PositionVector<Axes>::Zero();
        /// Score and information of the measurements from this epoch on, with respect to its
        /// predicted state.
        StateVector<Axes> score = StateVector<Axes>::Zero();
        StateMatrix<Axes> information = StateMatrix<Axes>::Zero();
        /// Score and precision of this epoch's own measurement.
        PositionVector<Axes> own_score = PositionVector<Axes>::Zero();
        PositionMatrix<Axes> own_precision = PositionMatrix<Axes>::Zero();
    };

    /// Carries scores from the predicted state of epoch k + 1 back to that of epoch k.
    template <class Matrix>
    void carry_back(std::size_t k, Matrix& matrix) const;
    template <class Matrix>
    void transpose_transition(std::size_t k, Matrix& matrix) const;

    std::vector<Epoch> epochs_;
    std::vector<kernel::StepNumbers<double>> steps_;  ///< one for each run of equal lengths
    std::vector<std::size_t> step_of_;                ///< from each epoch to the next, an index
                                                      ///< into steps_
    EstimationModel model_;
};

template <int Axes>
template <class Matrix>
void ArcDiagnosis<Axes>::transpose_transition(std::size_t k, Matrix& matrix) const {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
        kernel::carry_back<Axes>(steps_[step_of_[k]], matrix.col(column).data());
}

template <int Axes>
template <class Matrix>
void ArcDiagnosis<Axes>::carry_back(std::size_t k, Matrix& matrix) const {
    transpose_transition(k, matrix);
    if (!epochs_[k].measured) return;
    const auto seen = epochs_[k].gain.transpose().lazyProduct(matrix).eval();
    matrix.template topRows<Axes>() -= seen;
    matrix.template bottomRows<Axes>() -= seen;
}

template <int Axes>
template <class Visit>
void ArcDiagnosis<Axes>::for_each_burst(std::size_t longest, Visit&& visit) const {
    for (std::size_t end = 3; end < epochs_.size(); ++end) {
        Positions carried = epochs_[end].information.template leftCols<Axes>();
        const PositionMatrix<Axes> at_end = carried.template topRows<Axes>();
        for (std::size_t k = end; k-- > 1 && end - k <= longest;) {
            carry_back(k, carried);
            if (end - k < 2) continue;
            const PositionMatrix<Axes> between = carried.template topRows<Axes>();
            visit(k, end - k,
                  Test{.score = epochs_[k].score.template head<Axes>() -
                                epochs_[end].score.template head<Axes>(),
                       .precision = epochs_[k].information.template topLeftCorner<Axes, Axes>() +
                                    at_end - between - between.transpose()});
        }
    }
}

}  // namespace runcert
