#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "motion/kalman.h"

// One forward pass of the Kalman filter over an arc and one backward pass of the scores of its
// measurements [JP98]: the chain from which every figure of a track follows [DK12] (4.4 to 4.7).
//
// Forward, a and P are the predicted mean and covariance of an epoch. Each coordinate of a measured
// position has an innovation v of variance f, and the gain k = P z' / f. Backward, r and N are
// score and information of the measurements from an epoch on, with respect to its predicted state:
//     u = v / f - k' r,  r <- r + z' u,  N <- (I - k z)' N (I - k z) + z' z / f,
// and r <- F' r, N <- F' N F from epoch to epoch.
namespace runcert {

/// A linear functional of the states s, s+1, ... of an arc: one gradient for each state.
template <int Axes>
using Gradients = std::vector<StateVector<Axes>>;

/// Number of axes that a displacement has: two (east and north), or one (up) where heights stand
/// alone.
template <int Axes>
inline constexpr int speed_axes = Axes == 1 ? 1 : 2;
template <int Axes>
using SpeedVector = Eigen::Matrix<double, speed_axes<Axes>, 1>;
template <int Axes>
using SpeedMatrix = Eigen::Matrix<double, speed_axes<Axes>, speed_axes<Axes>>;

/// A vector of functionals along these axes: for each state a matrix with one column for each
/// coordinate.
template <int Axes>
using CountedGradients = std::vector<Eigen::Matrix<double, state_size<Axes>, speed_axes<Axes>>>;

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

template <int Axes>
class ChainMeans;

/// The chain of one arc. Its tests use all measurements, before and after a supposed error. They
/// equal the likelihood-ratio tests against the model with that error as an unknown: Baarda's
/// w-test [Baarda68] and its generalisation to several unknowns [Teunissen18].
///
/// Times must increase strictly, and the first epoch must have a measurement. Failure, naming the
/// time, where a covariance is not positive definite. The cost is linear in the epochs, with 1.5 kB
/// for each with two axes.
template <int Axes>
class Chain {
  public:
    using Test = ScoreTest<Axes>;

