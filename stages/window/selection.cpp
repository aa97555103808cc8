#include "stages/window/selection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/random.h"
#include "core/statistics.h"
#include "estimation/likelihood.h"
#include "estimation/linear_smoother.h"

namespace runcert {
namespace {

template <int Axes>
using Positions = std::vector<PositionVector<Axes>>;

/// The measured epochs of a cluster. A bridged step before one without a measurement stands before
/// the next that has one.
template <int Axes>
struct Stretch {
    std::vector<ArcEpoch<Axes>> epochs;
    std::vector<EpochPair> windows;   // indices into the epochs
    std::vector<double> durations_s;  // of each window
};

template <int Axes>
Stretch<Axes> stretch_of(const WindowCluster<Axes>& cluster) {
    const auto& epochs = cluster.arc->epochs;
    std::size_t last = 0;
    for (const EpochPair& window : cluster.windows)
        last = std::max(last, window.last);
    const std::size_t from = cluster.windows.front().first;
    Stretch<Axes> stretch;
    std::vector<std::size_t> index(last + 1, 0);
    bool step = false;
    for (std::size_t k = from; k <= last; ++k) {
        index[k] = stretch.epochs.size();
        step = step || epochs[k].step_before;
        if (!epochs[k].measurement) continue;
        stretch.epochs.push_back(epochs[k]);
        stretch.epochs.back().step_before = step;
        step = false;
    }
    for (const EpochPair& window : cluster.windows) {
        stretch.windows.push_back({index[window.first], index[window.last]});
        stretch.durations_s.push_back(epochs[window.last].time_s - epochs[window.first].time_s);
    }
    return stretch;
}

/// The model with the jerk density that is most likely on this stretch alone.
template <int Axes>
EstimationModel local_model(const Stretch<Axes>& stretch, EstimationModel model) {
    const std::span<const ArcEpoch<Axes>> arc(stretch.epochs);
    const double fitted = model.motion.jerk_density;
    double highest = 0.0;
    double best = fitted;
    bool first = true;
    for (double logarithm = std::log(3e-4); logarithm <= std::log(10.0); logarithm += 0.5) {
        model.motion.jerk_density = fitted * std::exp(logarithm);
        const double likelihood = innovation_sums<Axes>({&arc, 1}, model).log_likelihood();
        if (first || likelihood > highest) {
            highest = likelihood;
            best = model.motion.jerk_density;
        }
        first = false;
    }
    model.motion.jerk_density = best;
    return model;
}

/// The speeds of a stretch's windows.
template <int Axes>
class WindowSpeeds {
  public:
    /// Positions without offsets, as LinearSmoother makes them, also across bridged steps.
    WindowSpeeds(const Stretch<Axes>& stretch, const Positions<Axes>& positions, bool by_path)
        : stretch_(stretch), positions_(positions) {
        if (!by_path) return;
        path_m_.assign(1, 0.0);
        for (std::size_t k = 1; k < positions.size(); ++k)
            path_m_.push_back(path_m_.back() + (positions[k] - positions[k - 1]).norm());
    }
    double operator[](std::size_t w) const {
        const EpochPair& window = stretch_.windows[w];
        const double length_m = path_m_.empty()
                                    ? (positions_[window.last] - positions_[window.first]).norm()
                                    : path_m_[window.last] - path_m_[window.first];
        return length_m / stretch_.durations_s[w];
    }

  private:
    const Stretch<Axes>& stretch_;
    const Positions<Axes>& positions_;
    std::vector<double> path_m_;
};

/// The fastest window of a drawn recording, its speed in the search, and the error of the speed
/// stated for it.
struct Fastest {
    double searched_mps = -1.0;
    double error_mps = 0.0;
    double chosen_error_mps = 0.0;  ///< of the window chosen in the recording, if it is here
};

/// Draws errors, smooths and searches one cluster.
template <int Axes>
class Cluster {
  public:
    using Positions = runcert::Positions<Axes>;
    using Matrix = PositionMatrix<Axes>;

    Cluster(const WindowCluster<Axes>& windows, const SelectionModels& models)
        : stretch_(stretch_of(windows)),
          chosen_(windows.chosen),
          by_path_(models.by_path),
          error_(models.searched.error),
          searched_(stretch_.epochs, models.searched),
          certified_(stretch_.epochs, models.certified),
          local_(stretch_.epochs, local_model(stretch_, models.searched)) {
        Positions measured;
        const double scale = models.searched.measurement_scale;
        for (const ArcEpoch<Axes>& epoch : stretch_.epochs) {
            measured.push_back(epoch.measurement->position);
            const Matrix factor = epoch.measurement->covariance.llt().matrixL();
            white_factors_.push_back(scale * factor);
        }
        motion_ = local_(measured);
    }

    const Positions& motion() const { return motion_; }
    std::size_t windows() const { return stretch_.windows.size(); }

    Positions draw_errors(RandomGenerator& random) const {
        Positions errors(stretch_.epochs.size());
        PositionVector<Axes> slow = error_.initial_sigma_m * normals(random);
        for (std::size_t k = 0; k < errors.size(); ++k) {
            if (k > 0) {
                const double x =
                    (stretch_.epochs[k].time_s - stretch_.epochs[k - 1].time_s) / error_.tau_s;
                const double steady = error_.process_density * std::sqrt(0.5 * error_.tau_s);
                slow = std::exp(-x) * slow +
                       steady * std::sqrt(-std::expm1(-2.0 * x)) * normals(random);
            }
            errors[k] = slow + white_factors_[k] * normals(random);
        }
        return errors;
    }

