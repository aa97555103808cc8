#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "motion/kalman.h"

namespace runcert {

/// Filter and fixed-interval smoother over one arc, in the form of Bryson and Frazier as modified
/// by Bierman ([Bierman73]; [YSM22] for the model). It visits the states of `smooth` from the last
/// epoch to the first, without computing gains.
///
/// Only the innovation covariances are inverted, so that an epoch costs a small fraction of an RTS
/// step. Memory stays small: one forward state in `epochs_at_once` is stored, and those in between
/// are filtered again on the way back.
///
///     for (MotionSmoother<2> at(arc, model); !at.done(); at.step_back())
///         use(at.epoch(), at.mean(), at.covariance(MotionSmoother<2>::velocity));
template <int Axes>
class MotionSmoother {
  public:
    static constexpr std::size_t epochs_at_once = 256;

    /// The kinds of coordinates that `covariance` takes.
    static constexpr int position = 0;
    static constexpr int velocity = 1;
    static constexpr int acceleration = 2;

    /// Filters the arc, which must outlive the smoother. As for `smooth`, times must increase
    /// strictly and the first epoch must have a measurement. Failure, naming the time, where a
    /// covariance is not positive definite.
    MotionSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    /// Whether it has stepped back beyond the first epoch.
    bool done() const { return done_; }

    /// The index of the current epoch. It starts at the last one.
    std::size_t epoch() const { return epoch_; }

    /// Moves to the previous epoch.
    void step_back();

    /// The state given all measurements of the arc: position (m), velocity (m/s), acceleration
    /// (m/s^2) and Gauss-Markov error (m). `covariance` gives the block of one kind of coordinates.
    const StateVector<Axes>& mean() const { return mean_; }
    PositionMatrix<Axes> covariance(int kind) const;
    StateMatrix<Axes> covariance() const;  ///< of the whole state

    /// Relative asymmetry of the smoothed covariance before it is made symmetric.
    double asymmetry() const;

    double innovation_sum() const { return innovation_sum_; }  ///< sum of all innovation statistics
    std::int64_t measurements() const { return measurements_; }

  private:
    using FactoredInnovation = typename KalmanFilter<Axes>::FactoredInnovation;

    /// An epoch after its measurement, if any, was taken in.
    struct Visited {
        StateEstimate<Axes> filtered;
        FactoredInnovation seen;
    };

    void take_in(std::size_t k, Visited& at);
    void carry_and_take_in(std::size_t k, Visited& at);
    void filter_again(std::size_t piece);
    void back_through_measurement(const FactoredInnovation& seen);
    StateMatrix<Axes> unsymmetrised() const;
    void smooth_here();
    void smooth_here_by_rts();
    const Visited& here() const { return piece_[epoch_ % epochs_at_once]; }

    std::span<const ArcEpoch<Axes>> arc_;
    KalmanFilter<Axes> filter_;

    std::vector<Visited> kept_;  // the first epoch of each piece
    std::vector<Visited> piece_;
    std::size_t epoch_ = 0;
    bool done_ = false;
    StateVector<Axes> mean_;
    bool by_rts_ = false;  // `covariance_` is then set too
    StateMatrix<Axes> covariance_;
    StateEstimate<Axes> next_;  // smoothed state of the next epoch, for a possible RTS step
    // What later measurements contribute: a gradient to the state, an information to its
    // covariance.
    StateVector<Axes> gradient_ = StateVector<Axes>::Zero();
    StateMatrix<Axes> information_ = StateMatrix<Axes>::Zero();
    double innovation_sum_ = 0.0;
    std::int64_t measurements_ = 0;
};

}  // namespace runcert
