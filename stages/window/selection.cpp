#include "stages/window/selection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.h"
#include "core/statistics.h"
#include "motion/chain.h"
#include "motion/likelihood.h"
#include "stages/window/best_window_sums.h"
#include "stages/window/instants.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

/// The epochs of a cluster, with some seconds before and after.
template <int Axes>
struct RivalStretch {
    std::span<const ArcEpoch<Axes>> epochs;
    std::size_t from = 0;  ///< index of the first one in the arc
};

template <int Axes>
RivalStretch<Axes> stretch_of(const WindowCluster<Axes>& cluster) {
    constexpr double flank_s = 5.0;
    std::size_t last = 0;
    for (const EpochPair& window : cluster.windows)
        last = std::max(last, window.last);
    const EpochPair reach =
        reach_around(*cluster.arc, {cluster.windows.front().first, last}, flank_s);
    return {
        .epochs = std::span(cluster.arc->epochs).subspan(reach.first, reach.last + 1 - reach.first),
        .from = reach.first};
}

/// The noise model for drawing, with the time-correlated error's size along the windows.
EstimationModel drawn_model(const SelectionModels& models) {
    EstimationModel model = models.estimated;
    model.error.process_density *= models.along;
    model.error.initial_sigma_m *= models.along;
    return model;
}

/// The model with the most likely jerk density for this stretch alone.
template <int Axes>
EstimationModel local_model(std::span<const ArcEpoch<Axes>> stretch, const EstimationModel& model) {
    std::vector<EstimationModel> models;
    for (double logarithm = std::log(3e-4); logarithm <= std::log(10.0); logarithm += 0.5) {
        models.push_back(model);
        models.back().motion.jerk_density *= std::exp(logarithm);
    }
    const auto sums = innovation_sums_of<Axes>({&stretch, 1}, models);
    const auto best = std::ranges::max_element(
        sums, {}, [](const InnovationSums& one) { return one.log_likelihood(); });
    return models[static_cast<std::size_t>(best - sums.begin())];
}

/// Weights of the measured positions in some sums: a row for each sum, and a column for each axis
/// of each epoch.
using Weights = Eigen::MatrixXd;

/// W R W' of errors with R = L L', given W L. The lower triangle alone.
Eigen::MatrixXd covariance(const Weights& on_unit_errors) {
    const auto sums = on_unit_errors.rows();
    Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(sums, sums);
    covariance.selfadjointView<Eigen::Lower>().rankUpdate(on_unit_errors);
    return covariance;
}

/// The Cholesky factor of the sum of that covariance and another.
Eigen::MatrixXd factor(const Eigen::MatrixXd& other, const Weights& on_unit_errors) {
    Eigen::MatrixXd sum = other + covariance(on_unit_errors);
    // Windows that nearly coincide make it singular but for rounding.
    constexpr double rounding = 1e-9;
    sum.diagonal().array() += rounding * sum.diagonal().maxCoeff();
    return sum.llt().matrixL();
}

/// The weights on the unit errors behind white noise.
template <int Axes>
Weights on_white(std::span<const ArcEpoch<Axes>> epochs, Weights weights, double scale) {
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        if (!epochs[k].measurement) continue;
        const PositionMatrix<Axes> factor = epochs[k].measurement->covariance.llt().matrixL();
        auto here = weights.middleCols<Axes>(static_cast<Eigen::Index>(k) * Axes);
        here = (scale * here * factor).eval();
    }
    return weights;
}

/// The weights on the unit errors that drive a Gauss-Markov error.
template <int Axes>
Weights on_slow(std::span<const ArcEpoch<Axes>> epochs, Weights weights,
                const GaussMarkovError& error) {
    const double steady_m = error.process_density * std::sqrt(0.5 * error.tau_s);
    Eigen::Matrix<double, Eigen::Dynamic, Axes> later =
        Eigen::Matrix<double, Eigen::Dynamic, Axes>::Zero(weights.rows(), Axes);
    for (std::size_t k = epochs.size(); k-- > 0;) {
        const double decay =
            k > 0 ? std::exp(-(epochs[k].time_s - epochs[k - 1].time_s) / error.tau_s) : 0.0;
        auto here = weights.middleCols<Axes>(static_cast<Eigen::Index>(k) * Axes);
        later += here;
        here = (k > 0 ? steady_m * std::sqrt(1.0 - decay * decay) : error.initial_sigma_m) * later;
        later *= decay;
    }
    return weights;
}

/// What one cluster errs by, in m/s: in the speeds stated for its windows, and in its motion as
/// estimated. As factors of the two covariances, or drawn, with a column for each draw.
struct RivalErrors {
    Eigen::MatrixXd stated;
    Eigen::MatrixXd motion;
};

