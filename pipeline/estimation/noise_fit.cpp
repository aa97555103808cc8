#include "estimation/noise_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <nlopt.hpp>
#include <optional>

namespace runcert {
namespace {

using Point = std::vector<double>;  // natural logarithms of parameters

constexpr double infinity = std::numeric_limits<double>::infinity();
// In units of the measurement scale: what jerk density and error size are searched in.
constexpr double jerk_min = 3e-3;
constexpr double jerk_max = 1e4;
constexpr double sigma_min_m = 1e-5;
constexpr double sigma_max_of_stated = 100.0;      // in units of the stated accuracy
constexpr double log_ratio = 0.34657359027997264;  // ln(2) / 2: sigma to diffusion
constexpr double scale_min = 1e-3;                 // of the stated standard deviations
constexpr double acceleration_time_min_s = 0.2;
constexpr double acceleration_time_max_s = 1e3;

/// Half the 95 % quantile of chi-squared: what a log-likelihood must gain by one or two parameters.
constexpr double gain_of_one_parameter = 1.9207;
constexpr double gain_of_two_parameters = 2.9957;

/// The model of a point, its variances in units of the measurement scale squared:
/// ln jerk density; then ln sigma and ln tau of the error; then ln acceleration time.
EstimationModel model_at(const Point& x) {
    EstimationModel model;
    model.motion.jerk_density = std::exp(x[0]);
    if (x.size() > 2) model.error = GaussMarkovError::steady(std::exp(x[1]), std::exp(x[2]));
    if (x.size() > 3) model.motion.acceleration_time_s = std::exp(x[3]);
    return model;
}

/// The same model with its variances multiplied by the square of a scale.
EstimationModel scaled(const EstimationModel& relative, double scale) {
    EstimationModel model = relative;
    model.measurement_scale *= scale;
    model.motion.jerk_density *= scale;
    model.error.process_density *= scale;
    model.error.initial_sigma_m *= scale;
    return model;
}

template <int Axes>
class Fit {
  public:
    Fit(std::span<const std::span<const ArcEpoch<Axes>>> arcs, const NoiseFitOptions& options)
        : arcs_(arcs), options_(options) {}

    NoiseFit run() {
        NoiseFit fit;
        fit.model.motion.jerk_density = options_.initial_jerk_density;
        fit.jerk_density.value = options_.initial_jerk_density;
        fit.measurement_scale.value = 1.0;
        fit.acceleration_time.value = infinity;
        fit.epochs = count_epochs();
        fit.posterior = {{fit.model, 1.0}};
        if (count_tested() < options_.epochs_needed) {
            fit.status = NoiseFit::Status::too_few_epochs;
            return fit;
        }
        if (!positions_vary()) {
            fit.status = NoiseFit::Status::constant_positions;
            return fit;
        }
        stated_sigma_m_ = stated_sigma();
        const Best white = fit_white();
        fit.white_scale = white.scale;
        std::vector<GridPoint> grid = evaluate_grid(white, infinity);
        Best best = refine(best_of(grid));
        fit.error_gain = best.log_likelihood - white.log_likelihood;
        fit.error_told = fit.error_gain > gain_of_two_parameters;
        if (!fit.error_told) best = white;
        if (options_.motion != NoiseFitOptions::Motion::constant_acceleration) {
            const Best singer = refine_singer(best);
            fit.singer_gain = singer.log_likelihood - best.log_likelihood;
            if (fit.singer_gain > gain_of_one_parameter ||
                options_.motion == NoiseFitOptions::Motion::singer) {
                best = singer;
                grid = evaluate_grid(best, std::exp(best.x[3]));
            }
        }
        describe(best, fit);
        set_posterior(grid, fit);
        fit.converged = converged_;
        fit.evaluations = evaluations_;
        return fit;
    }

  private:
    struct Best {
        Point x;
        double log_likelihood = -infinity;
        double scale = 1.0;
    };
    struct GridPoint {
        Best best;
        double tau_s = 0.0;
        double sigma = 0.0;  // in units of the white noise
    };

    std::int64_t count_epochs() const {
        std::int64_t count = 0;
        for (const auto arc : arcs_)
            count += measured_in(arc);
        return count;
    }

