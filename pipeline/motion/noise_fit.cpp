#include "motion/noise_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "motion/noise_search.h"

namespace runcert {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Half the 95 % quantile of chi-squared: the log-likelihood that one or two parameters must gain.
constexpr double gain_of_one_parameter = 1.9207;
constexpr double gain_of_two_parameters = 2.9957;

/// A long recording is first searched in part: few stretches of so many epochs, then more of them
/// where there are.
constexpr std::size_t few_stretches = 4, more_stretches = 16;
constexpr std::size_t epochs_of_stretch = 512;
/// Recordings no longer than this many parts are searched whole.
constexpr std::size_t parts_of_long_recording = 4;

template <int Axes>
using Spans = std::vector<std::span<const ArcEpoch<Axes>>>;

/// Appends `wanted` epochs from a place on, or as many as there are, treating all arcs as one
/// sequence.
template <int Axes>
void append_from(std::span<const std::span<const ArcEpoch<Axes>>> arcs, std::size_t place,
                 std::size_t wanted, Spans<Axes>& part) {
    for (const auto arc : arcs) {
        if (place >= arc.size()) {
            place -= arc.size();
            continue;
        }
        while (place < arc.size() && !arc[place].measurement)
            ++place;
        const auto stretch = arc.subspan(place).first(std::min(wanted, arc.size() - place));
        if (!stretch.empty()) part.push_back(stretch);
        wanted -= stretch.size();
        if (wanted == 0) return;
        place = 0;
    }
}

template <int Axes>
std::size_t epochs_in(std::span<const std::span<const ArcEpoch<Axes>>> arcs) {
    std::size_t epochs = 0;
    for (const auto arc : arcs)
        epochs += arc.size();
    return epochs;
}

/// Stretches spread evenly over a recording that is long beside them. Empty for a short one.
template <int Axes>
Spans<Axes> part_of(std::span<const std::span<const ArcEpoch<Axes>>> arcs, std::size_t stretches) {
    const std::size_t epochs = epochs_in(arcs);
    Spans<Axes> part;
    if (epochs <= parts_of_long_recording * stretches * epochs_of_stretch) return part;
    for (std::size_t i = 0; i < stretches; ++i)
        append_from<Axes>(arcs, epochs * (2 * i + 1) / (2 * stretches) - epochs_of_stretch / 2,
                          epochs_of_stretch, part);
    return part;
}

/// The maxima of the model types.
struct Maxima {
    Best white;
    Best error;  ///< with a Gauss-Markov error
    std::optional<Best> singer;
    bool correlated_error_detected = false;
    bool converged = false;
    bool as_in_parts = false;  ///< those of the parts of a long recording are close to them

    /// The maximum with persistent acceleration: that of white noise alone unless an error is
    /// detected.
    const Best& of_persistent() const { return correlated_error_detected ? error : white; }
    void tell() { correlated_error_detected = error.gain_over(white) > gain_of_two_parameters; }
};

template <int Axes>
class Fit {
  public:
    Fit(std::span<const std::span<const ArcEpoch<Axes>>> arcs, const NoiseFitOptions& options)
        : arcs_(arcs),
          options_(options),
          part_arcs_(part_of<Axes>(arcs, few_stretches)),
          more_arcs_(part_of<Axes>(arcs, more_stretches)),
          whole_(arcs, options, stated_sigma()),
          part_(part_arcs_, options, stated_sigma()),
          more_(more_arcs_, options, stated_sigma()) {}

