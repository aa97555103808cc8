#include "stages/window/selection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "core/random.h"
#include "core/statistics.h"
#include "motion/chain.h"
#include "motion/likelihood.h"
#include "stages/window/best_window_sums.h"
#include "stages/window/instants.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

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

/// What the windows of one leg err by, in m/s: in the speeds stated for them, and in their motion
/// as estimated. As factors of the two covariances, or drawn, with a column for each draw.
struct LegErrors {
    Eigen::MatrixXd stated;
    Eigen::MatrixXd motion;
};

/// Some windows of one leg, and the weights of the measured positions in each component of their
/// velocities: the stated ones, and those of the motion estimated from this stretch alone.
template <int Axes>
class LegByPositions {
  public:
    /// Of each `every` consecutive windows the one of the highest assured speed, and the chosen
    /// one; of fewer where the windows are long. They are added to `rivals`.
    LegByPositions(const Arc<Axes>& arc, const WindowLeg& leg, const SelectionModels& models,
                   std::size_t every, Rivals& rivals) {
        constexpr double flank_s = 5.0;
        const std::size_t last = std::ranges::max(leg.windows, {}, &FoundWindow::last).last;
        const EpochPair reach = reach_around(arc, {leg.windows.front().first, last}, flank_s);
        epochs_ = std::span(arc.epochs).subspan(reach.first, reach.last + 1 - reach.first);
        const EstimationModel drawn = drawn_model(models);
        const Chain<Axes> estimator(epochs_, models.estimated);
        const Chain<Axes> local(epochs_, local_model(epochs_, drawn));
        SpeedSums path{.path_m = {0.0}};
        for (std::size_t k = 1; k < epochs_.size(); ++k)
            path.path_m.push_back(path.path_m.back() + displacement(local, k - 1, k).norm());
        // The covariance costs the square of the rivals times the columns.
        constexpr double affordable = 2e8;
        const auto columns = std::ssize(epochs_) * Axes;
        const auto most = static_cast<std::size_t>(
            std::sqrt(affordable / static_cast<double>(columns)) / rivals.components);
        every = std::max(every, leg.windows.size() / std::max<std::size_t>(most, 10));
        const std::size_t number = rivals.legs.empty() ? 0 : rivals.legs.back() + 1;
        std::vector<EpochPair> windows;
        for (std::size_t first = 0; first < leg.windows.size(); first += every) {
            const std::size_t end = std::min(first + every, leg.windows.size());
            EpochPair representative;
            Eigen::VectorXd velocity;
            double highest = -std::numeric_limits<double>::infinity(), allowance = 0.0;
            bool is_chosen = false;
            for (std::size_t w = first; w < end && !is_chosen; ++w) {
                const FoundWindow& found = leg.windows[w];
                const EpochPair window{found.first - reach.first, found.last - reach.first};
                const double duration_s =
                    epochs_[window.last].time_s - epochs_[window.first].time_s;
                Eigen::VectorXd mean_velocity =
                    displacement(local, window.first, window.last) / duration_s;
                if (models.by_path)
                    mean_velocity.setConstant(
                        1, path.speed_m_s(window, duration_s, SpeedDefinition::path_length));
                const double assured = mean_velocity.norm() - found.allowance_m_s;
                is_chosen = w == leg.chosen;
                if (!is_chosen && w > first && !(assured > highest)) continue;
                representative = window;
                velocity = mean_velocity;
                highest = assured;
                allowance = found.allowance_m_s;
            }
            if (is_chosen) rivals.chosen = rivals.size();
            rivals.velocities_m_s.insert(rivals.velocities_m_s.end(), velocity.begin(),
                                         velocity.end());
            rivals.allowances_m_s.push_back(allowance);
            rivals.legs.push_back(number);
            windows.push_back(representative);
        }
        const auto rows = std::ssize(windows) * rivals.components;
        stated_.resize(rows, columns);
        motion_.resize(rows, columns);
        for (Eigen::Index row = 0; row < rows; ++row)
            set_row(row, windows[static_cast<std::size_t>(row / rivals.components)], estimator,
                    local, models.by_path, static_cast<int>(row % rivals.components));
        const double scale = drawn.measurement_scale;
        white_ = {.stated = covariance(on_white<Axes>(epochs_, stated_, scale)),
                  .motion = covariance(on_white<Axes>(epochs_, motion_, scale))};
    }

