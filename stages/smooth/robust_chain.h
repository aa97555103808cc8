#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "estimation/kalman.h"
#include "stages/smooth/chain_step.h"

namespace runcert {

/// The robust least-squares problem of one stretch of an arc (batch.h), iterated over the chain of
/// its states: at each iteration the cost is taken as quadratic about where the states stand, and
/// the quadratic problem is solved by one pass along the chain and one back, as a Kalman filter and
/// smoother would. The same minimum as that of the general program for which the problem is a
/// sparse matrix (BatchProblem, with a scale), in a tenth of its time.
///
/// Begun with reweighted steps [HW77], which cannot raise the cost, from wherever
/// the start is; once little is gained, with Newton's, whose convergence is quadratic.
///
/// Only differences are iterated: those of the states from the start, and what each measurement and
/// each step of time is then missed by. About a near start, rounding of large coordinates does not
/// hide what the cost still changes by.
template <int Axes>
class RobustChain {
  public:
    /// The stretch must outlive the chain; its first epoch must have a measurement. `start` has a
    /// state for each epoch; `scale` is that of the Cauchy loss, in standard deviations.
    RobustChain(std::span<const ArcEpoch<Axes>> stretch, const EstimationModel& model,
                std::span<const StateVector<Axes>> start, double scale);

    /// Iterates until a whole Newton step, or a reweighted one where rounding hides what Newton's
    /// gains, moves no state by more than 1e-6 of its standard deviation. Where rounding hides what
    /// is gained, or so many steps are not enough, whether what is left moves none by more than
    /// 0.1.
    bool solve(std::int64_t iterations_allowed);

    std::int64_t iterations() const { return iterations_; }

    /// How far the state of epoch k stands from its start.
    const StateVector<Axes>& move(std::size_t k) const { return links_[k].move; }

  private:
    using State = StateVector<Axes>;
    using Position = PositionVector<Axes>;
    using PositionSquare = PositionMatrix<Axes>;

    /// One epoch: where the iteration stands, and what the passes of one iteration leave there.
    struct Link {
        const ChainStep<Axes>* step = nullptr;  ///< from the epoch before; none at the first
        bool measured = false;
        bool was_vague = false;  ///< before the measurement
        PositionSquare whitener = PositionSquare::Zero();
        Position missed = Position::Zero();  ///< measured less the state's, whitened
        State defect = State::Zero();        ///< the state less what the one before foretells
        State move = State::Zero();
        State gradient = State::Zero();                            ///< of half the cost
        PositionSquare information = PositionSquare::Zero();       ///< of the measurement
        StateMatrix<Axes> covariance = StateMatrix<Axes>::Zero();  ///< given all before
        State change = State::Zero();  ///< given all before, then by all
    };

    enum class Curvature { reweighted, newton };

    /// On the position seen, by a measurement.
    struct Information {
        PositionSquare matrix;
        double determinant = 0.0;
    };

    const ChainStep<Axes>& step_of(const StepKind& kind, bool bridged);
    State defect_gradient(std::size_t k) const;
    void set_gradients();
    Information information_of(const Link& link, Curvature curvature) const;
    void pass_along(Curvature curvature);
    State pull_on_prediction(std::size_t k, const State& after) const;
    double pass_back();
    Position missed_after(const Link& link) const;
    State defect_after(std::size_t k) const;
    double loss(const Position& missed) const;
    double defect_cost(std::size_t k, const State& defect) const;
    double cost() const;
    double cost_after() const;
    double cost_after_shortened(Curvature curvature, double allowed);
    double cost_after_lengthened(double stands, double then, double falls);
    void take_changes();

    std::span<const ArcEpoch<Axes>> stretch_;
    EstimationModel model_;
    double scale_squared_;
    State prior_variance_;
    std::map<std::pair<StepKind, bool>, ChainStep<Axes>>
        steps_;  ///< by nanoseconds; links refer to them
    std::vector<Link> links_;
    std::int64_t iterations_ = 0;
    double length_ = 1.0;      ///< of the step that would have gained most, as last told
    bool lengthened_ = false;  ///< the last step
};

}  // namespace runcert