    NoiseFit run() {
        NoiseFit fit;
        fit.model.motion.jerk_density = options_.initial_jerk_density;
        fit.jerk_density.value = options_.initial_jerk_density;
        fit.measurement_scale.value = 1.0;
        fit.acceleration_time.value = infinity;
        fit.epochs = count_epochs();
        fit.posterior = {{fit.model, 1.0}};
        if (count_tested(arcs_) < options_.epochs_needed) {
            fit.status = NoiseFit::Status::too_few_epochs;
            return fit;
        }
        if (!positions_vary()) {
            fit.status = NoiseFit::Status::constant_positions;
            return fit;
        }
        const Maxima maxima = find_in_steps();
        fit.white_scale = maxima.white.scale;
        fit.error_gain = maxima.error.gain_over(maxima.white);
        fit.correlated_error_detected = maxima.correlated_error_detected;
        Best best = maxima.of_persistent();
        double acceleration_time_s = infinity;
        if (maxima.singer) {
            fit.singer_gain = maxima.singer->gain_over(best);
            if (fit.singer_gain > gain_of_one_parameter ||
                options_.motion == NoiseFitOptions::Motion::singer) {
                best = *maxima.singer;
                acceleration_time_s = std::exp(best.x[3]);
            }
        }
        describe(best, fit);
        set_posterior(grid_about(std::isfinite(acceleration_time_s) ? best : maxima.white,
                                 acceleration_time_s, maxima.as_in_parts,
                                 std::isfinite(acceleration_time_s) ? best.x : maxima.error.x),
                      fit);
        fit.converged = maxima.converged;
        fit.passes = static_cast<double>(whole_.epochs_filtered() + part_.epochs_filtered() +
                                         more_.epochs_filtered()) /
                     static_cast<double>(epochs_in(arcs_));
        return fit;
    }

  private:
    bool with_singer() const {
        return options_.motion != NoiseFitOptions::Motion::constant_acceleration;
    }

    /// The maxima found from the grid, without a starting guess from a part.
    Maxima find(NoiseSearch<Axes>& search) {
        Maxima maxima;
        maxima.white = search.fit_white();
        grid_ = search.evaluate_grid(maxima.white, infinity);
        const Best start = best_of(grid_);
        maxima.error = search.maximise(start, all_free(3));
        if (!(maxima.error.log_likelihood > start.log_likelihood)) maxima.error = start;
        maxima.tell();
        if (with_singer()) maxima.singer = find_singer(search, maxima.of_persistent());
        maxima.converged = search.converged();
        return maxima;
    }

    /// Adds the acceleration's correlation time. The Gauss-Markov error stays out unless one is
    /// detected. Where it is, the two times trade off against each other, and the likelihood may
    /// have several maxima: each of three correlation times of the error, of the same diffusion,
    /// leads to one.
    Best find_singer(NoiseSearch<Axes>& search, const Best& persistent) {
        const bool with_error = persistent.x.size() > 1;
        Point x = persistent.x;
        if (!with_error) {
            x.push_back(std::log(error_sigma_min_m));
            x.push_back(std::log(options_.tau_min_s));
        }
        std::vector<double> error_times{x[2]};
        if (with_error)
            error_times.insert(error_times.end(),
                               {std::log(options_.tau_min_s), std::log(options_.tau_max_s)});
        Best best;
        for (const double log_tau : error_times) {
            std::vector<Point> starts;
            for (const double acceleration_time_s : {0.7, 3.0, 12.0}) {
                Point& start = starts.emplace_back(x);
                start[1] += 0.5 * (log_tau - x[2]);
                start[2] = log_tau;
                start.push_back(std::log(acceleration_time_s));
            }
            const Best found = search.maximise(search.best_of(starts), free_of_singer(with_error));
            if (found.log_likelihood > best.log_likelihood) best = found;
        }
        return best;
    }
    static std::vector<bool> all_free(std::size_t parameters) {
        return std::vector<bool>(parameters, true);
    }
    static std::vector<bool> free_of_singer(bool correlated_error_detected) {
        return {true, correlated_error_detected, correlated_error_detected, true};
    }

