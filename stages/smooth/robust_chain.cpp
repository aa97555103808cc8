#include "stages/smooth/robust_chain.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <limits>

#include "stages/smooth/robust_batch.h"

namespace runcert {
namespace {

constexpr double newton_below = 1e-4;  // of the cost: what a reweighted step still gains
constexpr double rounding_of_cost = 1e-13;
/// What the linear part of the cost falls by is the squared length of the step in standard
/// deviations of the estimate, all states taken together: no state moves by more than its root.
constexpr double square_of_a_last_step = 1e-12;
/// Where rounding hides what a step gains, or the steps allowed are used up, a tenth of a standard
/// deviation may be left, of all states together.
constexpr double square_left_at_last = 1e-2;
constexpr int halvings = 4;  // of a Newton step that is too long, before a reweighted one
/// Newton's curvature of a far measurement is negative. Where little else is known of the state it
/// would be left with less than this part of its information: there the step is a reweighted one.
constexpr double least_information = 0.05;

/// A prediction is vague where the measurement says so many times more of the position.
constexpr double vague_before = 1e3;

/// What a measurement sees of a state, and what it says to one.
template <int Axes>
PositionVector<Axes> seen(const StateVector<Axes>& state) {
    return state.template head<Axes>() + state.template tail<Axes>();
}
template <int Axes>
void add_seen(const PositionVector<Axes>& said, StateVector<Axes>& state) {
    state.template head<Axes>() += said;
    state.template tail<Axes>() += said;
}

}  // namespace

template <int Axes>
RobustChain<Axes>::RobustChain(std::span<const ArcEpoch<Axes>> stretch,
                               const EstimationModel& model,
                               std::span<const StateVector<Axes>> start, double scale)
    : stretch_(stretch), model_(model), scale_squared_(scale * scale), links_(stretch.size()) {
    assert(start.size() == stretch.size() && stretch.front().measurement);
    const StateEstimate<Axes> prior =
        KalmanFilter<Axes>(model).prior(stretch.front().measurement->position);
    prior_variance_ = prior.covariance.diagonal();  // all of the covariance: it is diagonal
    for (std::size_t k = 0; k < stretch.size(); ++k) {
        Link& link = links_[k];
        if (k > 0) {
            link.step = &step_of(step_kind(stretch[k - 1], stretch[k]), stretch[k].step_before);
            link.defect = start[k] - link.step->carried(start[k - 1]);
        } else {
            link.defect = start[k] - prior.mean;
        }
        link.measured = stretch[k].measurement.has_value();
        if (!link.measured) continue;
        link.whitener = whitener<Axes>(*stretch[k].measurement, model);
        link.missed = link.whitener *
                      KalmanFilter<Axes>::residual(start[k], stretch[k].measurement->position);
    }
}

template <int Axes>
const ChainStep<Axes>& RobustChain<Axes>::step_of(const StepKind& kind, bool bridged) {
    const auto at = steps_.try_emplace({kind, bridged}, model_, kind, bridged).first;
    return at->second;
}

template <int Axes>
StateVector<Axes> RobustChain<Axes>::defect_gradient(std::size_t k) const {
    const Link& link = links_[k];
    if (!link.step) return link.defect.cwiseQuotient(prior_variance_);
    return link.step->unwhitened(link.step->whitened(link.defect));
}

template <int Axes>
void RobustChain<Axes>::set_gradients() {
    State by_defect = defect_gradient(0);
    for (std::size_t k = 0; k < links_.size(); ++k) {
        Link& link = links_[k];
        link.gradient = by_defect;
        if (link.measured) {
            const double weight = 1.0 / (1.0 + link.missed.squaredNorm() / scale_squared_);
            const Position said = -weight * (link.whitener.transpose() * link.missed);
            add_seen<Axes>(said, link.gradient);
        }
        if (k + 1 == links_.size()) break;
        by_defect = defect_gradient(k + 1);
        link.gradient -= links_[k + 1].step->carried_back(by_defect);
    }
}

/// What the measurement adds to the information on the position seen: by its weight w alone, or
/// with what changing the state changes of the weight, w I - 2 (w / scale)^2 r r' in whitened
/// terms.
template <int Axes>
PositionMatrix<Axes> RobustChain<Axes>::information_of(const Link& link,
                                                       Curvature curvature) const {
    const double weight = 1.0 / (1.0 + link.missed.squaredNorm() / scale_squared_);
    PositionSquare white = weight * PositionSquare::Identity();
    if (curvature == Curvature::newton)
        white -= (2.0 * weight * weight / scale_squared_) * link.missed * link.missed.transpose();
    return link.whitener.transpose() * white * link.whitener;
}

/// From the first epoch to the last: each state's change and covariance given all that comes
/// before it and at it.
template <int Axes>
void RobustChain<Axes>::pass_along(Curvature curvature) {
    StateMatrix<Axes> covariance = prior_variance_.asDiagonal();
    State change = State::Zero();
    for (Link& link : links_) {
        if (link.step) {
            covariance = link.step->predicted(covariance);
            change = link.step->carried(change);
        }
        State pull = -link.gradient;
        if (link.measured) {
            const Eigen::Matrix<double, state_size<Axes>, Axes> columns =
                covariance.template leftCols<Axes>() + covariance.template rightCols<Axes>();
            const PositionSquare known =
                columns.template topRows<Axes>() + columns.template bottomRows<Axes>();
            // With known = L L' and information M, inverse(inverse(M) + known) is
            // inverse(L') inverse(C) L' M, C = I + L' M L: M need have no inverse, and nothing
            // large is subtracted where little is known.
            const PositionSquare factor = known.llt().matrixL();
            const auto gained = [&](const PositionSquare& information) {
                return Eigen::LLT<PositionSquare>(PositionSquare::Identity() +
                                                  factor.transpose() * information * factor);
            };
            link.information = information_of(link, curvature);
            link.was_vague =
                (factor.transpose() * link.information * factor).trace() > vague_before;
            Eigen::LLT<PositionSquare> gain = gained(link.information);
            if (gain.info() != Eigen::Success ||
                gain.matrixLLT().diagonal().cwiseAbs2().minCoeff() < least_information) {
                link.information = information_of(link, Curvature::reweighted);
                gain = gained(link.information);
            }
            const PositionSquare through = factor.transpose() * link.information;
            const PositionSquare joint =
                factor.transpose().template triangularView<Eigen::Upper>().solve(
                    gain.solve(through));
            const Eigen::Matrix<double, state_size<Axes>, Axes> weighted =
                columns.lazyProduct(joint);
            covariance -= weighted.lazyProduct(columns.transpose());
            add_seen<Axes>(-link.information * seen<Axes>(change), pull);
        }
        covariance = (0.5 * (covariance + covariance.transpose())).eval();
        change += covariance.lazyProduct(pull);
        link.covariance = covariance;
        link.change = change;
    }
}

/// What the measurements of epoch k and after say to the state predicted there, whose covariance
/// times it is the change they make. That is what comes after, and what is said at k itself; where
/// the prediction was vague the latter all but cancels the former, and the change they made says
/// it.
template <int Axes>
StateVector<Axes> RobustChain<Axes>::pull_on_prediction(std::size_t k, const State& after) const {
    const Link& link = links_[k];
    if (link.was_vague) {
        const StateMatrix<Axes> covariance = link.step->predicted(links_[k - 1].covariance);
        const State inverse_sigma = covariance.diagonal().cwiseSqrt().cwiseInverse();
        const StateMatrix<Axes> scaled =
            inverse_sigma.asDiagonal() * covariance * inverse_sigma.asDiagonal();
        const State made = link.change - link.step->carried(links_[k - 1].change);
        return inverse_sigma.cwiseProduct(scaled.llt().solve(inverse_sigma.cwiseProduct(made)));
    }
    State pull = after - link.gradient;
    if (link.measured) add_seen<Axes>(-link.information * seen<Axes>(link.change), pull);
    return pull;
}

/// From the last epoch to the first: each state's change given all; how much half the cost's linear
/// part falls by these changes, which is twice what is gained where the quadratic problem is right.
template <int Axes>
double RobustChain<Axes>::pass_back() {
    State pull = State::Zero();  // of all that comes after
    double falls = 0.0;
    for (std::size_t k = links_.size(); k-- > 0;) {
        Link& link = links_[k];
        link.change += link.covariance.lazyProduct(pull);
        falls -= link.gradient.dot(link.change);
        if (k == 0) break;
        pull = link.step->carried_back(pull_on_prediction(k, pull));
    }
    return falls;
}

template <int Axes>
PositionVector<Axes> RobustChain<Axes>::missed_after(const Link& link) const {
    return link.missed - link.whitener * seen<Axes>(link.change);
}

template <int Axes>
StateVector<Axes> RobustChain<Axes>::defect_after(std::size_t k) const {
    const Link& link = links_[k];
    if (!link.step) return link.defect + link.change;
    return link.defect + (link.change - link.step->carried(links_[k - 1].change));
}

template <int Axes>
double RobustChain<Axes>::loss(const Position& missed) const {
    return scale_squared_ * std::log1p(missed.squaredNorm() / scale_squared_);
}

template <int Axes>
double RobustChain<Axes>::defect_cost(std::size_t k, const State& defect) const {
    const ChainStep<Axes>* step = links_[k].step;
    return step ? step->whitened(defect).squaredNorm()
                : defect.cwiseAbs2().cwiseQuotient(prior_variance_).sum();
}

template <int Axes>
double RobustChain<Axes>::cost() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        sum += defect_cost(k, links_[k].defect);
        if (links_[k].measured) sum += loss(links_[k].missed);
    }
    return sum;
}