    Chain() = default;
    Chain(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    std::size_t size() const { return epochs_.size(); }

    /// Number of measurements, and the sum of all innovation statistics: the least-squares minimum.
    std::int64_t measurements() const { return measurements_; }
    double innovation_sum() const { return innovation_sum_; }

    /// The forward filter's innovation statistic, chi-squared with Axes degrees of freedom. Empty
    /// without a measurement, and for the first ones, which a vague prior cannot test.
    std::optional<double> innovation(std::size_t k) const;

    /// The state at epoch k given all measurements: a + P r, of covariance P - P N P.
    StateVector<Axes> mean(std::size_t k) const;
    StateEstimate<Axes> state(std::size_t k) const;
    /// Its position (0), velocity (1) or acceleration (2) alone, at a small part of the cost.
    PositionMatrix<Axes> covariance_of(int kind, std::size_t k) const;
    /// Relative asymmetry of the covariance before it is made symmetric.
    double asymmetry(std::size_t k) const;

    /// The states of epochs k given the measurements up to epoch k + lag, or to the arc's end if
    /// that comes first: what an estimate delayed by `lag` epochs would know. Lag 0 is the filter.
    std::vector<StateEstimate<Axes>> fixed_lag(std::size_t lag) const;

    /// Covariance between the errors of the states of epochs s and e (s <= e).
    StateMatrix<Axes> cross_covariance(std::size_t s, std::size_t e) const;

    /// Variance of the sum of gradients[i]' state[s + i] over the gradients given. The cost is
    /// linear in their number.
    double variance(std::size_t s, const Gradients<Axes>& gradients) const;
    /// Covariance of a vector of such sums, along the axes of a displacement.
    SpeedMatrix<Axes> covariance(std::size_t s, const CountedGradients<Axes>& gradients) const;

    /// Derivatives of such a sum with respect to each measured position: one vector for each epoch
    /// of the arc, zero where it has no measurement.
    std::vector<PositionVector<Axes>> weights(std::size_t s,
                                              const Gradients<Axes>& gradients) const;

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

    /// Tests for the offset (m) of a step just before epoch k that the arc knows of
    /// (`step_before`).
    Test known_step(std::size_t k) const;

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

  private:
    friend class ChainMeans<Axes>;
    enum class Backward { scores, scores_and_information };

    Chain(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model, Backward backward);

    using Positions = Eigen::Matrix<double, state_size<Axes>, Axes>;  ///< columns of a state matrix

    struct Epoch {
        StateEstimate<Axes> predicted;
        bool measured = false;
        std::size_t step = 0;  ///< to the next epoch, an index into `steps_`
        Innovation<Axes> seen;
        StateVector<Axes> score = StateVector<Axes>::Zero();                ///< r
        StateMatrix<Axes> information = StateMatrix<Axes>::Zero();          ///< N
        PositionVector<Axes> own_score = PositionVector<Axes>::Zero();      ///< u
        PositionMatrix<Axes> own_precision = PositionMatrix<Axes>::Zero();  ///< variance of u

        StateEstimate<Axes> filtered() const;
        /// P H' inverse(S), which maps a whole innovation to the change of the state.
        Positions gain() const;
        /// inverse(L)' of the measurement, which turns scores of its whitened coordinates into
        /// those of the position.
        PositionMatrix<Axes> unwhitening() const;
    };
    /// A smoothed state for which P - P N P would lose digits, because the prediction is vague.
    using VagueStates = std::unordered_map<std::size_t, StateEstimate<Axes>>;

    const kernel::StepNumbers<double>& step_after(std::size_t k) const {
        return steps_[epochs_[k].step];
    }
    void go_forward(std::span<const ArcEpoch<Axes>> arc);
    void update_backwards(Epoch& epoch, Backward backward) const;
    void smooth_vague_states();
    /// The gain of the RTS recursion [YSM22]: P[k|k] F' inverse(P[k+1|k]).
    StateMatrix<Axes> smoother_gain(std::size_t k, const StateEstimate<Axes>& filtered) const;
    StateMatrix<Axes> smoothed_covariance(std::size_t k) const;
    template <int Columns>
    Eigen::Matrix<double, Columns, Columns> joint_covariance(
        std::size_t s,
        const std::vector<Eigen::Matrix<double, state_size<Axes>, Columns>>& gradients) const;

    /// Carries scores from the predicted state of epoch k + 1 back to that of epoch k.
    template <class Matrix>
    void carry_back(std::size_t k, Matrix& matrix) const;
    template <class Matrix>
    void transpose_transition(std::size_t k, Matrix& matrix) const;

    std::vector<Epoch> epochs_;
    std::vector<double> times_s_;
    std::vector<kernel::StepNumbers<double>> steps_;  ///< one for each run of equal steps
    VagueStates vague_;
    EstimationModel model_;
    std::int64_t measurements_ = 0;
    double innovation_sum_ = 0.0;
};

/// The smoothed means of an arc, without covariances or tests: as those of `Chain`, in less time.
template <int Axes>
class ChainMeans {
  public:
    ChainMeans() = default;
    ChainMeans(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model)
        : chain_(arc, model, Chain<Axes>::Backward::scores) {}

    StateVector<Axes> mean(std::size_t k) const { return chain_.mean(k); }
    double innovation_sum() const { return chain_.innovation_sum(); }

  private:
    Chain<Axes> chain_;
};

template <int Axes>
template <class Matrix>
void Chain<Axes>::transpose_transition(std::size_t k, Matrix& matrix) const {
    for (Eigen::Index column = 0; column < matrix.cols(); ++column)
        kernel::carry_back<Axes>(step_after(k), matrix.col(column).data());
}

template <int Axes>
template <class Matrix>
void Chain<Axes>::carry_back(std::size_t k, Matrix& matrix) const {
    transpose_transition(k, matrix);
    if (!epochs_[k].measured) return;
    const Innovation<Axes>& seen = epochs_[k].seen;
    for (int j = Axes; j-- > 0;) {
        const auto& one = seen.coordinates[j];
        for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
            double* const at = matrix.col(column).data();
            double along = 0.0;
            for (int i = 0; i < state_size<Axes>; ++i)
                along += one.cross[i] * at[i];
            kernel::add_observed<Axes>(seen.white, j, -along / one.variance, at);
        }
    }
}

template <int Axes>
template <class Visit>
void Chain<Axes>::for_each_burst(std::size_t longest, Visit&& visit) const {
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

/// Variance of the sum over the epochs of weight times a Gauss-Markov error of the measured
/// positions, axis by axis. In m^2 for dimensionless weights. The cost is linear in the epochs.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, const GaussMarkovError& error,
                         std::span<const PositionVector<Axes>> weights);

/// The same variance for the white noise of the measurements, whose covariances are the stated ones
/// times `scale` squared.
template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, double scale,
                         std::span<const PositionVector<Axes>> weights);

}  // namespace runcert
