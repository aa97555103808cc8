#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "motion/noise_fit.h"

// The search behind fit_noise; not for use elsewhere.
namespace runcert {

/// Natural logarithms of a model's parameters, with variances in units of the squared measurement
/// scale: the jerk density, then sigma and tau of the error, then the acceleration's correlation
/// time.
using Point = std::vector<double>;

/// The model that a point describes.
EstimationModel model_at(const Point& x);

/// The model with its variances multiplied by the square of `scale`.
EstimationModel scaled(const EstimationModel& relative, double scale);

/// Smallest measurement scale, a factor on the stated standard deviations.
inline constexpr double scale_min = 1e-3;

/// Smallest standard deviation of a Gauss-Markov error.
inline constexpr double error_sigma_min_m = 1e-5;

/// ln(2) / 2: added to the logarithm of sigma / sqrt(tau), it gives that of the diffusion.
inline constexpr double log_ratio = 0.34657359027997264;

/// Points whose log-likelihood is lower than the highest by this much are not pursued.
inline constexpr double hopeless_below = 12.0;

/// A point with its most likely scale and the likelihood there.
struct Best {
    Point x;
    double log_likelihood = -std::numeric_limits<double>::infinity();  ///< including that of the
                                                                       ///< prior
    double log_prior = 0.0;                                            ///< log-prior of the scale
    double scale = 1.0;
    /// Of a maximum: the curvature of the log-likelihood over the free parameters, for one epoch.
    Eigen::MatrixXd curvature = {};

    /// Log-likelihood gained over another point by the data alone, without the prior.
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

/// The grid point of the largest likelihood.
const Best& best_of(const std::vector<GridPoint>& grid);

/// A quadratic through log-likelihoods about a point, over its free parameters.
struct Quadratic {
    Eigen::VectorXd slope;
    Eigen::MatrixXd curvature;
};

/// The points about `x` that a quadratic over the parameters `free` (indices) needs: two along each
/// parameter, then two along the diagonal of each pair of them.
std::vector<Point> points_about(const Point& x, const std::vector<std::size_t>& free, double h);

/// The quadratic through a value and those at `points_about`, by central differences. Mixed ones
/// are taken along the diagonal only, which needs two points instead of four. Where `values` end
/// before the diagonals, the mixed curvature is that of `before`, rescaled to the new diagonal.
Quadratic quadratic_through(double value, const std::vector<double>& values, std::size_t free,
                            double h, const Eigen::MatrixXd& before = {});

/// Searches for the maximum likelihood of a set of arcs.
template <int Axes>
class NoiseSearch {
  public:
    using Arcs = std::span<const std::span<const ArcEpoch<Axes>>>;

    /// `stated_sigma_m` is the stated standard deviation, the unit for the size of the error. The
    /// arcs must outlive the search.
    NoiseSearch(Arcs arcs, const NoiseFitOptions& options, double stated_sigma_m)
        : arcs_(arcs), options_(options), stated_sigma_m_(stated_sigma_m) {
        for (const auto arc : arcs)
            epochs_ += std::ssize(arc);
    }

    /// The maximum for white noise alone. Scans the whole range of the jerk density, then refines.
    Best fit_white();

    /// The maximum near a point over the free parameters, within bounds: Newton's steps on
    /// quadratics through the likelihoods about each point reached. Where a maximum of other arcs
    /// is the start, its curvature is the first. Ends where a step gains less than `enough`.
    Best maximise(const Best& start, const std::vector<bool>& is_free, double enough = 0.0);

    /// Of some points the one of the largest likelihood.
    Best best_of(const std::vector<Point>& points);

    /// The grid around a point. For each size and correlation time of the error that is not
    /// hopeless, it holds the largest likelihood over the jerk density.
    std::vector<GridPoint> evaluate_grid(const Best& start, double acceleration_time_s);

    /// The same maxima at the points of another grid, starting from its jerk densities.
    std::vector<GridPoint> evaluate_at(const std::vector<GridPoint>& others);

    /// Log-likelihoods at absolute parameters: logarithms of jerk density, error diffusion, error
    /// tau and acceleration time (as many as the points have) and, last, of the scale.
    std::vector<double> absolute_log_likelihoods(const std::vector<Point>& points);

    /// Limits of the natural logarithm of parameter i of a point.
    double lower_bound(std::size_t i) const;
    double upper_bound(std::size_t i) const;

    /// Epochs that all evaluations together have filtered.
    std::int64_t epochs_filtered() const { return epochs_filtered_; }
    void add_epochs_filtered(std::int64_t of_another) { epochs_filtered_ += of_another; }
    bool converged() const { return converged_; }  ///< of the last `maximise`

  private:
    std::vector<InnovationSums> sums_of(const std::vector<EstimationModel>& models);
    std::vector<Best> evaluate_all(const std::vector<Point>& points);
    std::vector<Best> with_best_jerk(const std::vector<Point>& starts);

    Arcs arcs_;
    NoiseFitOptions options_;
    double stated_sigma_m_;
    std::int64_t epochs_ = 0;
    std::int64_t epochs_filtered_ = 0;
    bool converged_ = false;
};

}  // namespace runcert