    /// A long recording is searched near the maxima of its parts. Where those are not
    /// representative, the grid over the whole shows whether there is a higher maximum: a craft
    /// that stands still in all of the stretches says nothing about how it sails.
    Maxima find_in_steps() {
        if (count_tested(part_arcs_) <
            std::max<std::int64_t>(options_.epochs_needed, epochs_of_stretch))
            return find(whole_);
        const bool in_two = !more_arcs_.empty();
        Maxima part = find(part_);
        if (in_two) part = near(part, more_);
        Maxima whole = near(part, whole_);
        whole.as_in_parts = are_alike(part, whole, in_two ? more_ : part_);
        if (whole.as_in_parts) return whole;
        grid_ = whole_.evaluate_grid(whole.white, infinity);
        if (const Best start = best_of(grid_); start.log_likelihood > whole.error.log_likelihood) {
            whole.error = whole_.maximise(start, all_free(3));
            whole.tell();
            if (with_singer())
                if (const Best other = find_singer(whole_, whole.of_persistent());
                    other.log_likelihood > whole.singer->log_likelihood)
                    whole.singer = other;
            whole.converged = whole_.converged();
        }
        return whole;
    }

    /// Whether jerk density, scale and, if there is an error, its diffusion differ by less than a
    /// factor of two. The data determine these. They do not determine jerk density and error
    /// relative to the scale, which may be next to nothing, nor the error's size, which trades off
    /// against its correlation time.
    static bool are_close(const Best& one, const Best& other) {
        constexpr double factor = 0.7;  // ln 2
        if (one.x.size() != other.x.size()) return false;
        const double scale = std::log(one.scale / other.scale);
        const auto alike = [](double difference) { return std::abs(difference) <= factor; };
        return alike(scale) && alike(one.x[0] - other.x[0] + scale) &&
               (one.x.size() < 3 || alike(log_diffusion(one.x) - log_diffusion(other.x) + scale));
    }

    /// Whether the maxima of a part are close to those of the whole, or the part cannot distinguish
    /// them.
    bool are_alike(const Maxima& part, const Maxima& whole, NoiseSearch<Axes>& in_part) {
        const auto alike = [&](const Best& one, const Best& other) {
            if (are_close(one, other)) return true;
            const auto seen = in_part.absolute_log_likelihoods({absolute(one), absolute(other)});
            return seen[1] >= seen[0] - hopeless_below;
        };
        return alike(part.white, whole.white) &&
               alike(part.of_persistent(), whole.of_persistent()) &&
               (!part.singer || alike(*part.singer, *whole.singer));
    }

    /// Natural logarithms of the absolute parameters, the scale last.
    static Point absolute(const Best& best) {
        Point y = best.x;
        y.push_back(std::log(best.scale));
        y[0] += std::log(best.scale);
        if (best.x.size() > 2) y[1] += std::log(best.scale) + log_ratio - 0.5 * y[2];
        return y;
    }

    /// Logarithm of an error's diffusion in units of the measurement scale, up to a constant.
    static double log_diffusion(const Point& x) { return x[1] - 0.5 * x[2]; }

    /// The maxima near those of a part. Those that another beats by far in the part are searched
    /// less closely: they only tell how far.
    Maxima near(const Maxima& part, NoiseSearch<Axes>& search) {
        constexpr double part_of_lead = 1e-3;
        Maxima maxima;
        std::array<NoiseSearch<Axes>, 3> searches{search, search, search};
        do_together(
            [&] {
                if (part.singer)
                    maxima.singer = searches[0].maximise(
                        *part.singer, free_of_singer(part.correlated_error_detected));
            },
            [&] {
                const double lead = part.singer ? part.singer->gain_over(part.error) : 0.0;
                maxima.error = searches[1].maximise(part.error, all_free(3), part_of_lead * lead);
            },
            [&] {
                maxima.white = searches[2].maximise(
                    part.white, all_free(1), part_of_lead * part.error.gain_over(part.white));
            });
        maxima.converged = searches[part.singer ? 0 : 1].converged();
        const std::int64_t before = search.epochs_filtered();
        for (const NoiseSearch<Axes>& one : searches)
            search.add_epochs_filtered(one.epochs_filtered() - before);
        maxima.tell();
        return maxima;
    }

