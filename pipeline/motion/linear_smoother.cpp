#include "motion/linear_smoother.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace runcert {

template <int Axes>
LinearSmoother<Axes>::LinearSmoother(std::span<const ArcEpoch<Axes>> arc,
                                     const EstimationModel& model)
    : epochs_(arc.size()) {
    KalmanFilter<Axes> filter(model);
    filter_along<Axes>(filter, arc,
                       [&](std::size_t k, const StateEstimate<Axes>& predicted,
                           const Innovation<Axes>* seen, const StateEstimate<Axes>&) {
                           assert(seen);
                           if (!seen) return;  // GCC 12 takes it for possible, and warns
                           Epoch& epoch = epochs_[k];
                           const auto gain = filter.gain(predicted, *seen);
                           const PositionMatrix<Axes> weight =
                               seen->covariance.llt().solve(PositionMatrix<Axes>::Identity());
                           for (std::size_t a = 0; a < axes; ++a) {
                               const auto row = static_cast<Eigen::Index>(a);
                               for (std::size_t i = 0; i < size; ++i) {
                                   const auto column = static_cast<Eigen::Index>(i);
                                   epoch.gain[a][i] = gain(column, row);
                                   epoch.position[a][i] = predicted.covariance(row, column);
                               }
                               for (std::size_t b = 0; b < axes; ++b)
                                   epoch.weight[a][b] = weight(row, static_cast<Eigen::Index>(b));
                           }
                       });
    std::int64_t last_ns = -1;
    for (std::size_t k = 0; k + 1 < arc.size(); ++k) {
        const StepKind kind = step_kind(arc[k], arc[k + 1]);
        if (kind.length_ns != last_ns) steps_.push_back(filter.numbers_of(kind));
        last_ns = kind.length_ns;
        epochs_[k].step = steps_.size() - 1;
    }
}

/// One smoothing pass over several recordings.
template <int Axes>
template <int Lanes>
struct LinearSmoother<Axes>::Pass {
    using Lane = runcert::Lane<Lanes>;
    using Positions = LanePositions<Axes, Lanes>;
    using State = std::array<Lane, size>;

    const LinearSmoother& smoother;
    std::vector<Positions> positions;  ///< predicted, then smoothed
    std::vector<Positions> weighted;   ///< weighted innovations

    template <std::size_t Count>
    static void set_zero(std::array<Lane, Count>& numbers) {
        for (Lane& one : numbers)
            one.setZero();
    }

    void forward(std::span<const Positions> measured) {
        State state;
        set_zero(state);
        for (std::size_t a = 0; a < axes; ++a)
            state[a] = measured[0][a];
        for (std::size_t k = 0; k < measured.size(); ++k) {
            const Epoch& epoch = smoother.epochs_[k];
            if (k > 0)
                kernel::carry<Axes>(smoother.steps_[smoother.epochs_[k - 1].step], state.data());
            Positions residual;
            for (std::size_t a = 0; a < axes; ++a)
                residual[a] = measured[k][a] - state[a] - state[3 * axes + a];
            // Whole vectors, so that no load waits for a recent store.
            Positions weight;
            set_zero(weight);
            for (std::size_t a = 0; a < axes; ++a) {
                positions[k][a] = state[a];
                for (std::size_t b = 0; b < axes; ++b)
                    weight[a] += epoch.weight[a][b] * residual[b];
            }
            weighted[k] = weight;
            for (std::size_t i = 0; i < size; ++i)
                for (std::size_t a = 0; a < axes; ++a)
                    state[i] += epoch.gain[a][i] * residual[a];
        }
    }

    void backward() {
        State score;
        set_zero(score);
        for (std::size_t k = positions.size(); k-- > 0;) {
            const Epoch& epoch = smoother.epochs_[k];
            if (k + 1 < positions.size())
                kernel::carry_back<Axes>(smoother.steps_[epoch.step], score.data());
            Positions own = weighted[k];
            for (std::size_t a = 0; a < axes; ++a)
                for (std::size_t i = 0; i < size; ++i)
                    own[a] -= epoch.gain[a][i] * score[i];
            for (std::size_t a = 0; a < axes; ++a) {
                score[a] += own[a];
                score[3 * axes + a] += own[a];
            }
            Positions smoothed = positions[k];
            for (std::size_t a = 0; a < axes; ++a)
                for (std::size_t i = 0; i < size; ++i)
                    smoothed[a] += epoch.position[a][i] * score[i];
            positions[k] = smoothed;
        }
    }
};

template <int Axes>
template <int Lanes>
std::vector<LanePositions<Axes, Lanes>> LinearSmoother<Axes>::smooth_lanes(
    std::span<const LanePositions<Axes, Lanes>> measured) const {
    assert(measured.size() == epochs_.size());
    using Positions = std::vector<LanePositions<Axes, Lanes>>;
    Pass<Lanes> pass{.smoother = *this,
                     .positions = Positions(measured.size()),
                     .weighted = Positions(measured.size())};
    pass.forward(measured);
    pass.backward();
    return std::move(pass.positions);
}

template <int Axes>
std::vector<PositionVector<Axes>> LinearSmoother<Axes>::operator()(
    std::span<const PositionVector<Axes>> measured) const {
    std::vector<LanePositions<Axes, 1>> lane(measured.size());
    for (std::size_t k = 0; k < measured.size(); ++k)
        for (std::size_t a = 0; a < axes; ++a)
            lane[k][a][0] = measured[k](static_cast<Eigen::Index>(a));
    const auto smoothed = smooth_lanes<1>(lane);
    std::vector<PositionVector<Axes>> positions(measured.size());
    for (std::size_t k = 0; k < measured.size(); ++k)
        for (std::size_t a = 0; a < axes; ++a)
            positions[k](static_cast<Eigen::Index>(a)) = smoothed[k][a][0];
    return positions;
}

template class LinearSmoother<1>;
template class LinearSmoother<2>;
template std::vector<LanePositions<1, 4>> LinearSmoother<1>::smooth_lanes<4>(
    std::span<const LanePositions<1, 4>>) const;
template std::vector<LanePositions<2, 4>> LinearSmoother<2>::smooth_lanes<4>(
    std::span<const LanePositions<2, 4>>) const;

}  // namespace runcert
