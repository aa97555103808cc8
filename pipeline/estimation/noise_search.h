#pragma once

#include <limits>
#include <vector>

#include "estimation/noise_fit.h"

// What fit_noise searches with; not for use elsewhere.
namespace runcert {

/// Natural logarithms of a model's parameters, variances in units of the measurement scale squared:
/// jerk density; then sigma and tau of the error; then the acceleration's time.
using Point = std::vector<double>;

/// The model of a point.
EstimationModel model_at(const Point& x);

/// The same model with its variances multiplied by the square of a scale.
EstimationModel scaled(const EstimationModel& relative, double scale);

/// The least measurement scale, of the stated standard deviations.
inline constexpr double scale_min = 1e-3;

/// The least size of an error.
inline constexpr double error_sigma_min_m = 1e-5;

/// ln(2) / 2: from the logarithm of an error's size to that of its diffusion.
inline constexpr double log_ratio = 0.34657359027997264;

/// What has a log-likelihood lower by so much than the highest is out of the question.
inline constexpr double hopeless_below = 12.0;

/// A point, its likelihood at the scale most likely with it, and that scale.
struct Best {
    Point x;
    double log_likelihood = -std::numeric_limits<double>::infinity();  ///< with that of the prior
    double log_prior = 0.0;                                            ///< of the scale
    double scale = 1.0;

    /// By how much the data alone favour it over another.
    double gain_over(const Best& other) const {
        return log_likelihood - log_prior - (other.log_likelihood - other.log_prior);
    }
};

/// A point of the grid over size and correlation time of the error.
struct GridPoint {
    Best best;
    double tau_s = 0.0;
    double sigma = 0.0;  ///< in units of the stated standard deviation
};

/// The point of the largest likelihood.
const Best& best_of(const std::vector<GridPoint>& grid);

/// Searches for the largest likelihood of some arcs.
template <int Axes>
class NoiseSearch {
  public:
    using Arcs = std::span<const std::span<const ArcEpoch<Axes>>>;

    /// `stated_sigma_m` is the size that the error's is compared with. The arcs must outlive it.
    NoiseSearch(Arcs arcs, const NoiseFitOptions& options, double stated_sigma_m)
        : arcs_(arcs), options_(options), stated_sigma_m_(stated_sigma_m) {}

    /// White noise alone: the jerk density first over its whole range, then closely.
    Best fit_white();

    /// The maximum near a point, of the parameters that are free, by BOBYQA [Powell09] within
    /// bounds; `step`: how far it looks first.
    Best maximise(const Point& start, double step, const std::vector<bool>& free);
    Best maximise(const Point& start, double step) {
        return maximise(start, step, std::vector<bool>(start.size(), true));
    }

    /// The grid about a point: the largest likelihood over the jerk density at each size and
    /// correlation time of the error that is not hopeless.
    std::vector<GridPoint> evaluate_grid(const Best& start, double acceleration_time_s);

    /// The same at the points of another grid, which has jerk densities to begin at.
    std::vector<GridPoint> evaluate_at(const std::vector<GridPoint>& others);

    /// Log-likelihoods at the absolute logarithms of jerk density, error diffusion, error tau and
    /// acceleration time (those that the points have) and, last, of the scale.
    std::vector<double> absolute_log_likelihoods(const std::vector<Point>& points);

    /// Of the natural logarithm of parameter i of a point.
    double lower_bound(std::size_t i) const;
    double upper_bound(std::size_t i) const;

    std::int64_t evaluations() const { return evaluations_; }
    void add_evaluations(const NoiseSearch& of_another) { evaluations_ += of_another.evaluations_; }
    bool converged() const { return converged_; }  ///< the last `maximise`

  private:
    Best evaluate(const Point& x);
    std::vector<Best> evaluate_all(const std::vector<Point>& points);
    std::vector<Best> with_best_jerk(const std::vector<Point>& starts);

    Arcs arcs_;
    NoiseFitOptions options_;
    double stated_sigma_m_;
    std::int64_t evaluations_ = 0;
    bool converged_ = false;
};

}  // namespace runcert