    /// Those whose innovations can be tested.
    std::int64_t count_tested() const {
        std::int64_t count = 0;
        for (const auto arc : arcs_)
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

    Best evaluate(const Point& x) {
        ++evaluations_;
        const InnovationSums sums = innovation_sums<Axes>(arcs_, model_at(x));
        const double log_likelihood = sums.log_likelihood_at_best_scale();
        return {.x = x,
                .log_likelihood = std::isfinite(log_likelihood) ? log_likelihood : -1e12,
                .scale = std::max(scale_min,
                                  std::sqrt(sums.statistic / static_cast<double>(sums.values)))};
    }

    /// Maximum from a starting point, by Powell's BOBYQA within bounds.
    Best maximise(const Point& start, double step, const std::vector<bool>& free) {
        Point from;
        Point lower;
        Point upper;
        for (std::size_t i = 0; i < start.size(); ++i) {
            if (!free[i]) continue;
            from.push_back(std::clamp(start[i], lower_bound(i), upper_bound(i)));
            lower.push_back(lower_bound(i));
            upper.push_back(upper_bound(i));
        }
        const auto whole = [&](const Point& part) {
            Point x = start;
            std::size_t next = 0;
            for (std::size_t i = 0; i < x.size(); ++i)
                if (free[i]) x[i] = part[next++];
            return x;
        };
        Best best;
        std::function<double(const Point&)> objective = [&](const Point& part) {
            const Best one = evaluate(whole(part));
            if (one.log_likelihood > best.log_likelihood) best = one;
            return -one.log_likelihood;
        };
        // BOBYQA needs two variables at least.
        nlopt::opt search(from.size() == 1 ? nlopt::LN_COBYLA : nlopt::LN_BOBYQA,
                          static_cast<unsigned>(from.size()));
        search.set_min_objective(
            [](const Point& x, Point&, void* function) {
                return (*static_cast<std::function<double(const Point&)>*>(function))(x);
            },
            &objective);
        search.set_lower_bounds(lower);
        search.set_upper_bounds(upper);
        search.set_initial_step(step);
        search.set_ftol_abs(1e-3);
        search.set_xtol_abs(1e-3);
        search.set_maxeval(evaluations_allowed);
        double value = 0.0;
        try {
            converged_ = search.optimize(from, value) != nlopt::MAXEVAL_REACHED;
        } catch (const nlopt::roundoff_limited&) {
            converged_ = true;  // no better point can be told from this one
        }
        return best;
    }
    Best maximise(const Point& start, double step) {
        return maximise(start, step, std::vector<bool>(start.size(), true));
    }

    double lower_bound(std::size_t i) const {
        const double bounds[] = {jerk_min, sigma_min_m, options_.tau_min_s,
                                 acceleration_time_min_s};
        return std::log(bounds[i]);
    }
    double upper_bound(std::size_t i) const {
        const double bounds[] = {jerk_max, sigma_max_of_stated * stated_sigma_m_,
                                 options_.tau_max_s, acceleration_time_max_s};
        return std::log(bounds[i]);
    }

    /// White noise alone: the jerk density first over its whole range, then closely.
    Best fit_white() {
        Best best;
        for (double x = lower_bound(0); x <= upper_bound(0); x += 1.0)
            if (const Best one = evaluate({x}); one.log_likelihood > best.log_likelihood)
                best = one;
        return maximise(best.x, 0.5);
    }

    /// The likelihood's maximum over the jerk density alone, from its parabola through three
    /// points about `start`.
    Best with_best_jerk(Point x) {
        constexpr double h = 0.4;
        const double centre = x[0];
        const auto at = [&](double jerk) {
            x[0] = std::clamp(jerk, lower_bound(0), upper_bound(0));
            return evaluate(x);
        };
        const Best middle = at(centre);
        const Best left = at(centre - h);
        const Best right = at(centre + h);
        const double curvature =
            left.log_likelihood - 2.0 * middle.log_likelihood + right.log_likelihood;
        const double slope = right.log_likelihood - left.log_likelihood;
        const double move = curvature < 0.0 ? std::clamp(-0.5 * h * slope / curvature, -1.5, 1.5)
                                            : std::copysign(1.5, slope);
        Best best = at(centre + move);
        for (const Best& one : {middle, left, right})
            if (one.log_likelihood > best.log_likelihood) best = one;
        return best;
    }

    std::vector<GridPoint> evaluate_grid(const Best& start, double acceleration_time_s) {
        std::vector<GridPoint> grid;
        double highest = -infinity;
        for (int t = 0; t < 4; ++t) {
            const double tau_s =
                options_.tau_min_s * std::pow(options_.tau_max_s / options_.tau_min_s, t / 3.0);
            double jerk = start.x[0];
            int hopeless = 0;
            for (const double sigma :
                 {0.0, 0.5, 1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 16.0, 32.0, 64.0}) {
                if (sigma == 0.0 && t > 0) continue;
                Point x{jerk, std::log(std::max(sigma * stated_sigma_m_, sigma_min_m)),
                        std::log(tau_s)};
                if (std::isfinite(acceleration_time_s)) x.push_back(std::log(acceleration_time_s));
                const Best best = with_best_jerk(x);
                jerk = best.x[0];
                grid.push_back({best, tau_s, sigma});
                highest = std::max(highest, best.log_likelihood);
                // The likelihood has one maximum along the size: beyond it nothing comes back.
                hopeless = best.log_likelihood < highest - 12.0 ? hopeless + 1 : 0;
                if (hopeless == 3) break;
            }
        }
        return grid;
    }

    static Best best_of(const std::vector<GridPoint>& grid) {
        return std::max_element(grid.begin(), grid.end(),
                                [](const GridPoint& a, const GridPoint& b) {
                                    return a.best.log_likelihood < b.best.log_likelihood;
                                })
            ->best;
    }

    Best refine(const Best& start) {
        const Best best = maximise(start.x, 0.3);
        return best.log_likelihood > start.log_likelihood ? best : start;
    }

    /// Adds the acceleration's correlation time; without an error told, that stays away.
    Best refine_singer(const Best& start) {
        Point x = start.x;
        std::vector<bool> free(4, true);
        if (x.size() == 1) {
            x.push_back(std::log(sigma_min_m));
            x.push_back(std::log(options_.tau_min_s));
            free[1] = free[2] = false;
        }
        x.push_back(std::log(3.0));
        return maximise(x, 0.5, free);
    }

    /// Log-likelihood at the absolute logarithms of jerk density, error diffusion, error tau and
    /// acceleration time (those that the point has) and, last, of the scale.
    double absolute_log_likelihood(const Point& y) {
        ++evaluations_;
        const double log_scale = y.back();
        Point relative(y.begin(), y.end() - 1);
        relative[0] -= log_scale;
        if (relative.size() > 1) relative[1] += 0.5 * relative[2] - log_ratio - log_scale;
        return innovation_sums<Axes>(arcs_, scaled(model_at(relative), std::exp(log_scale)))
            .log_likelihood();
    }

    /// Covariance of the logarithms of the free parameters (indices into y) by the inverse of the
    /// likelihood's curvature, from central differences; empty where that is not positive definite.
    std::optional<Eigen::MatrixXd> covariance_at(const Point& y,
                                                 const std::vector<std::size_t>& free) {
        constexpr double h = 0.05;
        const auto at = [&](std::size_t i, double di, std::size_t j, double dj) {
            Point moved = y;
            moved[i] += di;
            moved[j] += dj;
            return absolute_log_likelihood(moved);
        };
        const double middle = absolute_log_likelihood(y);
        const auto n = static_cast<Eigen::Index>(free.size());
        Eigen::MatrixXd information(n, n);
        for (Eigen::Index a = 0; a < n; ++a) {
            const std::size_t i = free[static_cast<std::size_t>(a)];
            information(a, a) = -(at(i, h, i, 0.0) - 2.0 * middle + at(i, -h, i, 0.0)) / (h * h);
            for (Eigen::Index b = 0; b < a; ++b) {
                const std::size_t j = free[static_cast<std::size_t>(b)];
                information(a, b) = information(b, a) =
                    -(at(i, h, j, h) - at(i, h, j, -h) - at(i, -h, j, h) + at(i, -h, j, -h)) /
                    (4.0 * h * h);
            }
        }
        const Eigen::LLT<Eigen::MatrixXd> factor(information);
        if (factor.info() != Eigen::Success) return std::nullopt;
        return factor.solve(Eigen::MatrixXd::Identity(n, n));
    }

    /// Parameters, their uncertainties and the model of the maximum.
    void describe(const Best& best, NoiseFit& fit) {
        fit.model = scaled(model_at(best.x), best.scale);
        Point y = best.x;
        y.push_back(std::log(best.scale));
        y[0] += std::log(best.scale);
        std::vector<FittedParameter*> parameters{&fit.jerk_density};
        if (best.x.size() > 2) {
            y[1] += std::log(best.scale) + log_ratio - 0.5 * y[2];
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
            parameter.at_bound =
                is_scale ? best.scale <= scale_min
                         : best.x[i] < lower_bound(i) + near || best.x[i] > upper_bound(i) - near;
            if (!parameter.at_bound && (!of_error || fit.error_told)) free.push_back(i);
        }
        auto covariance = covariance_at(y, free);
        // Size and correlation time may trade against each other along a ridge on which the
        // likelihood is flat: then the correlation time is not told.
        const auto tau = std::find(free.begin(), free.end(), 2U);
        if (fit.error_told && tau != free.end()) {
            const auto k = static_cast<Eigen::Index>(tau - free.begin());
            if (!covariance || (*covariance)(k, k) > 1.0) {
                free.erase(tau);
                covariance = covariance_at(y, free);
            }
        }
        if (covariance)
            for (std::size_t a = 0; a < free.size(); ++a) {
                const auto k = static_cast<Eigen::Index>(a);
                parameters[free[a]]->relative_uncertainty = std::sqrt((*covariance)(k, k));
            }
        if (!fit.error_told) {
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
            // The grid is even in the logarithms: a uniform prior weighs with sigma and tau. The
            // point without an error stands for the sizes below a quarter of the white noise.
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

    static constexpr int evaluations_allowed = 200;
    std::span<const std::span<const ArcEpoch<Axes>>> arcs_;
    NoiseFitOptions options_;
    double stated_sigma_m_ = 0.0;
    std::int64_t evaluations_ = 0;
    bool converged_ = false;
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
