#include "motion/noise_search.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <span>

namespace runcert {
namespace {

// Search limits of jerk density and error size, in units of the measurement scale.
constexpr double jerk_min = 3e-3;
constexpr double jerk_max = 1e4;
constexpr double sigma_min_m = error_sigma_min_m;
constexpr double sigma_max_of_stated = 100.0;  // in units of the stated standard deviation
constexpr double acceleration_time_min_s = 0.2;
constexpr double acceleration_time_max_s = 1e3;

// Prior standard deviation of the logarithm of the scale. Stated standard deviations are usually
// within a factor of seven of the actual noise.
constexpr double scale_prior_sd = 2.0;

double log_prior_of(double log_scale) {
    return -0.5 * (log_scale / scale_prior_sd) * (log_scale / scale_prior_sd);
}

Best best_scale_at(const Point& x, const InnovationSums& sums) {
    const double scale =
        std::max(scale_min, std::sqrt(sums.statistic / static_cast<double>(sums.values)));
    const double log_prior = log_prior_of(std::log(scale));
    const double log_likelihood = sums.log_likelihood_at_best_scale() + log_prior;
    return {.x = x,
            .log_likelihood = std::isfinite(log_likelihood) ? log_likelihood : -1e12,
            .log_prior = log_prior,
            .scale = scale};
}

}  // namespace

EstimationModel model_at(const Point& x) {
    EstimationModel model;
    model.motion.jerk_density = std::exp(x[0]);
    if (x.size() > 2) model.error = GaussMarkovError::steady(std::exp(x[1]), std::exp(x[2]));
    if (x.size() > 3) model.motion.acceleration_time_s = std::exp(x[3]);
    return model;
}

EstimationModel scaled(const EstimationModel& relative, double scale) {
    EstimationModel model = relative;
    model.measurement_scale *= scale;
    model.motion.jerk_density *= scale;
    model.error.process_density *= scale;
    model.error.initial_sigma_m *= scale;
    return model;
}

const Best& best_of(const std::vector<GridPoint>& grid) {
    return std::max_element(grid.begin(), grid.end(),
                            [](const GridPoint& a, const GridPoint& b) {
                                return a.best.log_likelihood < b.best.log_likelihood;
                            })
        ->best;
}

std::vector<Point> points_about(const Point& x, const std::vector<std::size_t>& free, double h) {
    std::vector<Point> points;
    const auto add = [&](std::size_t a, std::size_t b) {
        for (const double move : {h, -h}) {
            Point& moved = points.emplace_back(x);
            moved[free[a]] += move;
            if (b != a) moved[free[b]] += move;
        }
    };
    for (std::size_t a = 0; a < free.size(); ++a)
        add(a, a);
    for (std::size_t a = 0; a < free.size(); ++a)
        for (std::size_t b = 0; b < a; ++b)
            add(a, b);
    return points;
}

Quadratic quadratic_through(double value, const std::vector<double>& values, std::size_t free,
                            double h, const Eigen::MatrixXd& before) {
    const auto n = static_cast<Eigen::Index>(free);
    Quadratic found{Eigen::VectorXd(n), Eigen::MatrixXd(n, n)};
    auto next = values.begin();
    const auto along = [&] {
        const double curvature = (next[0] - 2.0 * value + next[1]) / (h * h);
        next += 2;
        return curvature;
    };
    for (Eigen::Index a = 0; a < n; ++a) {
        found.slope(a) = (next[0] - next[1]) / (2.0 * h);
        found.curvature(a, a) = along();
    }
    for (Eigen::Index a = 0; a < n; ++a)
        for (Eigen::Index b = 0; b < a; ++b) {
            const double own = found.curvature(a, a), other = found.curvature(b, b);
            double& mixed = found.curvature(a, b);
            if (next != values.end()) {
                mixed = 0.5 * (along() - own - other);
            } else {
                const double rescaled = own * other / (before(a, a) * before(b, b));
                // A parameter that changed nothing before has no mixed curvature to keep.
                const bool is_determined = std::isfinite(rescaled) && rescaled > 0.0;
                mixed = is_determined ? before(a, b) * std::sqrt(rescaled) : 0.0;
            }
            found.curvature(b, a) = mixed;
        }
    return found;
}

template <int Axes>
std::vector<InnovationSums> NoiseSearch<Axes>::sums_of(const std::vector<EstimationModel>& models) {
    epochs_filtered_ += std::ssize(models) * epochs_;
    return innovation_sums_of<Axes>(arcs_, models);
}

template <int Axes>
std::vector<Best> NoiseSearch<Axes>::evaluate_all(const std::vector<Point>& points) {
    std::vector<EstimationModel> models;
    for (const Point& x : points)
        models.push_back(model_at(x));
    const std::vector<InnovationSums> sums = sums_of(models);
    std::vector<Best> results;
    for (std::size_t i = 0; i < points.size(); ++i)
        results.push_back(best_scale_at(points[i], sums[i]));
    return results;
}

namespace {

/// Newton's step to the top of a quadratic, no longer than `reach`. Along a direction that curves
/// upwards, or hardly at all, it goes uphill.
Eigen::VectorXd step_uphill(const Quadratic& about, double reach) {
    constexpr double least_curvature = 1e-2;
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(-about.curvature);
    const Eigen::VectorXd along = axes.eigenvectors().transpose() * about.slope;
    const Eigen::VectorXd curvature = axes.eigenvalues().cwiseAbs().cwiseMax(least_curvature);
    const Eigen::VectorXd step = axes.eigenvectors() * along.cwiseQuotient(curvature);
    return step * std::min(1.0, reach / std::max(step.norm(), 1e-300));
}

}  // namespace

template <int Axes>
Best NoiseSearch<Axes>::maximise(const Best& start, const std::vector<bool>& is_free,
                                 double enough) {
    // Differences are taken over `widest` and, where the top is near, over less.
    constexpr double widest = 0.05, narrowest = 0.005;
    enough = std::max(enough, 5e-3);
    constexpr int rounds = 20;
    const auto clamped = [&](Point x) {
        for (std::size_t i = 0; i < x.size(); ++i)
            if (is_free[i]) x[i] = std::clamp(x[i], lower_bound(i), upper_bound(i));
        return x;
    };
    std::vector<std::size_t> free;
    for (std::size_t i = 0; i < start.x.size(); ++i)
        if (is_free[i]) free.push_back(i);
    const auto epochs = static_cast<double>(epochs_);
    Eigen::MatrixXd curvature;
    if (start.curvature.rows() == std::ssize(free)) curvature = epochs * start.curvature;
    Best best = evaluate_all({clamped(start.x)}).front();
    double reach = 2.0;
    double h = widest;
    converged_ = false;
    for (int round = 0; round < rounds && !converged_; ++round) {
        const Point x = best.x;
        std::vector<Point> about_x = points_about(x, free, h);
        const bool is_whole = curvature.size() == 0 || free.size() == 1;
        if (!is_whole) about_x.resize(2 * free.size());
        std::vector<double> values;
        for (const Best& one : evaluate_all(about_x))
            values.push_back(one.log_likelihood);
        Quadratic about = quadratic_through(best.log_likelihood, values, free.size(), h, curvature);
        curvature = about.curvature;
        // A parameter stays at its limit where the slope leads beyond it.
        for (std::size_t a = 0; a < free.size(); ++a) {
            const auto i = static_cast<Eigen::Index>(a);
            const bool at_bound = (x[free[a]] <= lower_bound(free[a]) && about.slope(i) <= 0.0) ||
                                  (x[free[a]] >= upper_bound(free[a]) && about.slope(i) >= 0.0);
            if (!at_bound) continue;
            about.slope(i) = 0.0;
            about.curvature.row(i).setZero();
            about.curvature.col(i).setZero();
        }
        const Eigen::VectorXd step = step_uphill(about, reach);
        const auto reached_by = [&](double length) {
            Point to = x;
            for (std::size_t a = 0; a < free.size(); ++a)
                to[free[a]] += length * step(static_cast<Eigen::Index>(a));
            return clamped(to);
        };
        std::vector<Best> reached = evaluate_all({reached_by(1.0), reached_by(2.0)});
        if (std::ranges::max(reached, {}, &Best::log_likelihood).log_likelihood <=
            best.log_likelihood)
            reached = evaluate_all({reached_by(0.25), reached_by(0.05)});
        const auto top = std::ranges::max_element(reached, {}, &Best::log_likelihood);
        const double gain = top->log_likelihood - best.log_likelihood;
        const double expected = about.slope.dot(step) + 0.5 * step.dot(about.curvature * step);
        // Where the quadratic holds to so little, what is left is less.
        const bool settled = std::max(gain, expected) < enough ||
                             std::abs(gain - expected) < enough || (gain <= 0.0 && h == narrowest);
        converged_ = settled && is_whole;
        if (gain > 0.0) best = *top;
        double moved = 0.0;
        for (const std::size_t i : free)
            moved = std::max(moved, std::abs(best.x[i] - x[i]));
        reach = moved > 0.0 ? 2.0 * moved : 0.01 * step.norm();
        h = std::clamp(0.5 * moved, narrowest, widest);
        // Mixed curvature is told anew where the step gained much less than the quadratic said, and
        // before the search ends.
        if (!converged_ && (settled || gain < 0.5 * expected)) curvature.resize(0, 0);
    }
    if (curvature.size() > 0) best.curvature = curvature / epochs;
    return best;
}

template <int Axes>
double NoiseSearch<Axes>::lower_bound(std::size_t i) const {
    const double bounds[] = {jerk_min, sigma_min_m, options_.tau_min_s, acceleration_time_min_s};
    return std::log(bounds[i]);
}

template <int Axes>
double NoiseSearch<Axes>::upper_bound(std::size_t i) const {
    const double bounds[] = {jerk_max, sigma_max_of_stated * stated_sigma_m_, options_.tau_max_s,
                             acceleration_time_max_s};
    return std::log(bounds[i]);
}

template <int Axes>
Best NoiseSearch<Axes>::best_of(const std::vector<Point>& points) {
    return std::ranges::max(evaluate_all(points), {}, &Best::log_likelihood);
}

template <int Axes>
Best NoiseSearch<Axes>::fit_white() {
    std::vector<Point> points;
    for (double x = lower_bound(0); x <= upper_bound(0); x += 1.0)
        points.push_back({x});
    return maximise(best_of(points), {true});
}

/// The likelihood's maximum over the jerk density alone, from a parabola through three points
/// around each start.
template <int Axes>
std::vector<Best> NoiseSearch<Axes>::with_best_jerk(const std::vector<Point>& starts) {
    constexpr double h = 0.4;
    const auto moved = [&](Point x, double move) {
        x[0] = std::clamp(x[0] + move, lower_bound(0), upper_bound(0));
        return x;
    };
    std::vector<Point> about;
    for (const Point& x : starts)
        for (const double move : {0.0, -h, h})
            about.push_back(moved(x, move));
    const std::vector<Best> seen = evaluate_all(about);
    std::vector<Point> tops;
    for (std::size_t i = 0; i < starts.size(); ++i) {
        const double middle = seen[3 * i].log_likelihood;
        const double left = seen[3 * i + 1].log_likelihood;
        const double right = seen[3 * i + 2].log_likelihood;
        const double curvature = left - 2.0 * middle + right;
        const double slope = right - left;
        tops.push_back(moved(starts[i], curvature < 0.0
                                            ? std::clamp(-0.5 * h * slope / curvature, -1.5, 1.5)
                                            : std::copysign(1.5, slope)));
    }
    std::vector<Best> best = evaluate_all(tops);
    for (std::size_t i = 0; i < starts.size(); ++i)
        for (std::size_t j = 3 * i; j < 3 * i + 3; ++j)
            if (seen[j].log_likelihood > best[i].log_likelihood) best[i] = seen[j];
    return best;
}

template <int Axes>
std::vector<GridPoint> NoiseSearch<Axes>::evaluate_grid(const Best& start,
                                                        double acceleration_time_s) {
    /// The sizes for one correlation time, in ascending order.
    struct Column {
        double tau_s = 0.0;
        double log_jerk = 0.0;  ///< of the latest size
        int hopeless = 0;
    };
    constexpr int columns = 4;
    std::vector<Column> open;
    for (int t = 0; t < columns; ++t)
        open.push_back(
            {.tau_s = options_.tau_min_s *
                      std::pow(options_.tau_max_s / options_.tau_min_s, t / (columns - 1.0)),
             .log_jerk = start.x[0]});
    std::vector<GridPoint> grid;
    double highest = -std::numeric_limits<double>::infinity();
    for (const double sigma : {0.0, 0.5, 1.0, 1.4, 2.0, 2.8, 4.0, 5.7, 8.0, 16.0, 32.0, 64.0}) {
        // Without an error its correlation time does not matter.
        const std::span<Column> of_size(open.data(), sigma == 0.0 ? 1 : open.size());
        std::vector<Point> starts;
        for (const Column& column : of_size) {
            Point& x = starts.emplace_back(
                Point{column.log_jerk, std::log(std::max(sigma * stated_sigma_m_, sigma_min_m)),
                      std::log(column.tau_s)});
            if (std::isfinite(acceleration_time_s)) x.push_back(std::log(acceleration_time_s));
        }
        const std::vector<Best> best = with_best_jerk(starts);
        for (std::size_t i = 0; i < best.size(); ++i) {
            grid.push_back({best[i], of_size[i].tau_s, sigma});
            highest = std::max(highest, best[i].log_likelihood);
        }
        for (std::size_t i = 0; i < best.size(); ++i) {
            Column& column = of_size[i];
            column.log_jerk = best[i].x[0];
            column.hopeless =
                best[i].log_likelihood < highest - hopeless_below ? column.hopeless + 1 : 0;
        }
        // The likelihood has a single maximum along the size, so it does not rise again beyond it.
        std::erase_if(open, [](const Column& column) { return column.hopeless == 3; });
        if (open.empty()) break;
    }
    return grid;
}

template <int Axes>
std::vector<GridPoint> NoiseSearch<Axes>::evaluate_at(const std::vector<GridPoint>& others) {
    std::vector<Point> starts;
    for (const GridPoint& other : others)
        starts.push_back(other.best.x);
    const std::vector<Best> best = with_best_jerk(starts);
    std::vector<GridPoint> grid = others;
    for (std::size_t i = 0; i < grid.size(); ++i)
        grid[i].best = best[i];
    return grid;
}

template <int Axes>
std::vector<double> NoiseSearch<Axes>::absolute_log_likelihoods(const std::vector<Point>& points) {
    std::vector<EstimationModel> models;
    for (const Point& y : points) {
        const double log_scale = y.back();
        Point relative(y.begin(), y.end() - 1);
        relative[0] -= log_scale;
        if (relative.size() > 1) relative[1] += 0.5 * relative[2] - log_ratio - log_scale;
        models.push_back(scaled(model_at(relative), std::exp(log_scale)));
    }
    std::vector<double> results;
    const std::vector<InnovationSums> sums = sums_of(models);
    for (std::size_t i = 0; i < sums.size(); ++i)
        results.push_back(sums[i].log_likelihood() + log_prior_of(points[i].back()));
    return results;
}

template class NoiseSearch<1>;
template class NoiseSearch<2>;

}  // namespace runcert
