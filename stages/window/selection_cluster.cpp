#include "stages/window/selection_cluster.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "motion/likelihood.h"

namespace runcert {
namespace {

template <int Axes>
MeasuredStretch<Axes> stretch_of(const WindowCluster<Axes>& cluster) {
    constexpr double flank_s = 5.0;
    const auto& epochs = cluster.arc->epochs;
    std::size_t last = 0;
    for (const EpochPair& window : cluster.windows)
        last = std::max(last, window.last);
    std::size_t from = cluster.windows.front().first;
    const double begin_s = epochs[from].time_s - flank_s;
    const double end_s = epochs[last].time_s + flank_s;
    while (from > 0 && epochs[from - 1].time_s >= begin_s)
        --from;
    while (!epochs[from].measurement)
        ++from;
    while (last + 1 < epochs.size() && epochs[last + 1].time_s <= end_s)
        ++last;
    MeasuredStretch<Axes> stretch;
    std::vector<std::size_t> index(last + 1 - from, 0);
    double jerk_factor = 0.0;  // the largest since the last measurement
    for (std::size_t k = from; k <= last; ++k) {
        index[k - from] = stretch.epochs.size();
        jerk_factor = std::max(jerk_factor, epochs[k].jerk_factor);
        if (!epochs[k].measurement) continue;
        stretch.epochs.push_back(epochs[k]);
        stretch.epochs.back().jerk_factor = jerk_factor;
        jerk_factor = 0.0;
    }
    stretch.allowances_m_s = cluster.allowances_m_s;
    for (const EpochPair& window : cluster.windows) {
        stretch.windows.push_back({index[window.first - from], index[window.last - from]});
        stretch.durations_s.push_back(epochs[window.last].time_s - epochs[window.first].time_s);
    }
    stretch.allowances_m_s.resize(stretch.windows.size(), 0.0);
    return stretch;
}

/// The model with the most likely jerk density for this stretch alone.
template <int Axes>
EstimationModel local_model(const MeasuredStretch<Axes>& stretch, const EstimationModel& model) {
    const std::span<const ArcEpoch<Axes>> arc(stretch.epochs);
    std::vector<EstimationModel> models;
    for (double logarithm = std::log(3e-4); logarithm <= std::log(10.0); logarithm += 0.5) {
        models.push_back(model);
        models.back().motion.jerk_density *= std::exp(logarithm);
    }
    const auto likelihoods = results_of(std::ssize(models), threads_allowed(), [&](std::int64_t i) {
        return innovation_sums<Axes>({&arc, 1}, models[static_cast<std::size_t>(i)])
            .log_likelihood();
    });
    const auto best = std::ranges::max_element(likelihoods) - likelihoods.begin();
    return models[static_cast<std::size_t>(best)];
}

/// The drawn tracks, each with the same track added.
template <int Axes, class Lanes>
Lanes sum(const std::vector<PositionVector<Axes>>& same, const Lanes& drawn) {
    Lanes result(drawn.size());
    for (std::size_t k = 0; k < drawn.size(); ++k)
        for (std::size_t a = 0; a < drawn[k].size(); ++a)
            result[k][a] = same[k](static_cast<Eigen::Index>(a)) + drawn[k][a];
    return result;
}

template <class Lanes>
Lanes sum(const Lanes& one, const Lanes& other) {
    Lanes result(one.size());
    for (std::size_t k = 0; k < one.size(); ++k)
        for (std::size_t a = 0; a < one[k].size(); ++a)
            result[k][a] = one[k][a] + other[k][a];
    return result;
}

}  // namespace

/// The speeds of a cluster's windows along tracks.
template <int Axes>
class SelectionCluster<Axes>::Speeds {
  public:
    Speeds(const SelectionCluster& cluster, const Lanes& track)
        : stretch_(cluster.stretch_), track_(track) {
        if (!cluster.by_path_) return;
        path_m_.resize(track.size(), Lane::Zero());
        for (std::size_t k = 1; k < track.size(); ++k)
            path_m_[k] = path_m_[k - 1] + distance(k - 1, k);
    }

    Lane operator[](std::size_t w) const {
        const auto [first, last] = stretch_.windows[w];
        const double duration_s = stretch_.durations_s[w];
        if (path_m_.empty()) return distance(first, last) / duration_s;
        return (path_m_[last] - path_m_[first]) / duration_s;
    }

