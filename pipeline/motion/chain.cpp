#include "motion/chain.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/failure.h"

namespace runcert {
namespace {

template <int Axes>
using Factor = Eigen::LLT<StateMatrix<Axes>>;

/// The Cholesky factor of a covariance. If it fails to be positive definite only by rounding, so
/// that adding 1e-9 of each variance makes it so, that is added.
template <int Axes>
Factor<Axes> factorise(const StateMatrix<Axes>& covariance, double time_s) {
    const Factor<Axes> factor(covariance);
    // NaN passes the factorisation.
    if (factor.info() == Eigen::Success && covariance.allFinite()) return factor;
    if (covariance.allFinite() && (covariance.diagonal().array() > 0.0).all()) {
        constexpr double rounding = 1e-9;
        StateMatrix<Axes> mended = covariance;
        mended.diagonal() *= 1.0 + rounding;
        const Factor<Axes> again(mended);
        if (again.info() == Eigen::Success) return again;
    }
    throw Failure(fmt::format("time {:.3f} s", time_s),
                  "the predicted covariance is not positive definite",
                  "Check the stated standard deviations and the time steps around this epoch");
}

/// Whether a predicted state is so uncertain that P - P N P would lose digits.
template <int Axes>
bool is_vague(const StateMatrix<Axes>& covariance) {
    constexpr double position_m2 = 100.0, velocity_m2_s2 = 100.0, acceleration_m2_s4 = 1000.0;
    const auto& variance = covariance.diagonal();
    return variance.template head<Axes>().maxCoeff() > position_m2 ||
           variance.template segment<Axes>(Axes).maxCoeff() > velocity_m2_s2 ||
           variance.template segment<Axes>(2 * Axes).maxCoeff() > acceleration_m2_s4;
}

/// The RTS step [YSM22]: what later measurements say of the next epoch changes the state given
/// those up to its own.
template <int Axes>
StateEstimate<Axes> step_back(const StateEstimate<Axes>& filtered, const StateMatrix<Axes>& gain,
                              const StateEstimate<Axes>& next,
                              const StateEstimate<Axes>& next_predicted) {
    const StateMatrix<Axes> covariance =
        filtered.covariance +
        gain * (next.covariance - next_predicted.covariance) * gain.transpose();
    return {.mean = filtered.mean + gain * (next.mean - next_predicted.mean),
            .covariance = 0.5 * (covariance + covariance.transpose())};
}

}  // namespace

template <int Axes>
StateEstimate<Axes> Chain<Axes>::Epoch::filtered() const {
    StateEstimate<Axes> estimate = predicted;
    if (!measured) return estimate;
    for (int j = 0; j < Axes; ++j) {
        const auto& one = seen.coordinates[j];
        const double weight = one.innovation / one.variance;
        for (int i = 0; i < state_size<Axes>; ++i)
            estimate.mean(i) += one.cross[i] * weight;
        kernel::reduce_covariance<Axes>(seen.white, j, one, estimate.covariance.data());
    }
    kernel::mirror<state_size<Axes>>(estimate.covariance.data());
    return estimate;
}

template <int Axes>
PositionMatrix<Axes> Chain<Axes>::Epoch::unwhitening() const {
    PositionMatrix<Axes> transposed;
    for (int j = 0; j < Axes; ++j)
        for (int k = 0; k < Axes; ++k)
            transposed(k, j) = seen.white.row[j][k];
    return transposed;
}

template <int Axes>
typename Chain<Axes>::Positions Chain<Axes>::Epoch::gain() const {
    Positions gain;
    for (int j = Axes; j-- > 0;) {
        const auto& one = seen.coordinates[j];
        for (int i = 0; i < state_size<Axes>; ++i)
            gain(i, j) = one.cross[i] / one.variance;
        // What the later coordinates take back of this one's change.
        const StateVector<Axes> own = gain.col(j);
        for (int l = j + 1; l < Axes; ++l)
            gain.col(j) -= gain.col(l) * kernel::observed<Axes>(seen.white, l, own.data());
    }
    return gain * unwhitening().transpose();
}

template <int Axes>
Chain<Axes>::Chain(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model)
    : Chain(arc, model, Backward::scores_and_information) {}

template <int Axes>
Chain<Axes>::Chain(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model,
                   Backward backward)
    : epochs_(arc.size()), model_(model) {
    assert(!arc.empty() && arc.front().measurement);
    go_forward(arc);
    for (std::size_t k = arc.size(); k-- > 0;) {
        Epoch& epoch = epochs_[k];
        if (k + 1 < arc.size()) {
            epoch.score = epochs_[k + 1].score;
            kernel::carry_back<Axes>(step_after(k), epoch.score.data());
            if (backward == Backward::scores_and_information) {
                epoch.information = epochs_[k + 1].information;
                kernel::carry_information_back<Axes>(step_after(k), epoch.information.data());
            }
        }
        if (epoch.measured) update_backwards(epoch, backward);
    }
    smooth_vague_states();
}

template <int Axes>
void Chain<Axes>::go_forward(std::span<const ArcEpoch<Axes>> arc) {
    KalmanFilter<Axes> filter(model_);
    times_s_.reserve(arc.size());
    std::int64_t last_ns = -1;
    filter_along<Axes>(filter, arc,
                       [&](std::size_t k, const StateEstimate<Axes>& predicted,
                           const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                           Epoch& epoch = epochs_[k];
                           times_s_.push_back(arc[k].time_s);
                           epoch.predicted = predicted;
                           if (!seen) return;
                           epoch.measured = true;
                           epoch.seen = *seen;
                           innovation_sum_ += seen->statistic();
                           ++measurements_;
                       });
    for (std::size_t k = 0; k + 1 < arc.size(); ++k) {
        const StepKind kind = step_kind(arc[k], arc[k + 1]);
        if (kind.length_ns != last_ns) steps_.push_back(filter.numbers_of(kind));
        last_ns = kind.length_ns;
        epochs_[k].step = steps_.size() - 1;
    }
}

/// From what later epochs say to what this one and they do.
template <int Axes>
void Chain<Axes>::update_backwards(Epoch& epoch, Backward backward) const {
    StateMatrix<Axes>& information = epoch.information;
    PositionVector<Axes> scores;
    PositionMatrix<Axes> precisions;
    for (int j = Axes; j-- > 0;) {
        const auto& one = epoch.seen.coordinates[j];
        const StateVector<Axes> gain =
            Eigen::Map<const StateVector<Axes>>(one.cross.data()) / one.variance;
        scores(j) = one.innovation / one.variance - gain.dot(epoch.score);
        kernel::add_observed<Axes>(epoch.seen.white, j, scores(j), epoch.score.data());
        if (backward == Backward::scores) continue;
        const StateVector<Axes> informed = information.lazyProduct(gain);
        const double precision = 1.0 / one.variance + gain.dot(informed);
        precisions(j, j) = precision;
        for (int i = 0; i < j; ++i) {
            const auto& earlier = epoch.seen.coordinates[i];
            const StateVector<Axes> its_gain =
                Eigen::Map<const StateVector<Axes>>(earlier.cross.data()) / earlier.variance;
            precisions(i, j) = precisions(j, i) =
                its_gain.dot(informed) -
                kernel::observed<Axes>(epoch.seen.white, j, its_gain.data()) * precision;
        }
        // (I - k z)' N (I - k z) + z' z / f = N - z' m' - m z, with m = N k - z' D / 2.
        StateVector<Axes> m = informed;
        kernel::add_observed<Axes>(epoch.seen.white, j, -0.5 * precision, m.data());
        StateVector<Axes> z = StateVector<Axes>::Zero();
        kernel::add_observed<Axes>(epoch.seen.white, j, 1.0, z.data());
        for (const int block : {0, 3 * Axes})
            for (int i = block; i <= block + j; ++i) {
                information.col(i) -= z(i) * m;
                information.row(i) -= z(i) * m.transpose();
            }
    }
    if (backward == Backward::scores) return;
    const PositionMatrix<Axes> back = epoch.unwhitening();
    epoch.own_score = back * scores;
    epoch.own_precision = back * precisions * back.transpose();
}

template <int Axes>
void Chain<Axes>::smooth_vague_states() {
    for (std::size_t k = size(); k-- > 0;) {
        if (!is_vague<Axes>(epochs_[k].predicted.covariance)) continue;
        const StateEstimate<Axes> filtered = epochs_[k].filtered();
        vague_.emplace(k, k + 1 < size() ? step_back(filtered, smoother_gain(k, filtered),
                                                     state(k + 1), epochs_[k + 1].predicted)
                                         : filtered);
    }
}

template <int Axes>
StateMatrix<Axes> Chain<Axes>::smoother_gain(std::size_t k,
                                             const StateEstimate<Axes>& filtered) const {
    StateMatrix<Axes> cross = filtered.covariance;
    for (int column = 0; column < state_size<Axes>; ++column)
        kernel::carry<Axes>(step_after(k), cross.col(column).data());
    return factorise<Axes>(epochs_[k + 1].predicted.covariance, times_s_[k + 1])
        .solve(cross)
        .transpose();
}

template <int Axes>
std::optional<double> Chain<Axes>::innovation(std::size_t k) const {
    const Epoch& epoch = epochs_[k];
    if (!epoch.measured || !epoch.seen.tests_model) return std::nullopt;
    return epoch.seen.statistic();
}

template <int Axes>
StateVector<Axes> Chain<Axes>::mean(std::size_t k) const {
    if (const auto vague = vague_.find(k); vague != vague_.end()) return vague->second.mean;
    const StateEstimate<Axes>& predicted = epochs_[k].predicted;
    return predicted.mean + predicted.covariance.lazyProduct(epochs_[k].score);
}

template <int Axes>
StateMatrix<Axes> Chain<Axes>::smoothed_covariance(std::size_t k) const {
    if (const auto vague = vague_.find(k); vague != vague_.end()) return vague->second.covariance;
    const StateMatrix<Axes>& p = epochs_[k].predicted.covariance;
    const StateMatrix<Axes> informed = epochs_[k].information.lazyProduct(p);
    const StateMatrix<Axes> smoothed = p - p.lazyProduct(informed);
    if (!(smoothed.diagonal().array() > 0.0).all())
        throw Failure(fmt::format("time {:.3f} s", times_s_[k]),
                      "the smoothed covariance is not positive definite",
                      "Check the stated standard deviations and the time steps around this epoch");
    return smoothed;
}

template <int Axes>
StateEstimate<Axes> Chain<Axes>::state(std::size_t k) const {
    const StateMatrix<Axes> smoothed = smoothed_covariance(k);
    return {.mean = mean(k), .covariance = 0.5 * (smoothed + smoothed.transpose())};
}

template <int Axes>
PositionMatrix<Axes> Chain<Axes>::covariance_of(int kind, std::size_t k) const {
    const int at = kind * Axes;
    if (const auto vague = vague_.find(k); vague != vague_.end())
        return vague->second.covariance.template block<Axes, Axes>(at, at);
    const StateMatrix<Axes>& p = epochs_[k].predicted.covariance;
    const Positions columns = p.template middleCols<Axes>(at);
    const Positions informed = epochs_[k].information.lazyProduct(columns);
    return p.template block<Axes, Axes>(at, at) - columns.transpose().lazyProduct(informed);
}

template <int Axes>
double Chain<Axes>::asymmetry(std::size_t k) const {
    const StateMatrix<Axes> smoothed = smoothed_covariance(k);
    return (smoothed - smoothed.transpose()).norm() / smoothed.norm();
}

template <int Axes>
std::vector<StateEstimate<Axes>> Chain<Axes>::fixed_lag(std::size_t lag) const {
    std::vector<StateEstimate<Axes>> filtered(size()), states(size());
    std::vector<StateMatrix<Axes>> gains(size());
    const std::size_t end = size() - 1;
    for (std::size_t k = 0; k <= end; ++k) {
        filtered[k] = epochs_[k].filtered();
        if (k < end && lag > 0) gains[k] = smoother_gain(k, filtered[k]);
    }
    if (lag == 0) return filtered;
    for (std::size_t k = 0; k <= end; ++k) {
        if (lag >= end - k) {
            states[k] = state(k);
            continue;
        }
        states[k] = filtered[k + lag];
        for (std::size_t j = k + lag; j-- > k;)
            states[k] = step_back(filtered[j], gains[j], states[k], epochs_[j + 1].predicted);
    }
    return states;
}

template <int Axes>
StateMatrix<Axes> Chain<Axes>::cross_covariance(std::size_t s, std::size_t e) const {
    StateMatrix<Axes> product = state(e).covariance;
    for (std::size_t k = e; k-- > s;)
        product = smoother_gain(k, epochs_[k].filtered()) * product;
    return product;
}

/// Backwards in time the states are a Markov chain, x[k] = m[k] + G[k] (x[k+1] - m[k+1]) + w, w of
/// variance V[k] - G[k] V[k+1] G[k]'.
template <int Axes>
template <int Columns>
Eigen::Matrix<double, Columns, Columns> Chain<Axes>::joint_covariance(
    std::size_t s,
    const std::vector<Eigen::Matrix<double, state_size<Axes>, Columns>>& gradients) const {
    assert(!gradients.empty() && s + gradients.size() <= size());
    using Gradient = Eigen::Matrix<double, state_size<Axes>, Columns>;
    using Covariance = Eigen::Matrix<double, Columns, Columns>;
    const auto of = [](const Gradient& gradient, const StateMatrix<Axes>& covariance) {
        return Covariance(gradient.transpose() * (covariance * gradient));
    };
    Covariance sum = Covariance::Zero();
    Gradient carried = gradients[0];
    StateMatrix<Axes> own = state(s).covariance;
    for (std::size_t i = 0; i + 1 < gradients.size(); ++i) {
        const std::size_t k = s + i;
        const Gradient next = smoother_gain(k, epochs_[k].filtered()).transpose() * carried;
        const StateMatrix<Axes> later = state(k + 1).covariance;
        sum += of(carried, own) - of(next, later);
        carried = gradients[i + 1] + next;
        own = later;
    }
    return sum + of(carried, own);
}

template <int Axes>
double Chain<Axes>::variance(std::size_t s, const Gradients<Axes>& gradients) const {
    return joint_covariance<1>(s, gradients).value();
}

template <int Axes>
SpeedMatrix<Axes> Chain<Axes>::covariance(std::size_t s,
                                          const CountedGradients<Axes>& gradients) const {
    const SpeedMatrix<Axes> covariance = joint_covariance<speed_axes<Axes>>(s, gradients);
    return 0.5 * (covariance + covariance.transpose());
}

/// The adjoint of both passes: the gradients are carried forward through the scores, then back
/// through the predictions.
template <int Axes>
std::vector<PositionVector<Axes>> Chain<Axes>::weights(std::size_t s,
                                                       const Gradients<Axes>& gradients) const {
    assert(s + gradients.size() <= size());
    const auto is_given = [&](std::size_t k) { return k >= s && k < s + gradients.size(); };
    std::vector<PositionVector<Axes>> weights(size(), PositionVector<Axes>::Zero());
    StateVector<Axes> carried = StateVector<Axes>::Zero();
    for (std::size_t k = s; k < size(); ++k) {
        const Epoch& epoch = epochs_[k];
        if (is_given(k)) carried += epoch.predicted.covariance * gradients[k - s];
        for (int j = 0; epoch.measured && j < Axes; ++j) {
            const auto& one = epoch.seen.coordinates[j];
            weights[k](j) =
                kernel::observed<Axes>(epoch.seen.white, j, carried.data()) / one.variance;
            carried -= weights[k](j) * Eigen::Map<const StateVector<Axes>>(one.cross.data());
        }
        if (k + 1 < size()) kernel::carry<Axes>(step_after(k), carried.data());
    }
    StateVector<Axes> back = StateVector<Axes>::Zero();
    for (std::size_t k = size(); k-- > 0;) {
        const Epoch& epoch = epochs_[k];
        if (k + 1 < size()) kernel::carry_back<Axes>(step_after(k), back.data());
        for (int j = Axes; epoch.measured && j-- > 0;) {
            const auto& one = epoch.seen.coordinates[j];
            weights[k](j) +=
                back.dot(Eigen::Map<const StateVector<Axes>>(one.cross.data())) / one.variance;
            kernel::add_observed<Axes>(epoch.seen.white, j, -weights[k](j), back.data());
        }
        if (epoch.measured) weights[k] = epoch.unwhitening() * weights[k];
        if (is_given(k)) back += gradients[k - s];
    }
    return weights;
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::outlier(std::size_t k) const {
    return {.score = epochs_[k].own_score, .precision = epochs_[k].own_precision};
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::left_out(std::size_t k,
                                      const PositionMeasurement<Axes>& measurement) const {
    const StateVector<Axes> state = mean(k);
    const StateMatrix<Axes> of_state = smoothed_covariance(k);
    const double scale = model_.measurement_scale * model_.measurement_scale;
    PositionMatrix<Axes> covariance = scale * measurement.covariance;
    for (const int row : {0, 3 * Axes})
        for (const int column : {0, 3 * Axes})
            covariance += of_state.template block<Axes, Axes>(row, column);
    const PositionMatrix<Axes> precision = covariance.llt().solve(PositionMatrix<Axes>::Identity());
    const PositionVector<Axes> missed =
        measurement.position - state.template head<Axes>() - state.template tail<Axes>();
    return {.score = precision * missed, .precision = precision};
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::step(std::size_t k) const {
    return {.score = epochs_[k].score.template head<Axes>(),
            .precision = epochs_[k].information.template topLeftCorner<Axes, Axes>()};
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::known_step(std::size_t k) const {
    // The offset is a jump of the state with a vague prior. These are its posterior mean and
    // variance.
    constexpr double prior = vague_position_sigma_m * vague_position_sigma_m;
    const Test jump = step(k);
    const PositionVector<Axes> mean = prior * jump.score;
    const PositionMatrix<Axes> variance =
        prior * (PositionMatrix<Axes>::Identity() - prior * jump.precision);
    const PositionMatrix<Axes> precision = variance.llt().solve(PositionMatrix<Axes>::Identity());
    return {.score = precision * mean, .precision = precision};
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::ramp(std::size_t k) const {
    return {.score = epochs_[k].score.template segment<Axes>(Axes),
            .precision = epochs_[k].information.template block<Axes, Axes>(Axes, Axes)};
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::manoeuvre(std::size_t k) const {
    constexpr int acceleration = 2 * Axes;
    return {
        .score = epochs_[k].score.template segment<Axes>(acceleration),
        .precision = epochs_[k].information.template block<Axes, Axes>(acceleration, acceleration)};
}

template <int Axes>
std::optional<ScoreTest<1>> Chain<Axes>::time_shift(std::size_t k) const {
    const StateEstimate<Axes>& predicted = epochs_[k].predicted;
    const PositionVector<Axes> velocity = predicted.mean.template segment<Axes>(Axes);
    const PositionMatrix<Axes> variance =
        predicted.covariance.template block<Axes, Axes>(Axes, Axes);
    constexpr double known_to = 0.1;
    if (variance.trace() > known_to * known_to * velocity.squaredNorm()) return std::nullopt;
    StateVector<Axes> direction = StateVector<Axes>::Zero();
    direction.template head<Axes>() = velocity;
    direction.template segment<Axes>(Axes) = predicted.mean.template segment<Axes>(2 * Axes);
    ScoreTest<1> test;
    // Late stamps show the craft where it was before: the error is minus velocity times delay.
    test.score(0) = -direction.dot(epochs_[k].score);
    test.precision(0, 0) = direction.dot(epochs_[k].information * direction);
    return test;
}

template <int Axes>
ScoreTest<Axes> Chain<Axes>::burst(std::size_t k, std::size_t length) const {
    const std::size_t end = k + length;
    assert(k >= 1 && end < epochs_.size());
    Positions carried = epochs_[end].information.template leftCols<Axes>();
    const PositionMatrix<Axes> at_end = carried.template topRows<Axes>();
    for (std::size_t j = end; j-- > k;)
        carry_back(j, carried);
    const PositionMatrix<Axes> between = carried.template topRows<Axes>();
    return {
        .score = epochs_[k].score.template head<Axes>() - epochs_[end].score.template head<Axes>(),
        .precision = epochs_[k].information.template topLeftCorner<Axes, Axes>() + at_end -
                     between - between.transpose()};
}

template <int Axes>
SetTest Chain<Axes>::own_errors(std::size_t first, std::size_t last) const {
    std::vector<std::size_t> set;
    for (std::size_t k = first; k <= last; ++k)
        if (epochs_[k].measured) set.push_back(k);
    const auto count = static_cast<Eigen::Index>(set.size()) * Axes;
    Eigen::VectorXd score(count);
    Eigen::MatrixXd precision = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index l = 0; l * Axes < count; ++l) {
        const std::size_t k = set[static_cast<std::size_t>(l)];
        score.segment<Axes>(l * Axes) = epochs_[k].own_score;
        precision.block<Axes, Axes>(l * Axes, l * Axes) = epochs_[k].own_precision;
        // Covariance of the score at the predicted state of epoch k with this measurement's own, H'
        // D - F' N F K, carried back to earlier measurements.
        Positions carried = Positions::Zero();
        if (k + 1 < epochs_.size()) {
            StateMatrix<Axes> later = epochs_[k + 1].information;
            kernel::carry_information_back<Axes>(step_after(k), later.data());
            carried = -later * epochs_[k].gain();
        }
        carried.template topRows<Axes>() += epochs_[k].own_precision;
        carried.template bottomRows<Axes>() += epochs_[k].own_precision;
        Eigen::Index row = l;
        for (std::size_t j = k; row > 0 && j-- > first;) {
            transpose_transition(j, carried);
            if (!epochs_[j].measured) continue;
            --row;
            const PositionMatrix<Axes> between = -epochs_[j].gain().transpose() * carried;
            precision.block<Axes, Axes>(row * Axes, l * Axes) = between;
            precision.block<Axes, Axes>(l * Axes, row * Axes) = between.transpose();
            carried.template topRows<Axes>() += between;
            carried.template bottomRows<Axes>() += between;
        }
    }
    return {.statistic = score.dot(precision.llt().solve(score)),
            .degrees_of_freedom = static_cast<int>(count)};
}

template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, const GaussMarkovError& error,
                         std::span<const PositionVector<Axes>> weights) {
    assert(weights.size() == arc.size());
    EstimationModel model;
    model.error = error;
    // Variance of the error, its covariance with the sum so far, and variance of the sum.
    double variance = error.initial_sigma_m * error.initial_sigma_m;
    PositionVector<Axes> with_sum = PositionVector<Axes>::Zero();
    double of_sum = 0.0;
    StepKind kind;
    AxisStep step;
    for (std::size_t k = 0; k < arc.size(); ++k) {
        if (k > 0) {
            const StepKind next = step_kind(arc[k - 1], arc[k]);
            if (next.length_ns != kind.length_ns) step = axis_step(model, next.dt_s());
            kind = next;
            with_sum *= step.error_transition;
            variance = step.error_transition * step.error_transition * variance + step.error_noise;
        }
        of_sum += 2.0 * weights[k].dot(with_sum) + variance * weights[k].squaredNorm();
        with_sum += variance * weights[k];
    }
    return of_sum;
}

template <int Axes>
double weighted_variance(std::span<const ArcEpoch<Axes>> arc, double scale,
                         std::span<const PositionVector<Axes>> weights) {
    double sum = 0.0;
    for (std::size_t k = 0; k < arc.size(); ++k)
        if (arc[k].measurement) sum += weights[k].dot(arc[k].measurement->covariance * weights[k]);
    return scale * scale * sum;
}

#define RUNCERT_INSTANTIATE(AXES)                                                    \
    template class Chain<AXES>;                                                      \
    template double weighted_variance<AXES>(std::span<const ArcEpoch<AXES>>,         \
                                            const GaussMarkovError&,                 \
                                            std::span<const PositionVector<AXES>>);  \
    template double weighted_variance<AXES>(std::span<const ArcEpoch<AXES>>, double, \
                                            std::span<const PositionVector<AXES>>);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
