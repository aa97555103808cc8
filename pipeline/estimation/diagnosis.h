#pragma once

#include <Eigen/Cholesky>
#include <optional>
#include <span>
#include <vector>

#include "estimation/kalman.h"

// Tests of supposed errors of an arc's measurements, from one pass of the filter forward and one of
// scores backward [JP98]. Every test uses all
// measurements of the arc, before and after the supposed error, and equals the likelihood-ratio
// test against the model with that error as an unknown: Baarda's w-test [Baarda68] and its
// generalisation to several unknowns [Teunissen18].

namespace runcert {

/// The derivative of the log-likelihood by an unknown that is zero under the model, and its
/// variance: what is needed to test whether it is zero, and to estimate it if not.
template <int Size>
struct ScoreTest {
    using Vector = Eigen::Matrix<double, Size, 1>;
    using Matrix = Eigen::Matrix<double, Size, Size>;
    Vector score = Vector::Zero();
    Matrix precision = Matrix::Identity();  ///< variance of the score, inverse of the estimate's

    /// Chi-squared with Size degrees of freedom where the unknown is zero.
    double statistic() const { return score.dot(precision.llt().solve(score)); }
    Vector estimate() const { return precision.llt().solve(score); }
    Matrix covariance() const { return precision.llt().solve(Matrix::Identity()); }
};

/// The test of a set of measurements, each with an error of its own.
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

/// What can be said of every supposed error of an arc. Epochs without a measurement take part in
/// time alone. Linear in the epochs; about twice the filter's cost, and 1.5 kB an epoch for two
/// axes.
template <int Axes>
class ArcDiagnosis {
  public:
    using Test = ScoreTest<Axes>;

    /// The arc must outlive the diagnosis, begin with a measurement, and have increasing times.
    ArcDiagnosis(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    std::size_t size() const { return epochs_.size(); }

    /// The forward filter's innovation statistic, chi-squared with Axes degrees of freedom; nothing
    /// without a measurement, or for the first ones, which a vague prior cannot test.
    std::optional<double> innovation(std::size_t k) const { return epochs_[k].innovation; }

    /// An error of epoch k's measurement alone, in any direction (m). The epoch must have one.
    Test outlier(std::size_t k) const;

    /// What a position measured at epoch k, but left out of the arc, says: as `outlier` would if
    /// it were taken in.
    Test left_out(std::size_t k, const PositionMeasurement<Axes>& measurement) const;

    /// A constant error (m) of all measurements from epoch k on. It compares the forward
    /// prediction of epoch k with what the measurements from k on say, under their joint
    /// covariance: positions are carried unchanged by the transition, so that the error of the
    /// measurements is a jump of the state.
    Test step(std::size_t k) const;

    /// The offset (m) of a step that the arc bridges before epoch k, which must have one.
    Test bridged_step(std::size_t k) const;

    /// An error of all measurements from epoch k on that grows linearly from zero at k (m/s).
    Test ramp(std::size_t k) const;

    /// A change of the craft's acceleration (m/s^2) just before epoch k: no error, but a motion
    /// that the model has for less likely than it is.
    Test manoeuvre(std::size_t k) const;

    /// Stamps of all measurements from epoch k on that are late by a constant time (s): a jump
    /// along the motion, of which speed and acceleration are those predicted from the epochs before
    /// k. Nothing where that prediction cannot tell the speed (known to worse than a tenth).
    std::optional<ScoreTest<1>> time_shift(std::size_t k) const;

    /// A constant error (m) of the measurements of epochs k to k + length - 1, for every k >= 1,
    /// and every length of 2 to `longest` that ends before the arc does:
    /// visit(k, length, const Test&).
    template <class Visit>
    void for_each_burst(std::size_t longest, Visit&& visit) const;

    /// The same for one of them.
    Test burst(std::size_t k, std::size_t length) const;

    /// Measurements of epochs first to last, each with an error of its own: what leaving them all
    /// out would lower the least-squares minimum by.
    SetTest own_errors(std::size_t first, std::size_t last) const;

    /// The state at epoch k given all measurements of the arc.
    StateEstimate<Axes> smoothed(std::size_t k) const;

    /// Velocity and acceleration of that state, for a third of the cost.
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
        /// Of the measurements from this epoch on, by the predicted state of this epoch.
        StateVector<Axes> score = StateVector<Axes>::Zero();
        StateMatrix<Axes> information = StateMatrix<Axes>::Zero();
        /// Of this measurement, by itself.
        PositionVector<Axes> own_score = PositionVector<Axes>::Zero();
        PositionMatrix<Axes> own_precision = PositionMatrix<Axes>::Zero();
    };

    /// Carries scores back from the predicted state of epoch k + 1 to that of epoch k.
    template <class Matrix>
    void carry_back(std::size_t k, Matrix& matrix) const;
    template <class Matrix>
    void transpose_transition(std::size_t k, Matrix& matrix) const;

    std::vector<Epoch> epochs_;
    std::vector<kernel::StepNumbers<double>> steps_;  ///< distinct ones
    std::vector<std::size_t> step_of_;                ///< from each epoch to the next
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