    /// For each draw, the window of the highest assured speed, the first if equal, and that speed.
    struct Fastest {
        Lane assured_m_s;
        std::array<std::size_t, selection_lanes> window{};
    };
    Fastest fastest() const {
        Fastest fastest;
        fastest.assured_m_s.setConstant(-std::numeric_limits<double>::infinity());
        for (std::size_t w = 0; w < stretch_.windows.size(); ++w) {
            const Lane assured = (*this)[w] - stretch_.allowances_m_s[w];
            if (!(assured > fastest.assured_m_s).any()) continue;
            for (std::size_t l = 0; l < selection_lanes; ++l) {
                const auto lane = static_cast<Eigen::Index>(l);
                if (!(assured[lane] > fastest.assured_m_s[lane])) continue;
                fastest.assured_m_s[lane] = assured[lane];
                fastest.window[l] = w;
            }
        }
        return fastest;
    }

  private:
    Lane distance(std::size_t from, std::size_t to) const {
        Lane square = Lane::Zero();
        for (std::size_t a = 0; a < axes; ++a)
            square += (track_[to][a] - track_[from][a]).square();
        return square.sqrt();
    }

    const MeasuredStretch<Axes>& stretch_;
    const Lanes& track_;
    std::vector<Lane> path_m_;
};

/// The time-correlated error of several draws, epoch by epoch: stationary Gauss-Markov processes,
/// or the fitted one.
template <int Axes>
class SelectionCluster<Axes>::SlowError {
  public:
    SlowError(const SelectionCluster& cluster,
              const std::optional<std::array<double, selection_lanes>>& tau_s)
        : epochs_(cluster.stretch_.epochs) {
        const GaussMarkovError& fitted = cluster.fitted_error_;
        for (std::size_t l = 0; l < selection_lanes; ++l) {
            const GaussMarkovError error =
                tau_s ? GaussMarkovError::steady(
                            std::max(cluster.bound_m_,
                                     fitted.process_density * std::sqrt(0.5 * (*tau_s)[l])),
                            (*tau_s)[l])
                      : fitted;
            tau_s_[static_cast<Eigen::Index>(l)] = error.tau_s;
            steady_m_[static_cast<Eigen::Index>(l)] =
                error.process_density * std::sqrt(0.5 * error.tau_s);
            noise_m_[static_cast<Eigen::Index>(l)] = error.initial_sigma_m;
        }
        decay_.setZero();
    }

    /// Propagates to an epoch from the previous one.
    void carry_to(std::size_t k) {
        if (k == 0) return;
        const double dt_s = epochs_[k].time_s - epochs_[k - 1].time_s;
        if (dt_s == dt_s_) return;
        dt_s_ = dt_s;
        decay_ = (-dt_s / tau_s_).exp();
        noise_m_ = steady_m_ * (1.0 - decay_.square()).sqrt();
    }

    double decay(std::size_t l) const { return decay_[static_cast<Eigen::Index>(l)]; }
    double noise_m(std::size_t l) const { return noise_m_[static_cast<Eigen::Index>(l)]; }