    Positions estimate_motion(const Positions& measured) const { return local_(measured); }

    Fastest search(const Positions& motion, const Positions& errors) const {
        Positions measured(motion.size());
        for (std::size_t k = 0; k < motion.size(); ++k)
            measured[k] = motion[k] + errors[k];
        const Positions searched = searched_(measured);
        Fastest fastest;
        std::size_t best = 0;
        const auto speeds = speeds_of(searched);
        for (std::size_t w = 0; w < stretch_.windows.size(); ++w)
            if (const double speed = speeds[w]; speed > fastest.searched_mps) {
                fastest.searched_mps = speed;
                best = w;
            }
        const Positions certified = certified_(measured);
        const auto stated = speeds_of(certified);
        const auto truth = speeds_of(motion);
        const auto error = [&](std::size_t w) { return stated[w] - truth[w]; };
        fastest.error_mps = error(best);
        if (chosen_) fastest.chosen_error_mps = error(*chosen_);
        return fastest;
    }

    /// The error of the speed stated for the chosen window when positions have none.
    double chosen_error_without_noise(const Positions& motion) const {
        if (!chosen_) return 0.0;
        const Positions certified = certified_(motion);
        return speeds_of(certified)[*chosen_] - speeds_of(motion)[*chosen_];
    }

    double fastest_true(const Positions& motion) const {
        double fastest = 0.0;
        const auto speeds = speeds_of(motion);
        for (std::size_t w = 0; w < stretch_.windows.size(); ++w)
            fastest = std::max(fastest, speeds[w]);
        return fastest;
    }

  private:
    WindowSpeeds<Axes> speeds_of(const Positions& positions) const {
        return {stretch_, positions, by_path_};
    }

    static PositionVector<Axes> normals(RandomGenerator& random) {
        PositionVector<Axes> drawn;
        for (double& one : drawn)
            one = random.normal();
        return drawn;
    }

    Stretch<Axes> stretch_;
    std::optional<std::size_t> chosen_;
    bool by_path_;
    GaussMarkovError error_;
    LinearSmoother<Axes> searched_;
    LinearSmoother<Axes> certified_;
    LinearSmoother<Axes> local_;
    std::vector<Matrix> white_factors_;
    Positions motion_;
};

/// The fastest window over all clusters.
struct Draw {
    Fastest fastest;
    // Noise moves the chosen window's error about its value without noise: the difference is known
    // to vanish in the mean, and taking it off makes the mean settle with fewer draws. Zero in all
    // clusters but one.
    double chosen_noise_mps = 0.0;

    void take(const Fastest& one, double chosen_error_without_noise_mps) {
        chosen_noise_mps += one.chosen_error_mps - chosen_error_without_noise_mps;
        if (one.searched_mps > fastest.searched_mps) fastest = one;
    }
    double settled_error_mps() const { return fastest.error_mps - chosen_noise_mps; }
};

template <int Axes>
Positions<Axes> sum(const Positions<Axes>& a, const Positions<Axes>& b) {
    Positions<Axes> result(a.size());
    for (std::size_t k = 0; k < a.size(); ++k)
        result[k] = a[k] + b[k];
    return result;
}

}  // namespace

template <int Axes>
SelectionBias selection_bias(const std::vector<WindowCluster<Axes>>& clusters,
                             const SelectionModels& models, double stated_mps, std::int64_t samples,
                             std::int64_t seed) {
    std::vector<Cluster<Axes>> parts;
    SelectionBias result;
    for (const WindowCluster<Axes>& cluster : clusters) {
        parts.emplace_back(cluster, models);
        result.candidates += static_cast<std::int64_t>(parts.back().windows());
    }
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    std::vector<double> errors;
    std::vector<double> calibrated;
    std::vector<double> best_true;
    for (std::int64_t sample = 0; sample < samples; ++sample) {
        Draw once;
        Draw again;
        double fastest_true = 0.0;
        for (const Cluster<Axes>& part : parts) {
            const Positions<Axes> noise = part.draw_errors(random);
            const Positions<Axes> motion =
                part.estimate_motion(sum<Axes>(part.motion(), part.draw_errors(random)));
            once.take(part.search(part.motion(), noise),
                      part.chosen_error_without_noise(part.motion()));
            again.take(part.search(motion, noise), part.chosen_error_without_noise(motion));
            fastest_true = std::max(fastest_true, part.fastest_true(motion));
        }
        errors.push_back(once.fastest.error_mps);
        calibrated.push_back(2.0 * once.settled_error_mps() - again.settled_error_mps());
        best_true.push_back(fastest_true);
    }
    result.bias_mps = mean(calibrated);
    result.bias_uncertainty_mps =
        standard_deviation(calibrated) / std::sqrt(static_cast<double>(samples));
    result.chosen_mean_mps = stated_mps - result.bias_mps;
    result.chosen_sd_mps = standard_deviation(errors);
    result.best_mean_mps = mean(best_true);
    result.best_sd_mps = standard_deviation(best_true);
    result.samples = samples;
    result.seed = seed;
    return result;
}

template SelectionBias selection_bias<1>(const std::vector<WindowCluster<1>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);
template SelectionBias selection_bias<2>(const std::vector<WindowCluster<2>>&,
                                         const SelectionModels&, double, std::int64_t,
                                         std::int64_t);

}  // namespace runcert