    /// The factors for white noise and this error.
    LegErrors factors(const GaussMarkovError& error) const {
        return {.stated = factor(white_.stated, on_slow<Axes>(epochs_, stated_, error)),
                .motion = factor(white_.motion, on_slow<Axes>(epochs_, motion_, error))};
    }

  private:
    /// Sets the weights in a window's path, or in this axis of its displacement, over time.
    void set_row(Eigen::Index row, EpochPair window, const Chain<Axes>& estimator,
                 const Chain<Axes>& local, bool by_path, int axis) {
        const double duration_s = epochs_[window.last].time_s - epochs_[window.first].time_s;
        Gradients<Axes> gradients(window.last - window.first + 1, StateVector<Axes>::Zero());
        if (by_path) {
            gradients = speed_gradients(local, window, duration_s,
                                        {.definition = SpeedDefinition::path_length});
        } else {
            gradients.front()(axis) = -1.0 / duration_s;
            gradients.back()(axis) = 1.0 / duration_s;
        }
        const auto set = [&](const Chain<Axes>& chain, Weights& weights) {
            const auto of_epochs = chain.weights(window.first, gradients);
            for (std::size_t k = 0; k < of_epochs.size(); ++k)
                weights.row(row).template segment<Axes>(static_cast<Eigen::Index>(k) * Axes) =
                    of_epochs[k].transpose();
        };
        set(estimator, stated_);
        set(local, motion_);
    }

    std::span<const ArcEpoch<Axes>> epochs_;  ///< of the leg, with some seconds before and after
    Weights stated_;
    Weights motion_;
    LegErrors white_;  ///< covariances of white noise alone
};