  private:
    const std::vector<ArcEpoch<Axes>>& epochs_;
    Lane tau_s_;
    Lane steady_m_;
    Lane decay_;
    Lane noise_m_;
    double dt_s_ = -1.0;
};

namespace {

/// The noise model for drawing, with the time-correlated error's size along the windows.
EstimationModel drawn_model(const SelectionModels& models) {
    EstimationModel model = models.estimated;
    model.error.process_density *= models.along;
    model.error.initial_sigma_m *= models.along;
    return model;
}

}  // namespace

template <int Axes>
SelectionCluster<Axes>::SelectionCluster(const WindowCluster<Axes>& windows,
                                         const SelectionModels& models)
    : stretch_(stretch_of(windows)),
      chosen_(windows.chosen),
      by_path_(models.by_path),
      fitted_error_(drawn_model(models).error),
      bound_m_(models.bound_m),
      estimator_(stretch_.epochs, models.estimated),
      local_(stretch_.epochs, local_model(stretch_, drawn_model(models))) {
    Positions measured;
    for (const ArcEpoch<Axes>& epoch : stretch_.epochs) {
        measured.push_back(epoch.measurement->position);
        const PositionMatrix<Axes> factor = epoch.measurement->covariance.llt().matrixL();
        white_factors_.push_back(models.estimated.measurement_scale * factor);
    }
    motion_ = smoothed(local_.positions_of(measured));
    re_motion_ = smoothed(local_.positions_of(motion_.motion));
}

template <int Axes>
typename SelectionCluster<Axes>::template Smoothed<typename SelectionCluster<Axes>::Positions>
SelectionCluster<Axes>::smoothed(const Positions& motion) const {
    return {motion, estimator_.positions_of(motion)};
}

/// The sum of time-correlated error and white noise.
template <int Axes>
typename SelectionCluster<Axes>::Lanes SelectionCluster<Axes>::errors(
    std::array<const double*, selection_lanes> numbers,
    const std::optional<std::array<double, selection_lanes>>& tau_s) const {
    Lanes errors(stretch_.epochs.size());
    SlowError slow_error(*this, tau_s);
    std::array<std::array<double, axes>, selection_lanes> slow{};
    for (std::size_t k = 0; k < errors.size(); ++k) {
        slow_error.carry_to(k);
        for (std::size_t l = 0; l < selection_lanes; ++l) {
            const double*& number = numbers[l];
            for (double& one : slow[l])
                one = slow_error.decay(l) * one + slow_error.noise_m(l) * *number++;
            for (std::size_t a = 0; a < axes; ++a) {
                double white = 0.0;
                for (std::size_t b = 0; b <= a; ++b)
                    white += white_factors_[k](static_cast<Eigen::Index>(a),
                                               static_cast<Eigen::Index>(b)) *
                             number[b];
                errors[k][a][static_cast<Eigen::Index>(l)] = slow[l][a] + white;
            }
            number += axes;
        }
    }
    return errors;
}

template <int Axes>
std::array<FastestWindow, selection_lanes> SelectionCluster<Axes>::search(
    const Smoothed<Lanes>& drawn) const {
    const Speeds stated(*this, drawn.estimated);
    const auto fastest = stated.fastest();
    const Speeds truth(*this, drawn.motion);
    std::array<FastestWindow, selection_lanes> result;
    const Lane chosen = chosen_errors(drawn);
    for (std::size_t l = 0; l < selection_lanes; ++l) {
        const std::size_t window = fastest.window[l];
        const auto lane = static_cast<Eigen::Index>(l);
        result[l] = {.searched_m_s = fastest.assured_m_s[lane],
                     .error_m_s = stated[window][lane] - truth[window][lane],
                     .chosen_error_m_s = chosen[lane]};
    }
    return result;
}

/// The errors of the speed stated for the chosen window. Zero if it is not in this cluster.
template <int Axes>
typename SelectionCluster<Axes>::Lane SelectionCluster<Axes>::chosen_errors(
    const Smoothed<Lanes>& drawn) const {
    if (!chosen_) return Lane::Zero();
    return Speeds(*this, drawn.estimated)[*chosen_] - Speeds(*this, drawn.motion)[*chosen_];
}

template <int Axes>
std::array<ClusterDraw, selection_lanes> SelectionCluster<Axes>::draw(
    const std::array<const double*, selection_lanes>& numbers,
    const std::optional<std::array<double, selection_lanes>>& tau_s) const {
    constexpr int count = static_cast<int>(selection_lanes);
    std::array<const double*, selection_lanes> more = numbers;
    for (const double*& one : more)
        one += normals() / 2;
    const Lanes noise = estimator_.template positions_of<count>(errors(numbers, tau_s));
    const Lanes drift = local_.template positions_of<count>(errors(more, tau_s));
    Lanes none(noise.size());
    for (auto& at : none)
        for (Lane& axis : at)
            axis.setZero();
    const Smoothed<Lanes> still{sum<Axes>(motion_.motion, none),
                                sum<Axes>(motion_.estimated, none)};
    const Smoothed<Lanes> once{still.motion, sum<Axes>(motion_.estimated, noise)};
    const Smoothed<Lanes> moved{
        sum<Axes>(re_motion_.motion, drift),
        sum<Axes>(re_motion_.estimated, estimator_.template positions_of<count>(drift))};
    const Smoothed<Lanes> again{moved.motion, sum(moved.estimated, noise)};
    const auto found_once = search(once);
    const auto found_again = search(again);
    const Lane chosen_once = chosen_errors(still);
    const Lane chosen_again = chosen_errors(moved);
    const Speeds true_speeds(*this, moved.motion);
    const auto fastest_true = true_speeds.fastest();
    std::array<ClusterDraw, selection_lanes> draws;
    for (std::size_t l = 0; l < selection_lanes; ++l) {
        const auto lane = static_cast<Eigen::Index>(l);
        draws[l] = {.once = found_once[l],
                    .again = found_again[l],
                    .chosen_without_noise_once_m_s = chosen_once[lane],
                    .chosen_without_noise_again_m_s = chosen_again[lane],
                    .fastest_true_m_s = std::max(0.0, true_speeds[fastest_true.window[l]][lane])};
    }
    return draws;
}

template class SelectionCluster<1>;
template class SelectionCluster<2>;

}  // namespace runcert
