#include "stages/smooth/robust_chain.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "stages/smooth/batch_problem.h"

namespace runcert {
namespace {

constexpr double newton_below = 1e-4;  // fraction of the cost that a reweighted step still gains
constexpr double rounding_of_cost = 1e-13;
/// The decrease of the linear part of the cost is the squared length of the step in standard
/// deviations of the estimate, over all states. No state moves by more than its square root.
constexpr double square_of_a_last_step = 1e-12;
/// Where rounding hides the gain, or the allowed iterations are used up, a tenth of a standard
/// deviation may remain, over all states.
constexpr double square_left_at_last = 1e-2;
constexpr int halvings = 4;  // of a Newton step that is too long, before a reweighted one
/// A step that is short by this factor is lengthened, at most by `longest`.
constexpr double lengthened_from = 1.5;
constexpr double longest = 100.0;
/// Decrease, relative to the cost, above which rounding still allows an estimate of how short a
/// step is.
constexpr double length_told_from = 1e-12;
/// Newton's curvature of a distant measurement is negative. Where this would leave a poorly known
/// state with less than this fraction of its information, the step is a reweighted one.
constexpr double least_information = 0.05;

/// A prediction is vague if the measurement has this many times its information on the position.
constexpr double vague_before = 1e3;

/// The combination of a state's components that a measurement observes.
template <int Axes>
PositionVector<Axes> seen(const StateVector<Axes>& state) {
    return state.template head<Axes>() + state.template tail<Axes>();
}
template <int Axes>
void add_seen(const PositionVector<Axes>& said, StateVector<Axes>& state) {
    state.template head<Axes>() += said;
    state.template tail<Axes>() += said;
}

/// The effect of a measurement of information M on an observed position with prior covariance K.
template <int Axes>
struct Gain {
    PositionMatrix<Axes> joint;  ///< inverse(inverse(M) + K)
    double trace = 0.0;          ///< of M K
    double least = 0.0;  ///< smallest squared diagonal of the factor of C = I + L' M L, with
                         ///< K = L L'
};

/// The closed form subtracts nothing if M is positive definite. M need have no inverse, and K
/// may be large where little is known. For 2 x 2 matrices,
/// inverse(inverse(M) + K) = (M + det(M) adj(K)) / det(C), det(C) = 1 + tr(M K) + det(M) det(K).
template <int Axes>
Gain<Axes> gain_of(const PositionMatrix<Axes>& information, double determinant,
                   const PositionMatrix<Axes>& known) {
    Gain<Axes> gain;
    if constexpr (Axes == 1) {
        gain.trace = information(0) * known(0);
        gain.least = 1.0 + gain.trace;
        gain.joint = information / gain.least;
    } else {
        gain.trace = information.cwiseProduct(known).sum();
        const double of_c = 1.0 + gain.trace + determinant * known.determinant();
        const double first = 1.0 + (known.col(0).dot(information * known.col(0))) / known(0, 0);
        gain.least = std::min(first, of_c / first);
        PositionMatrix<Axes> adjugate;
        adjugate << known(1, 1), -known(0, 1), -known(0, 1), known(0, 0);
        gain.joint = (information + determinant * adjugate) / of_c;
    }
    return gain;
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
    prior_variance_ = prior.covariance.diagonal();  // the whole covariance, which is diagonal
    for (std::size_t k = 0; k < stretch.size(); ++k) {
        Link& link = links_[k];
        if (k > 0) {
            link.step = &step_of(step_kind(stretch[k - 1], stretch[k]));
            link.defect = start[k] - link.step->carried(start[k - 1]);
        } else {
            link.defect = start[k] - prior.mean;
        }
        link.measured = stretch[k].measurement.has_value();
        if (!link.measured) continue;
        link.whitener = whitener<Axes>(*stretch[k].measurement, model);
        link.missed = link.whitener * (stretch[k].measurement->position - seen<Axes>(start[k]));
    }
}

template <int Axes>
const ChainStep<Axes>& RobustChain<Axes>::step_of(const StepKind& kind) {
    return steps_.try_emplace(kind, model_, kind).first->second;
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

/// The measurement's contribution to the information on the observed position. It uses its weight w
/// alone, or includes the change of the weight with the state: w I - 2 (w / scale)^2 r r' in
/// whitened terms.
template <int Axes>
typename RobustChain<Axes>::Information RobustChain<Axes>::information_of(
    const Link& link, Curvature curvature) const {
    const double square = link.missed.squaredNorm() / scale_squared_;
    const double weight = 1.0 / (1.0 + square);
    PositionSquare white = weight * PositionSquare::Identity();
    double along = weight;  // along the residual
    if (curvature == Curvature::newton) {
        white -= (2.0 * weight * weight / scale_squared_) * link.missed * link.missed.transpose();
        along = weight * weight * (1.0 - square);
    }
    const double of_whitener = link.whitener.diagonal().prod();  // the whitener is triangular
    return {.matrix = link.whitener.transpose() * white * link.whitener,
            .determinant = along * (Axes == 1 ? 1.0 : weight) * of_whitener * of_whitener};
}

/// Forward pass: each state's change and covariance given all measurements up to and including it.
template <int Axes>
void RobustChain<Axes>::pass_along(Curvature curvature) {
    StateMatrix<Axes> covariance = prior_variance_.asDiagonal();
    State change = State::Zero();
    for (Link& link : links_) {
        if (link.step) {
            link.step->predict(covariance);
            change = link.step->carried(change);
        }
        State pull = -link.gradient;
        if (link.measured) {
            const Eigen::Matrix<double, state_size<Axes>, Axes> columns =
                covariance.template leftCols<Axes>() + covariance.template rightCols<Axes>();
            const PositionSquare known =
                columns.template topRows<Axes>() + columns.template bottomRows<Axes>();
            Information information = information_of(link, curvature);
            Gain<Axes> gain = gain_of<Axes>(information.matrix, information.determinant, known);
            link.was_vague = gain.trace > vague_before;
            if (!(gain.least >= least_information)) {
                information = information_of(link, Curvature::reweighted);
                gain = gain_of<Axes>(information.matrix, information.determinant, known);
            }
            link.information = information.matrix;
            const Eigen::Matrix<double, state_size<Axes>, Axes> weighted =
                columns.lazyProduct(gain.joint);
            covariance -= weighted.lazyProduct(columns.transpose());
            add_seen<Axes>(-link.information * seen<Axes>(change), pull);
        }
        change += covariance.lazyProduct(pull);
        link.covariance = covariance;
        link.change = change;
    }
}

/// The pull of the measurements from epoch k on, on the state predicted there. The predicted
/// covariance times the pull is the change that they cause. It is the sum of the later pull and
/// that at k itself. Where the prediction was vague the two nearly cancel, and the pull follows
/// from the change itself.
template <int Axes>
StateVector<Axes> RobustChain<Axes>::pull_on_prediction(std::size_t k, const State& after) const {
    const Link& link = links_[k];
    if (link.was_vague) {
        StateMatrix<Axes> covariance = links_[k - 1].covariance;
        link.step->predict(covariance);
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

/// Backward pass: each state's change given all measurements. Returns the decrease of half the
/// cost's linear part through these changes, which is twice the gain where the quadratic problem is
/// exact.
template <int Axes>
double RobustChain<Axes>::pass_back() {
    State pull = State::Zero();  // of all later measurements
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

/// The cost after the changes. A Newton step that would raise it is shortened: its direction lowers
/// the cost, but its whole length need not.
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

/// The cost after the changes, `then`, or after longer ones. Where Newton's curvature is unusable,
/// the substitute makes steps too short, and the following ones as well: hundreds of them, a
/// twentieth of the way each.
///
/// Along the step the cost is quadratic. The slope of half of it at the beginning is `falls`, and
/// the whole step gained a known amount. The best length is falls / (2 falls - gained). A
/// lengthened step disturbs states that were already right, so that a whole step follows each
/// lengthened one.
template <int Axes>
double RobustChain<Axes>::cost_after_lengthened(double stands, double then, double falls) {
    if (lengthened_) {
        lengthened_ = false;
        return then;
    }
    if (falls > length_told_from * stands)
        length_ = std::clamp(falls / std::max(2.0 * falls - (stands - then), falls / longest), 1.0,
                             longest);
    if (length_ < lengthened_from) return then;
    const auto stretch_by = [&](double factor) {
        for (Link& link : links_)
            link.change *= factor;
    };
    stretch_by(length_);
    const double longer = cost_after();
    lengthened_ = longer <= then;
    if (lengthened_) return longer;
    stretch_by(1.0 / length_);
    return then;
}

template <int Axes>
bool RobustChain<Axes>::solve(std::int64_t iterations_allowed) {
    Curvature curvature = Curvature::reweighted;
    bool newton_refused = false;  // at the current states
    double left = std::numeric_limits<double>::infinity();
    double stands = cost();
    while (iterations_ < iterations_allowed) {
        ++iterations_;
        set_gradients();
        pass_along(curvature);
        const double falls = pass_back();
        const double allowed = stands * (1.0 + rounding_of_cost);
        double then = cost_after_shortened(curvature, allowed);
        if (!std::isfinite(then) || !std::isfinite(falls)) return false;
        left = falls;
        const bool near = falls <= square_of_a_last_step;
        if (then > allowed) {
            // A reweighted step cannot raise the cost. Where it seems to, rounding hides the
            // remainder.
            if (curvature == Curvature::reweighted) return falls <= square_left_at_last;
            newton_refused = true;
            curvature = Curvature::reweighted;
            continue;
        }
        if (!near) then = cost_after_lengthened(stands, then, falls);
        take_changes();
        if (near && (curvature == Curvature::newton || newton_refused)) return true;
        newton_refused = false;
        curvature = near || stands - then < newton_below * stands ? Curvature::newton
                                                                  : Curvature::reweighted;
        stands = then;
    }
    // Every step has lowered the cost. What counts is how much is left, not how many steps it took.
    return left <= square_left_at_last;
}

template class RobustChain<1>;
template class RobustChain<2>;

}  // namespace runcert