template <int Axes>
double RobustChain<Axes>::cost_after() const {
    double sum = 0.0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
        sum += defect_cost(k, defect_after(k));
        if (links_[k].measured) sum += loss(missed_after(links_[k]));
    }
    return sum;
}

template <int Axes>
void RobustChain<Axes>::take_changes() {
    for (std::size_t k = 0; k < links_.size(); ++k) {
        Link& link = links_[k];
        link.defect = defect_after(k);
        if (link.measured) link.missed = missed_after(link);
        link.move += link.change;
    }
}

/// The cost after the changes, which a Newton step that would raise it is shortened for: its
/// direction lowers the cost, but not from wherever it begins by its whole length.
template <int Axes>
double RobustChain<Axes>::cost_after_shortened(Curvature curvature, double allowed) {
    double then = cost_after();
    for (int i = 0; curvature == Curvature::newton && i < halvings && !(then <= allowed); ++i) {
        for (Link& link : links_)
            link.change *= 0.5;
        then = cost_after();
    }
    return then;
}

template <int Axes>
bool RobustChain<Axes>::solve(std::int64_t iterations_allowed) {
    Curvature curvature = Curvature::reweighted;
    bool newton_refused = false;  // where the iteration stands
    double left = std::numeric_limits<double>::infinity();
    double stands = cost();
    while (iterations_ < iterations_allowed) {
        ++iterations_;
        set_gradients();
        pass_along(curvature);
        const double falls = pass_back();
        const double allowed = stands * (1.0 + rounding_of_cost);
        const double then = cost_after_shortened(curvature, allowed);
        if (!std::isfinite(then) || !std::isfinite(falls)) return false;
        left = falls;
        const bool near = falls <= square_of_a_last_step;
        if (then > allowed) {
            // A reweighted step cannot raise the cost: where it does, rounding hides what is left.
            if (curvature == Curvature::reweighted) return falls <= square_left_at_last;
            newton_refused = true;
            curvature = Curvature::reweighted;
            continue;
        }
        take_changes();
        if (near && (curvature == Curvature::newton || newton_refused)) return true;
        newton_refused = false;
        curvature = near || stands - then < newton_below * stands ? Curvature::newton
                                                                  : Curvature::reweighted;
        stands = then;
    }
    // Every step has lowered the cost: what is still left is the question, not how many there were.
    return left <= square_left_at_last;
}

template class RobustChain<1>;
template class RobustChain<2>;

}  // namespace runcert
