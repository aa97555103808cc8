#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "motion/kalman.h"
#include "stages/smooth/chain_step.h"

namespace runcert {

/// The robust least-squares problem of one stretch of an arc (batch.h), iterated over the chain of
/// its states. Each iteration takes the cost as quadratic around the current states. It solves the
/// quadratic problem by one pass along the chain and one back, as a Kalman filter and smoother
/// would. The minimum is that of the general solver, which treats the problem as a sparse matrix
/// (BatchProblem, with a scale), in a tenth of its time.
///
/// It begins with reweighted steps [HW77], which cannot raise the cost from any start. Once the
/// gain is small it continues with Newton steps, whose convergence is quadratic.
///
/// Only differences are iterated: those of the states from the start, and the resulting misfit of
/// each measurement and each time step. With a close start, rounding of large coordinates does not
/// hide the remaining changes of the cost.
template <int Axes>
class RobustChain {
  public:
    /// The stretch must outlive the chain, and its first epoch must have a measurement. `start` has
    /// a state for each epoch. `scale` is that of the Cauchy loss, in standard deviations.
    RobustChain(std::span<const ArcEpoch<Axes>> stretch, const EstimationModel& model,
                std::span<const StateVector<Axes>> start, double scale);

    /// Iterates until a whole Newton step, or a reweighted one where rounding hides the gain of
    /// Newton's, moves no state by more than 1e-6 of its standard deviation. Where rounding hides
    /// the gain, or the allowed iterations are not enough, it returns whether the remainder moves
    /// none by more than 0.1.
    bool solve(std::int64_t iterations_allowed);

    std::int64_t iterations() const { return iterations_; }

    /// The difference of epoch k's state from its start.
    const StateVector<Axes>& move(std::size_t k) const { return links_[k].move; }

  private:
    using State = StateVector<Axes>;
    using Position = PositionVector<Axes>;
    using PositionSquare = PositionMatrix<Axes>;

    /// One epoch: the current state of the iteration, and the results of the passes of one
    /// iteration.
    struct Link {
        const ChainStep<Axes>* step = nullptr;  ///< from the previous epoch; null at the first
        bool measured = false;
        bool was_vague = false;  ///< the prediction, before the measurement
        PositionSquare whitener = PositionSquare::Zero();
        Position missed = Position::Zero();  ///< measured minus predicted by the state, whitened
        State defect = State::Zero();        ///< the state minus its prediction from the previous
                                             ///< one
        State move = State::Zero();
        State gradient = State::Zero();                            ///< of half the cost
        PositionSquare information = PositionSquare::Zero();       ///< of the measurement
        StateMatrix<Axes> covariance = StateMatrix<Axes>::Zero();  ///< given all earlier epochs
        State change = State::Zero();  ///< given all earlier epochs, then given all
    };

    enum class Curvature { reweighted, newton };

    /// Information of a measurement on the observed position.
    struct Information {
        PositionSquare matrix;
        double determinant = 0.0;
    };

    const ChainStep<Axes>& step_of(const StepKind& kind);
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
    std::map<StepKind, ChainStep<Axes>> steps_;  ///< the links refer to these
    std::vector<Link> links_;
    std::int64_t iterations_ = 0;
    double length_ = 1.0;      ///< step length that would have gained most, by the latest estimate
    bool lengthened_ = false;  ///< whether the last step was lengthened
};

}  // namespace runcert