/// The windows of one cluster, and the weights of the measured positions in each component of their
/// velocities: the stated ones, and those of the motion estimated from this stretch alone.
template <int Axes>
class Rivals {
  public:
    /// Of each `every` consecutive windows the one of the highest assured speed, and the chosen
    /// one; of fewer where the windows are long.
    Rivals(const WindowCluster<Axes>& cluster, const SelectionModels& models, std::size_t every)
        : stretch_(stretch_of(cluster)), components_(models.by_path ? 1 : Axes) {
        const EstimationModel drawn = drawn_model(models);
        const double scale = drawn.measurement_scale;
        const Chain<Axes> estimator(stretch_.epochs, models.estimated);
        const Chain<Axes> local(stretch_.epochs, local_model(stretch_.epochs, drawn));
        follow(local);
        // The covariance costs the square of the rivals times the columns.
        constexpr double affordable = 2e8;
        const auto columns = std::ssize(stretch_.epochs) * Axes;
        const auto most = static_cast<std::size_t>(
            std::sqrt(affordable / static_cast<double>(columns)) / components_);
        every = std::max(every, cluster.windows.size() / std::max<std::size_t>(most, 10));
        std::vector<EpochPair> windows;
        const auto allowance = [&](std::size_t w) {
            return cluster.allowances_m_s.empty() ? 0.0 : cluster.allowances_m_s[w];
        };
        for (std::size_t first = 0; first < cluster.windows.size(); first += every) {
            const std::size_t end = std::min(first + every, cluster.windows.size());
            std::size_t kept = first;
            double highest = -std::numeric_limits<double>::infinity();
            for (std::size_t w = first; w < end && kept != cluster.chosen; ++w) {
                const double assured =
                    velocity_in(window(cluster, w), models.by_path).norm() - allowance(w);
                if (w != cluster.chosen && !(assured > highest)) continue;
                kept = w;
                highest = assured;
            }
            if (kept == cluster.chosen) chosen_ = allowances_m_s_.size();
            allowances_m_s_.push_back(allowance(kept));
            windows.push_back(window(cluster, kept));
        }
        velocities_.resize(std::ssize(windows) * components_);
        stated_.resize(velocities_.size(), columns);
        motion_.resize(velocities_.size(), columns);
        for (std::size_t w = 0; w < windows.size(); ++w)
            set(w, estimator, local, windows[w], models.by_path);
        white_ = {.stated = covariance(on_white<Axes>(stretch_.epochs, stated_, scale)),
                  .motion = covariance(on_white<Axes>(stretch_.epochs, motion_, scale))};
    }

    /// The factors for white noise and this error.
    RivalErrors factors(const GaussMarkovError& error) const {
        return {.stated = factor(white_.stated, on_slow<Axes>(stretch_.epochs, stated_, error)),
                .motion = factor(white_.motion, on_slow<Axes>(stretch_.epochs, motion_, error))};
    }

    std::size_t size() const { return allowances_m_s_.size(); }
    const std::optional<std::size_t>& chosen() const { return chosen_; }
    double allowance_m_s(std::size_t w) const { return allowances_m_s_[w]; }

    /// The velocities of all windows as estimated from this stretch alone, one below another.
    const Eigen::VectorXd& velocities() const { return velocities_; }
    auto velocity(const Eigen::VectorXd& all, std::size_t w) const {
        return all.segment(static_cast<Eigen::Index>(w) * components_, components_);
    }

  private:
    EpochPair window(const WindowCluster<Axes>& cluster, std::size_t w) const {
        return {cluster.windows[w].first - stretch_.from, cluster.windows[w].last - stretch_.from};
    }
    double duration_s(EpochPair window) const {
        return stretch_.epochs[window.last].time_s - stretch_.epochs[window.first].time_s;
    }

    /// Sets the positions of the motion, and the path to each of them.
    void follow(const Chain<Axes>& local) {
        double path_m = 0.0;
        for (std::size_t k = 0; k < local.size(); ++k) {
            const SpeedVector<Axes> place = local.mean(k).template head<speed_axes<Axes>>();
            if (k > 0) path_m += (place - places_m_.back()).norm();
            places_m_.push_back(place);
            sums_.path_m.push_back(path_m);
        }
    }

    Eigen::VectorXd velocity_in(EpochPair window, bool by_path) const {
        if (by_path)
            return Eigen::VectorXd::Constant(
                1, sums_.speed_m_s(window, duration_s(window), SpeedDefinition::path_length));
        Eigen::VectorXd velocity(components_);
        for (int axis = 0; axis < components_; ++axis)
            velocity(axis) =
                (places_m_[window.last](axis) - places_m_[window.first](axis)) / duration_s(window);
        return velocity;
    }

