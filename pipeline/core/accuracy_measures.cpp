#include "core/accuracy_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/failure.h"
#include "core/statistics.h"
#include "core/uncertainty.h"

namespace runcert {

namespace {

/// Standard deviations along the principal axes.
struct Axes {
    double smaller = 0.0;
    double larger = 0.0;
};

Axes axes_of(const Eigen::Matrix2d& covariance) {
    const char* remedy = "Check the stated covariances of the positions";
    if (!covariance.allFinite())
        throw Failure("covariance", "an element is not a finite number", remedy);
    const double largest = covariance.cwiseAbs().maxCoeff();
    if ((covariance - covariance.transpose()).cwiseAbs().maxCoeff() > 1e-9 * largest)
        throw Failure("covariance", "the matrix is not symmetric", remedy);
    const Eigen::VectorXd variances = symmetric_eigenvalues(covariance);
    if (variances[0] < -1e-12 * largest)
        throw Failure("covariance", fmt::format("the variance along one axis is {}", variances[0]),
                      remedy);
    return {.smaller = std::sqrt(std::max(0.0, variances[0])),
            .larger = std::sqrt(std::max(0.0, variances[1]))};
}

double within_on_line(double sigma, double radius) {
    return sigma == 0.0 ? 1.0 : std::erf(radius / (sigma * std::numbers::sqrt2));
}

/// Integrates over the smaller axis, of standard deviation s, where the larger coordinate must lie
/// within sqrt(radius^2 - x^2): P(r) = 2 integral_0^h phi(x / s) / s P_1(sqrt(r^2 - x^2)) dx,
/// h = min(r, 9 s). The smaller axis keeps the integrand smooth on the scale of h, because the
/// other factor cannot vary faster. x = h sin(t) removes the square root's infinite slope at x = r.
double probability_within(const Axes& sigma, double radius) {
    if (sigma.smaller == 0.0) return within_on_line(sigma.larger, radius);
    constexpr double far = 9.0;  // standard deviations; 2e-19 of the probability lies beyond
    const double height = std::min(radius, far * sigma.smaller);
    const auto integrand = [&](double t) {
        const double x = height * std::sin(t);
        const double rest = std::sqrt(std::max(0.0, (radius - x) * (radius + x)));
        return std::exp(-0.5 * (x / sigma.smaller) * (x / sigma.smaller)) * std::cos(t) *
               within_on_line(sigma.larger, rest);
    };
    constexpr unsigned max_depth = 8;
    // The quadrature's error estimate far exceeds its error, which this keeps below 1e-12.
    constexpr double tolerance = 1e-9;
    const double integral = boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        integrand, 0.0, std::numbers::pi / 2, max_depth, tolerance);
    const double density_scale = std::numbers::sqrt2 * std::numbers::inv_sqrtpi;
    return std::min(1.0, density_scale * height / sigma.smaller * integral);
}

}  // namespace

double probability_within(const Eigen::Matrix2d& covariance, double radius) {
    if (!(radius >= 0.0))
        throw Failure("radius", fmt::format("{} is not a radius", radius),
                      "Give a radius of zero or more");
    return probability_within(axes_of(covariance), radius);
}

double r95(const Eigen::Matrix2d& covariance) {
    constexpr double probability = 0.95;
    const Axes sigma = axes_of(covariance);
    if (sigma.larger == 0.0) return 0.0;
    // The radius lies between those of a line and of a circle with the larger axis.
    const double line = sigma.larger * std::sqrt(chi_squared_quantile(probability, 1));
    const double circle = sigma.larger * std::sqrt(chi_squared_quantile(probability, 2));
    const auto excess = [&](double radius) {
        return probability_within(sigma, radius) - probability;
    };
    const double below = line * (1.0 - 1e-9);
    const double above = circle * (1.0 + 1e-9);
    const double excess_below = excess(below);
    const double excess_above = excess(above);
    if (!(excess_below < 0.0)) return line;
    if (!(excess_above > 0.0)) return circle;
    std::uintmax_t iterations = 100;
    const auto bracket = boost::math::tools::toms748_solve(
        excess, below, above, excess_below, excess_above,
        boost::math::tools::eps_tolerance<double>(46), iterations);
    return 0.5 * (bracket.first + bracket.second);
}

}  // namespace runcert