    /// The grid for the posterior. Points that are hopeless in the part of a long recording are
    /// more so in the whole, and are dropped. The exception are points whose diffusion is within a
    /// grid step of that of the whole's own maximum, `whole`.
    std::vector<GridPoint> grid_about(const Best& best, double acceleration_time_s, bool by_part,
                                      const Point& whole) {
        const bool again = by_part || std::isfinite(acceleration_time_s);
        if (again) grid_ = (by_part ? part_ : whole_).evaluate_grid(best, acceleration_time_s);
        if (!by_part) return grid_;
        constexpr double next = 0.35;  // one step of the grid's sizes
        const double highest = best_of(grid_).log_likelihood;
        std::erase_if(grid_, [&](const GridPoint& point) {
            return point.best.log_likelihood < highest - hopeless_below &&
                   std::abs(log_diffusion(point.best.x) - log_diffusion(whole)) > next;
        });
        return whole_.evaluate_at(grid_);
    }

    std::int64_t count_epochs() const {
        std::int64_t count = 0;
        for (const auto arc : arcs_)
            count += measured_in(arc);
        return count;
    }

    /// Number of epochs whose innovations can be tested.
    static std::int64_t count_tested(std::span<const std::span<const ArcEpoch<Axes>>> arcs) {
        std::int64_t count = 0;
        for (const auto arc : arcs)
            count += std::max<std::int64_t>(0, measured_in(arc) - measurements_of_the_prior);
        return count;
    }

    static std::int64_t measured_in(std::span<const ArcEpoch<Axes>> arc) {
        return std::count_if(arc.begin(), arc.end(), [](const ArcEpoch<Axes>& epoch) {
            return epoch.measurement.has_value();
        });
    }

    bool positions_vary() const {
        for (const auto arc : arcs_)
            for (const ArcEpoch<Axes>& epoch : arc)
                if (epoch.measurement &&
                    epoch.measurement->position != arc.front().measurement->position)
                    return true;
        return false;
    }

    /// Root mean square of the stated standard deviations.
    double stated_sigma() const {
        double sum = 0.0;
        std::int64_t count = 0;
        for (const auto arc : arcs_)
            for (const ArcEpoch<Axes>& epoch : arc)
                if (epoch.measurement) {
                    sum += epoch.measurement->covariance.trace() / Axes;
                    ++count;
                }
        return std::sqrt(sum / static_cast<double>(count));
    }

    /// Covariance of the parameters in `among`, all others being known, from their joint
    /// information. Empty if that information is not positive definite.
    static std::optional<Eigen::MatrixXd> covariance_among(const Eigen::MatrixXd& information,
                                                           const std::vector<Eigen::Index>& among) {
        const Eigen::MatrixXd of_these = information(among, among);
        const Eigen::LLT<Eigen::MatrixXd> factor(of_these);
        if (factor.info() != Eigen::Success) return std::nullopt;
        return factor.solve(Eigen::MatrixXd::Identity(of_these.rows(), of_these.cols()));
    }

