#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "estimation/kalman.h"

namespace runcert {

/// Filter and fixed-interval smoother over one arc in the form of Bryson and Frazier as modified by
/// Bierman ([Bierman73]; [YSM22] for the model):
/// the states of `smooth`, without its gains, from the last epoch to the first.
///
/// Nothing is inverted but the innovations' covariances, so that an epoch costs a small part of an
/// RTS step, and memory stays small: of the forward filter one state in `epochs_at_once` is kept,
/// and what lies between is filtered again on the way back.
///
///     for (MotionSmoother<2> at(arc, model); !at.done(); at.step_back())
///         use(at.epoch(), at.mean(), at.covariance(MotionSmoother<2>::velocity));
template <int Axes>
class MotionSmoother {
  public:
    static constexpr std::size_t epochs_at_once = 256;

    /// Kinds of coordinates.
    static constexpr int position = 0;
    static constexpr int velocity = 1;
    static constexpr int acceleration = 2;

    /// Filters the arc, which must outlive the smoother, as `smooth` does: times must increase
    /// strictly, and the first epoch must have a measurement. Failure, naming the time, where a
    /// covariance is not positive definite.
    MotionSmoother(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model);

    /// Whether the first epoch has been left behind.
    bool done() const { return done_; }

    /// The epoch that it stands at; the last one to begin with.
    std::size_t epoch() const { return epoch_; }

    /// To the epoch before.
    void step_back();

    /// Given all measurements of the arc: position, velocity, acceleration (m, s) and the error.
    const StateVector<Axes>& mean() const { return mean_; }
    PositionMatrix<Axes> covariance(int kind) const;
    StateMatrix<Axes> covariance() const;  ///< of all

    /// How far from symmetric it is before it is made so, relative.
    double asymmetry() const;

    double innovation_sum() const { return innovation_sum_; }  ///< of all innovation statistics
    std::int64_t measurements() const { return measurements_; }

  private:
    using FactoredInnovation = typename KalmanFilter<Axes>::FactoredInnovation;

    /// An epoch with its measurement taken in, if it has one.
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
    bool by_rts_ = false;  // then the covariance is there too
    StateMatrix<Axes> covariance_;
    StateEstimate<Axes> next_;  // the smoothed state one epoch later, where an RTS step may need it
    // What later measurements say: of the state a gradient, of its covariance an information.
    StateVector<Axes> gradient_ = StateVector<Axes>::Zero();
    StateMatrix<Axes> information_ = StateMatrix<Axes>::Zero();
    double innovation_sum_ = 0.0;
    std::int64_t measurements_ = 0;
};

}  // namespace runcert