    void set(std::size_t w, const Chain<Axes>& estimator, const Chain<Axes>& local,
             EpochPair window, bool by_path) {
        const auto row = static_cast<Eigen::Index>(w) * components_;
        velocities_.segment(row, components_) = velocity_in(window, by_path);
        for (int axis = 0; axis < components_; ++axis) {
            Gradients<Axes> gradients(window.last - window.first + 1, StateVector<Axes>::Zero());
            if (by_path) {
                gradients = speed_gradients(local, window, duration_s(window),
                                            {.definition = SpeedDefinition::path_length});
            } else {
                gradients.front()(axis) = -1.0 / duration_s(window);
                gradients.back()(axis) = 1.0 / duration_s(window);
            }
            const auto set_row = [&](const Chain<Axes>& chain, Weights& weights) {
                const auto of_epochs = chain.weights(window.first, gradients);
                for (std::size_t k = 0; k < of_epochs.size(); ++k)
                    weights.row(row + axis)
                        .template segment<Axes>(static_cast<Eigen::Index>(k) * Axes) =
                        of_epochs[k].transpose();
            };
            set_row(estimator, stated_);
            set_row(local, motion_);
        }
    }

    RivalStretch<Axes> stretch_;
    int components_;
    std::optional<std::size_t> chosen_;
    std::vector<SpeedVector<Axes>> places_m_;
    SpeedSums sums_;
    std::vector<double> allowances_m_s_;
    Eigen::VectorXd velocities_;
    Weights stated_;
    Weights motion_;
    RivalErrors white_;  ///< covariances of white noise alone
};

/// The window of the highest assured speed over all clusters.
struct Fastest {
    double assured_m_s = -std::numeric_limits<double>::infinity();
    double speed_m_s = 0.0;
    double error_m_s = 0.0;
};

/// One draw. The error of the window chosen in the recording has a mean of zero over the draws, so
/// that subtracting it makes their mean converge with fewer of them.
struct Sample {
    Fastest once;
    Fastest again;
    Fastest truly;
    double chosen_once_m_s = 0.0;
    double chosen_again_m_s = 0.0;

    double calibrated_m_s() const {
        return 2.0 * (once.error_m_s - chosen_once_m_s) - (again.error_m_s - chosen_again_m_s);
    }
};

/// Adds a cluster to draw `i`: the speeds stated with errors on the motion as estimated, and on the
/// one estimated from a drawn recording.
template <int Axes>
void add_to(const Rivals<Axes>& rivals, const RivalErrors& drawn, Eigen::Index i, Sample& sample) {
    const Eigen::VectorXd errors = drawn.stated.col(i);
    const Eigen::VectorXd& motion = rivals.velocities();
    const Eigen::VectorXd moved = motion + drawn.motion.col(i);
    const auto search = [&](const Eigen::VectorXd& truth, const Eigen::VectorXd& stated,
                            Fastest& fastest) {
        for (std::size_t w = 0; w < rivals.size(); ++w) {
            const double speed = rivals.velocity(stated, w).norm();
            const double assured = speed - rivals.allowance_m_s(w);
            if (!(assured > fastest.assured_m_s)) continue;
            fastest = {.assured_m_s = assured,
                       .speed_m_s = speed,
                       .error_m_s = speed - rivals.velocity(truth, w).norm()};
        }
    };
    search(motion, motion + errors, sample.once);
    search(moved, moved + errors, sample.again);
    search(moved, moved, sample.truly);
    if (!rivals.chosen()) return;
    const auto along = [&](const Eigen::VectorXd& truth) {
        return rivals.velocity(truth, *rivals.chosen())
            .normalized()
            .dot(rivals.velocity(errors, *rivals.chosen()));
    };
    sample.chosen_once_m_s = along(motion);
    sample.chosen_again_m_s = along(moved);
}

/// The bias estimated from the draws.
struct DrawnBias {
    double bias_m_s = 0.0;
    double uncertainty_m_s = 0.0;
    double chosen_sd_m_s = 0.0;
    double best_mean_m_s = 0.0;
    double best_sd_m_s = 0.0;
};