/// The draws are shared out evenly among the errors, in groups.
template <int Axes>
std::vector<SimulatedChoice> simulated(const ChoiceSimulation& choice,
                                       const std::vector<LegByPositions<Axes>>& legs,
                                       const std::vector<GaussMarkovError>& errors,
                                       std::int64_t groups, std::int64_t samples,
                                       std::int64_t seed) {
    std::vector<std::vector<LegErrors>> factors;
    for (const GaussMarkovError& error : errors) {
        auto& of_error = factors.emplace_back();
        for (const LegByPositions<Axes>& leg : legs)
            of_error.push_back(leg.factors(error));
    }
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    const auto draws = [&](const Eigen::MatrixXd& factor, std::int64_t count) -> Eigen::MatrixXd {
        const std::vector<double> numbers =
            random.normals(static_cast<std::size_t>(factor.rows() * count));
        return factor.triangularView<Eigen::Lower>() *
               Eigen::Map<const Eigen::MatrixXd>(numbers.data(), factor.rows(), count);
    };
    std::vector<SimulatedChoice> choices;
    for (std::int64_t group = 0; group < groups; ++group) {
        const auto share = (samples - std::ssize(choices)) / (groups - group);
        LegErrors drawn{.stated = Eigen::MatrixXd(choice.rows(), share),
                        .motion = Eigen::MatrixXd(choice.rows(), share)};
        Eigen::Index row = 0;
        for (const LegErrors& leg : factors[static_cast<std::size_t>(group) % factors.size()]) {
            drawn.stated.middleRows(row, leg.stated.rows()) = draws(leg.stated, share);
            drawn.motion.middleRows(row, leg.stated.rows()) = draws(leg.motion, share);
            row += leg.stated.rows();
        }
        for (std::int64_t i = 0; i < share; ++i)
            choices.push_back(choice(drawn.stated.col(i), drawn.motion.col(i)));
    }
    return choices;
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

std::vector<WindowLeg> legs_of(const std::vector<FoundWindow>& all, const FoundWindow& chosen,
                               double least_m_s, std::size_t longest) {
    std::vector<FoundWindow> near;
    for (const FoundWindow& window : all)
        if (window.assured_m_s() >= least_m_s) near.push_back(window);
    std::ranges::stable_sort(near, {}, [](const FoundWindow& window) {
        return std::tuple(window.series, window.first, window.last);
    });
    std::vector<WindowLeg> legs;
    std::size_t reach = 0;
    for (const FoundWindow& window : near) {
        if (legs.empty() || legs.back().series() != window.series || window.first > reach ||
            window.first - legs.back().windows.front().first >
                std::max(longest, window.last - window.first)) {
            legs.emplace_back();
            reach = 0;
        }
        WindowLeg& leg = legs.back();
        reach = std::max(reach, window.last);
        if (window.series == chosen.series && window.start == chosen.start &&
            window.end == chosen.end)
            leg.chosen = leg.windows.size();
        leg.windows.push_back(window);
    }
    return legs;
}

ChoiceSimulation::ChoiceSimulation(Rivals rivals, double together_m_s)
    : rivals_(std::move(rivals)),
      together_m_s_(together_m_s),
      likely_(Eigen::Map<const Eigen::VectorXd>(rivals_.velocities_m_s.data(),
                                                std::ssize(rivals_.velocities_m_s))) {
    draw_together(likely_);
}

void ChoiceSimulation::draw_together(Eigen::VectorXd& velocities) const {
    constexpr std::size_t fewest = 3;
    if (!(together_m_s_ > 0.0) || rivals_.legs.back() + 1 < fewest) return;
    assert(rivals_.components == 1);
    std::vector<double> fastest(rivals_.legs.back() + 1, -std::numeric_limits<double>::infinity());
    for (std::size_t w = 0; w < rivals_.size(); ++w) {
        double& of_leg = fastest[rivals_.legs[w]];
        of_leg =
            std::max(of_leg, velocities(static_cast<Eigen::Index>(w)) - rivals_.allowances_m_s[w]);
    }
    const double middle_m_s = mean(fastest);
    const double spread_m_s = standard_deviation(fastest);
    const double explained =
        spread_m_s > 0.0
            ? 1.0 - std::sqrt(std::max(0.0, 1.0 - std::pow(together_m_s_ / spread_m_s, 2)))
            : 0.0;
    for (std::size_t w = 0; w < rivals_.size(); ++w)
        velocities(static_cast<Eigen::Index>(w)) -=
            explained * (fastest[rivals_.legs[w]] - middle_m_s);
}

SimulatedChoice ChoiceSimulation::operator()(const Eigen::VectorXd& errors,
                                             const Eigen::VectorXd& before) const {
    struct Fastest {
        double assured_m_s = -std::numeric_limits<double>::infinity();
        double speed_m_s = 0.0;
        double error_m_s = 0.0;
    };
    const auto velocity = [&](const auto& all, std::size_t w) {
        return all.segment(static_cast<Eigen::Index>(w) * rivals_.components, rivals_.components);
    };
    const auto search = [&](const Eigen::VectorXd& truth, const Eigen::VectorXd& stated) {
        Fastest fastest;
        for (std::size_t w = 0; w < rivals_.size(); ++w) {
            const double speed = velocity(stated, w).norm();
            const double assured = speed - rivals_.allowances_m_s[w];
            if (!(assured > fastest.assured_m_s)) continue;
            fastest = {.assured_m_s = assured,
                       .speed_m_s = speed,
                       .error_m_s = speed - velocity(truth, w).norm()};
        }
        return fastest;
    };
    const auto of_chosen = [&](const Eigen::VectorXd& truth) {
        return velocity(truth, rivals_.chosen).normalized().dot(velocity(errors, rivals_.chosen));
    };
    Eigen::VectorXd disturbed = likely_ + before;
    draw_together(disturbed);
    const Fastest once = search(likely_, likely_ + errors);
    const Fastest again = search(disturbed, disturbed + errors);
    return {.error = once.error_m_s,
            .calibrated = 2.0 * (once.error_m_s - of_chosen(likely_)) -
                          (again.error_m_s - of_chosen(disturbed)),
            .best_true = search(disturbed, disturbed).speed_m_s};
}

SelectionBias bias_between(const std::vector<SimulatedChoice>& least,
                           const std::vector<SimulatedChoice>& most, double widest_m_s) {
    const auto values = [](const std::vector<SimulatedChoice>& choices,
                           double SimulatedChoice::*figure) {
        std::vector<double> all;
        for (const SimulatedChoice& one : choices)
            all.push_back(one.*figure);
        return all;
    };
    const std::vector<double> of_least = values(least, &SimulatedChoice::calibrated);
    const std::vector<double> of_most = values(most, &SimulatedChoice::calibrated);
    const std::vector<double> errors = values(most, &SimulatedChoice::error);
    const std::vector<double> best = values(most, &SimulatedChoice::best_true);
    SelectionBias bias;
    // Choosing the fastest never makes the speed too low.
    bias.fitted_bias_m_s = std::max(0.0, mean(of_least));
    bias.bounded_bias_m_s = std::max(bias.fitted_bias_m_s, mean(of_most));
    bias.bias_m_s = 0.5 * (bias.fitted_bias_m_s + bias.bounded_bias_m_s);
    bias.bias_half_range_m_s = 0.5 * (bias.bounded_bias_m_s - bias.fitted_bias_m_s);
    if (bias.bias_half_range_m_s > widest_m_s) {
        bias.bias_m_s = bias.fitted_bias_m_s;
        bias.bias_half_range_m_s = bias.bounded_bias_m_s - bias.fitted_bias_m_s;
    }
    bias.bias_uncertainty_m_s =
        std::max(standard_deviation(of_least), standard_deviation(of_most)) /
        std::sqrt(static_cast<double>(most.size()));
    bias.chosen_sd_m_s = standard_deviation(errors);
    bias.best_mean_m_s = mean(best);
    bias.best_sd_m_s = standard_deviation(best);
    bias.samples = std::ssize(most);
    return bias;
}

template <int Axes>
SelectionBias selection_bias(const std::vector<Arc<Axes>>& arcs, const std::vector<WindowLeg>& legs,
                             const SelectionModels& models, double stated_m_s, std::int64_t samples,
                             std::int64_t seed) {
    SelectionBias result{.chosen_mean_m_s = stated_m_s, .best_mean_m_s = stated_m_s};
    std::int64_t candidates = 0;
    for (const WindowLeg& leg : legs)
        candidates += std::ssize(leg.windows);
    if (samples > 0) {
        // Neighbours err alike: of many windows some stand for all, more of them in more legs.
        const std::int64_t most = std::max<std::int64_t>(200, 40 * std::ssize(legs));
        const auto every = static_cast<std::size_t>((candidates + most - 1) / most);
        Rivals rivals{.components = models.by_path ? 1 : Axes};
        std::vector<LegByPositions<Axes>> of_legs;
        for (const WindowLeg& leg : legs)
            of_legs.emplace_back(arcs[leg.series()], leg, models, every, rivals);
        const ChoiceSimulation choice(std::move(rivals));
        // The same numbers are drawn for both, so that their difference is that of the errors.
        const std::vector<GaussMarkovError> at_bound = bounded_errors(models);
        const auto under = [&](const std::vector<GaussMarkovError>& errors) {
            return simulated(choice, of_legs, errors, std::ssize(at_bound), samples, seed);
        };
        result = bias_between(under({drawn_model(models).error}), under(at_bound));
        result.chosen_mean_m_s = stated_m_s - result.bias_m_s;
    }
    result.candidates = candidates;
    result.seed = seed;
    return result;
}

#define RUNCERT_INSTANTIATE(AXES)                                                             \
    template SelectionBias selection_bias<AXES>(                                              \
        const std::vector<Arc<AXES>>&, const std::vector<WindowLeg>&, const SelectionModels&, \
        double, std::int64_t, std::int64_t);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
