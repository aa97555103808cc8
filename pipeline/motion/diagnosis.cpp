#include "motion/diagnosis.h"

#include <cassert>
#include <cmath>

namespace runcert {

template <int Axes>
ArcDiagnosis<Axes>::ArcDiagnosis(std::span<const ArcEpoch<Axes>> arc, const EstimationModel& model)
    : epochs_(arc.size()), model_(model) {
    assert(!arc.empty() && arc.front().measurement);
    KalmanFilter<Axes> filter(model);
    filter_along<Axes>(filter, arc,
                       [&](std::size_t k, const StateEstimate<Axes>& predicted,
                           const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                           Epoch& epoch = epochs_[k];
                           epoch.predicted = predicted;
                           if (!seen) return;
                           epoch.measured = true;
                           if (seen->tests_model) epoch.innovation = seen->statistic;
                           epoch.gain = filter.gain(predicted, *seen);
                           epoch.innovation_information =
                               seen->covariance.llt().solve(PositionMatrix<Axes>::Identity());
                           epoch.weighted_residual = epoch.innovation_information * seen->residual;
                       });
    step_of_.resize(arc.size(), 0);
    std::int64_t last_ns = -1;
    for (std::size_t k = 0; k + 1 < arc.size(); ++k) {
        const StepKind kind = step_kind(arc[k], arc[k + 1]);
        if (kind.length_ns != last_ns) steps_.push_back(filter.numbers_of(kind));
        last_ns = kind.length_ns;
        step_of_[k] = steps_.size() - 1;
    }
    for (std::size_t k = arc.size(); k-- > 0;) {
        Epoch& epoch = epochs_[k];
        StateVector<Axes> score = StateVector<Axes>::Zero();
        StateMatrix<Axes> information = StateMatrix<Axes>::Zero();
        if (k + 1 < arc.size()) {
            score = epochs_[k + 1].score;
            information = epochs_[k + 1].information;
            transpose_transition(k, score);
            kernel::carry_information_back<Axes>(steps_[step_of_[k]], information.data());
        }
        if (epoch.measured) {
            const Positions seen = information.lazyProduct(epoch.gain);
            epoch.own_score = epoch.weighted_residual - epoch.gain.transpose() * score;
            epoch.own_precision =
                epoch.innovation_information + epoch.gain.transpose().lazyProduct(seen);
            score.template head<Axes>() += epoch.own_score;
            score.template tail<Axes>() += epoch.own_score;
            // (I - K H)' N (I - K H) + H' S^-1 H, where H = [I 0 0 I].
            information.template leftCols<Axes>() -= seen;
            information.template rightCols<Axes>() -= seen;
            const auto rows = epoch.gain.transpose().lazyProduct(information).eval();
            information.template topRows<Axes>() -= rows;
            information.template bottomRows<Axes>() -= rows;
            for (const int row : {0, 3 * Axes})
                for (const int column : {0, 3 * Axes})
                    information.template block<Axes, Axes>(row, column) +=
                        epoch.innovation_information;
        }
        epoch.score = score;
        epoch.information = 0.5 * (information + information.transpose());
    }
}

template <int Axes>
ScoreTest<Axes> ArcDiagnosis<Axes>::outlier(std::size_t k) const {
    return {.score = epochs_[k].own_score, .precision = epochs_[k].own_precision};
}

template <int Axes>
ScoreTest<Axes> ArcDiagnosis<Axes>::left_out(std::size_t k,
                                             const PositionMeasurement<Axes>& measurement) const {
    const StateEstimate<Axes> state = smoothed(k);
    const Innovation<Axes> seen = KalmanFilter<Axes>(model_).innovation(state, measurement);
    const PositionMatrix<Axes> precision =
        seen.covariance.llt().solve(PositionMatrix<Axes>::Identity());
    return {.score = precision * seen.residual, .precision = precision};
}

template <int Axes>
ScoreTest<Axes> ArcDiagnosis<Axes>::step(std::size_t k) const {
    return {.score = epochs_[k].score.template head<Axes>(),
            .precision = epochs_[k].information.template topLeftCorner<Axes, Axes>()};
}

template <int Axes>
ScoreTest<Axes> ArcDiagnosis<Axes>::bridged_step(std::size_t k) const {
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
ScoreTest<Axes> ArcDiagnosis<Axes>::ramp(std::size_t k) const {
    return {.score = epochs_[k].score.template segment<Axes>(Axes),
            .precision = epochs_[k].information.template block<Axes, Axes>(Axes, Axes)};
}

template <int Axes>
ScoreTest<Axes> ArcDiagnosis<Axes>::manoeuvre(std::size_t k) const {
    constexpr int acceleration = 2 * Axes;
    return {
        .score = epochs_[k].score.template segment<Axes>(acceleration),
        .precision = epochs_[k].information.template block<Axes, Axes>(acceleration, acceleration)};
}

template <int Axes>
std::optional<ScoreTest<1>> ArcDiagnosis<Axes>::time_shift(std::size_t k) const {
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
ScoreTest<Axes> ArcDiagnosis<Axes>::burst(std::size_t k, std::size_t length) const {
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
SetTest ArcDiagnosis<Axes>::own_errors(std::size_t first, std::size_t last) const {
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
            kernel::carry_information_back<Axes>(steps_[step_of_[k]], later.data());
            carried = -later * epochs_[k].gain;
        }
        carried.template topRows<Axes>() += epochs_[k].own_precision;
        carried.template bottomRows<Axes>() += epochs_[k].own_precision;
        Eigen::Index row = l;
        for (std::size_t j = k; row > 0 && j-- > first;) {
            transpose_transition(j, carried);
            if (!epochs_[j].measured) continue;
            --row;
            const PositionMatrix<Axes> between = -epochs_[j].gain.transpose() * carried;
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
StateEstimate<Axes> ArcDiagnosis<Axes>::smoothed(std::size_t k) const {
    const Epoch& epoch = epochs_[k];
    const StateMatrix<Axes>& p = epoch.predicted.covariance;
    StateEstimate<Axes> state;
    state.mean = epoch.predicted.mean + p * epoch.score;
    state.covariance = p - p * epoch.information * p;
    return state;
}

template <int Axes>
MotionEstimate<Axes> ArcDiagnosis<Axes>::motion(std::size_t k) const {
    const Epoch& epoch = epochs_[k];
    const StateMatrix<Axes>& p = epoch.predicted.covariance;
    // The needed rows of p + p (-N) p. Lazy products, because these matrices are too small for the
    // set-up of general ones.
    using Rows = Eigen::Matrix<double, Axes, state_size<Axes>>;
    const auto mean = [&](int at) -> PositionVector<Axes> {
        return epoch.predicted.mean.template segment<Axes>(at) +
               Rows(p.template middleRows<Axes>(at)) * epoch.score;
    };
    const auto covariance = [&](int at) -> PositionMatrix<Axes> {
        const Rows rows = p.template middleRows<Axes>(at);
        const Rows told = rows.lazyProduct(epoch.information);
        return p.template block<Axes, Axes>(at, at) - told.lazyProduct(rows.transpose());
    };
    return {.velocity = mean(Axes),
            .acceleration = mean(2 * Axes),
            .velocity_covariance = covariance(Axes),
            .acceleration_covariance = covariance(2 * Axes)};
}

template class ArcDiagnosis<1>;
template class ArcDiagnosis<2>;

}  // namespace runcert