/// The draws are shared out evenly among the errors, in groups.
template <int Axes>
DrawnBias draw_bias(const std::vector<Rivals<Axes>>& clusters,
                    const std::vector<GaussMarkovError>& errors, std::int64_t groups,
                    std::int64_t samples, std::int64_t seed) {
    std::vector<std::vector<RivalErrors>> factors;
    for (const GaussMarkovError& error : errors) {
        auto& of_error = factors.emplace_back();
        for (const Rivals<Axes>& rivals : clusters)
            of_error.push_back(rivals.factors(error));
    }
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    const auto draws = [&](const Eigen::MatrixXd& factor, std::int64_t count) -> Eigen::MatrixXd {
        const std::vector<double> numbers =
            random.normals(static_cast<std::size_t>(factor.rows() * count));
        return factor.triangularView<Eigen::Lower>() *
               Eigen::Map<const Eigen::MatrixXd>(numbers.data(), factor.rows(), count);
    };
    std::vector<double> stated, calibrated, best_true;
    for (std::int64_t group = 0; group < groups; ++group) {
        const auto share = (samples - std::ssize(stated)) / (groups - group);
        const auto& of_error = factors[static_cast<std::size_t>(group) % factors.size()];
        std::vector<Sample> drawn(static_cast<std::size_t>(share));
        for (std::size_t c = 0; c < clusters.size(); ++c) {
            const RivalErrors errors_drawn{.stated = draws(of_error[c].stated, share),
                                           .motion = draws(of_error[c].motion, share)};
            for (std::int64_t i = 0; i < share; ++i)
                add_to(clusters[c], errors_drawn, i, drawn[static_cast<std::size_t>(i)]);
        }
        for (const Sample& sample : drawn) {
            stated.push_back(sample.once.error_m_s);
            calibrated.push_back(sample.calibrated_m_s());
            best_true.push_back(sample.truly.speed_m_s);
        }
    }
    return {
        .bias_m_s = mean(calibrated),
        .uncertainty_m_s = standard_deviation(calibrated) / std::sqrt(static_cast<double>(samples)),
        .chosen_sd_m_s = standard_deviation(stated),
        .best_mean_m_s = mean(best_true),
        .best_sd_m_s = standard_deviation(best_true)};
}

/// Errors as large as the bound, or that wander as fast as the fitted one, of correlation times
/// spread evenly in the logarithm over the range.
std::vector<GaussMarkovError> bounded_errors(const SelectionModels& models) {
    constexpr int times = 5;
    std::vector<GaussMarkovError> errors;
    for (int i = 0; i < times; ++i) {
        const double tau_s =
            models.tau_min_s * std::pow(models.tau_max_s / models.tau_min_s, (i + 0.5) / times);
        errors.push_back(GaussMarkovError::steady(
            std::max(models.bound_m, models.along * models.estimated.error.process_density *
                                         std::sqrt(0.5 * tau_s)),
            tau_s));
    }
    return errors;
}

}  // namespace

double less_bias(double speed_m_s, double bias_m_s) {
    return std::max(0.0, speed_m_s - bias_m_s);
}

template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed) {
    SelectionBias result{.chosen_mean_m_s = stated_m_s, .best_mean_m_s = stated_m_s, .seed = seed};
    for (const WindowCluster<Axes>& cluster : clusters)
        result.candidates += std::ssize(cluster.windows);
    if (samples == 0) return result;
    // Neighbours err alike: of many windows some stand for all, more of them in more clusters.
    const std::int64_t most = std::max<std::int64_t>(200, 40 * std::ssize(clusters));
    const auto every = static_cast<std::size_t>((result.candidates + most - 1) / most);
    std::vector<Rivals<Axes>> rivals;
    for (const WindowCluster<Axes>& cluster : clusters)
        rivals.emplace_back(cluster, models, every);
    // The same numbers are drawn for both, so that their difference is that of the errors.
    const std::vector<GaussMarkovError> at_bound = bounded_errors(models);
    const auto bias_under = [&](const std::vector<GaussMarkovError>& errors) {
        return draw_bias(rivals, errors, std::ssize(at_bound), samples, seed);
    };
    const DrawnBias fitted = bias_under({drawn_model(models).error});
    const DrawnBias bounded = bias_under(at_bound);
    // Choosing the fastest never makes the speed too low.
    result.fitted_bias_m_s = std::max(0.0, fitted.bias_m_s);
    result.bounded_bias_m_s = std::max(result.fitted_bias_m_s, bounded.bias_m_s);
    result.bias_m_s = 0.5 * (result.fitted_bias_m_s + result.bounded_bias_m_s);
    result.bias_half_range_m_s = 0.5 * (result.bounded_bias_m_s - result.fitted_bias_m_s);
    result.bias_uncertainty_m_s = std::max(fitted.uncertainty_m_s, bounded.uncertainty_m_s);
    result.chosen_mean_m_s = stated_m_s - result.bias_m_s;
    result.chosen_sd_m_s = bounded.chosen_sd_m_s;
    result.best_mean_m_s = bounded.best_mean_m_s;
    result.best_sd_m_s = bounded.best_sd_m_s;
    result.samples = samples;
    return result;
}

template SelectionBias selection_bias<1>(const std::vector<WindowCluster<1>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);
template SelectionBias selection_bias<2>(const std::vector<WindowCluster<2>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);

}  // namespace runcert