    /// Fills in the parameters, their uncertainties and the model of the maximum.
    void describe(const Best& best, NoiseFit& fit) {
        fit.model = scaled(model_at(best.x), best.scale);
        const Point y = absolute(best);
        std::vector<FittedParameter*> parameters{&fit.jerk_density};
        if (best.x.size() > 2) {
            parameters.push_back(&fit.error_diffusion);
            parameters.push_back(&fit.error_tau);
        }
        if (best.x.size() > 3) parameters.push_back(&fit.acceleration_time);
        parameters.push_back(&fit.measurement_scale);

        std::vector<std::size_t> free;
        for (std::size_t i = 0; i < parameters.size(); ++i) {
            FittedParameter& parameter = *parameters[i];
            parameter.value = std::exp(y[i]);
            parameter.relative_uncertainty = infinity;
            const bool is_scale = i + 1 == parameters.size();
            const bool of_error = !is_scale && (i == 1 || i == 2);
            constexpr double near = 0.01;
            parameter.at_bound = is_scale ? best.scale <= scale_min
                                          : best.x[i] < whole_.lower_bound(i) + near ||
                                                best.x[i] > whole_.upper_bound(i) - near;
            if (!parameter.at_bound && (!of_error || fit.correlated_error_detected))
                free.push_back(i);
        }
        // The negative curvature of the log-likelihood over the logarithms of the parameters.
        constexpr double h = 0.05;
        std::vector<Point> points = points_about(y, free, h);
        points.push_back(y);
        std::vector<double> values = whole_.absolute_log_likelihoods(points);
        const double at_y = values.back();
        values.pop_back();
        const Eigen::MatrixXd information =
            -quadratic_through(at_y, values, free.size(), h).curvature;
        std::vector<Eigen::Index> among(free.size());
        std::iota(among.begin(), among.end(), 0);
        auto covariance = covariance_among(information, among);
        // Size and correlation time may trade off along a ridge of flat likelihood. The correlation
        // time is then not determined.
        const auto tau = std::find(free.begin(), free.end(), 2U);
        if (fit.correlated_error_detected && tau != free.end()) {
            const auto k = static_cast<Eigen::Index>(tau - free.begin());
            if (!covariance || (*covariance)(k, k) > 1.0) {
                free.erase(tau);
                among.erase(among.begin() + k);
                covariance = covariance_among(information, among);
            }
        }
        if (covariance)
            for (std::size_t a = 0; a < free.size(); ++a) {
                const auto k = static_cast<Eigen::Index>(a);
                parameters[free[a]]->relative_uncertainty = std::sqrt((*covariance)(k, k));
            }
        if (!fit.correlated_error_detected) {
            fit.error_diffusion = {};
            fit.error_tau = {};
            return;
        }
        fit.error_sigma.value = fit.error_diffusion.value * std::sqrt(0.5 * fit.error_tau.value);
        fit.error_sigma.at_bound = fit.error_diffusion.at_bound;
        fit.error_sigma.relative_uncertainty = infinity;
        const auto at = [&](std::size_t parameter) {
            return std::find(free.begin(), free.end(), parameter) - free.begin();
        };
        const Eigen::Index d = at(1);
        const Eigen::Index t = at(2);
        const auto count = static_cast<Eigen::Index>(free.size());
        if (covariance && d < count && t < count)
            fit.error_sigma.relative_uncertainty =
                std::sqrt((*covariance)(d, d) + (*covariance)(d, t) + 0.25 * (*covariance)(t, t));
    }

    static void set_posterior(const std::vector<GridPoint>& grid, NoiseFit& fit) {
        const double highest = best_of(grid).log_likelihood;
        double sum = 0.0;
        double largest = 0.0;
        fit.posterior.clear();
        for (const GridPoint& point : grid) {
            // The grid is evenly spaced in the logarithms, so a uniform prior weights it by sigma
            // and tau. The point without an error represents sizes below a quarter of the white
            // noise.
            const double prior = std::max(point.sigma, 0.125) * point.tau_s;
            const double weight = prior * std::exp(point.best.log_likelihood - highest);
            fit.posterior.push_back({scaled(model_at(point.best.x), point.best.scale), weight});
            largest = std::max(largest, weight);
        }
        std::erase_if(fit.posterior,
                      [&](const WeightedModel& one) { return one.weight < 1e-3 * largest; });
        for (const WeightedModel& one : fit.posterior)
            sum += one.weight;
        for (WeightedModel& one : fit.posterior)
            one.weight /= sum;
    }

    std::span<const std::span<const ArcEpoch<Axes>>> arcs_;
    NoiseFitOptions options_;
    Spans<Axes> part_arcs_;
    Spans<Axes> more_arcs_;
    NoiseSearch<Axes> whole_;
    NoiseSearch<Axes> part_;
    NoiseSearch<Axes> more_;
    std::vector<GridPoint> grid_;
};

}  // namespace

template <int Axes>
NoiseFit fit_noise(std::span<const std::span<const ArcEpoch<Axes>>> arcs,
                   const NoiseFitOptions& options) {
    return Fit<Axes>(arcs, options).run();
}

template NoiseFit fit_noise<1>(std::span<const std::span<const ArcEpoch<1>>>,
                               const NoiseFitOptions&);
template NoiseFit fit_noise<2>(std::span<const std::span<const ArcEpoch<2>>>,
                               const NoiseFitOptions&);

}  // namespace runcert
