#include "core/accuracy_measures.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "core/eigenvalues.h"
#include "core/failure.h"
#include "core/statistics.h"

namespace runcert {

namespace {

void require_radius(double radius) {
    if (!(radius >= 0.0))
        throw Failure("radius", fmt::format("{} is not a radius", radius),
                      "Give a radius of zero or more");
}

void require_probability(double probability) {
    if (!(probability >= 0.0 && probability < 1.0))
        throw Failure("probability", fmt::format("{} is not in [0, 1)", probability),
                      "Give a probability below 1");
}

void require_sigma(double sigma) {
    if (!(std::isfinite(sigma) && sigma >= 0.0))
        throw Failure("covariance", fmt::format("{} is not a standard deviation", sigma),
                      "Give a finite standard deviation of zero or more");
}

/// Standard deviations along the principal axes, in increasing order.
template <int N>
std::array<double, N> principal_sigmas(const Eigen::Matrix<double, N, N>& covariance) {
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
    std::array<double, N> sigmas{};
    for (int i = 0; i < N; ++i)
        sigmas[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, variances[i]));
    return sigmas;
}

/// P(|x| <= radius) for independent x with these standard deviations, smallest first.
///
/// Over the smallest axis the rest of the vector must lie within sqrt(radius^2 - x^2):
/// P_n(r) = 2 integral_0^h phi(x / s) / s P_(n-1)(sqrt(r^2 - x^2)) dx, h = min(r, 9 s).
/// Taking the smallest axis first keeps the integrand smooth on the scale of h: the others cannot
/// vary faster. x = h sin(t) removes the square root's infinite slope at x = r.
double probability_within(std::span<const double> sigmas, double radius) {
    const double sigma = sigmas.front();
    if (sigmas.size() == 1) return probability_within_1d(sigma, radius);
    if (sigma == 0.0) return probability_within(sigmas.subspan(1), radius);
    constexpr double far = 9.0;  // standard deviations; 2e-19 of the probability is beyond
    const double height = std::min(radius, far * sigma);
    const auto integrand = [&](double t) {
        const double x = height * std::sin(t);
        const double rest = std::sqrt(std::max(0.0, (radius - x) * (radius + x)));
        return std::exp(-0.5 * (x / sigma) * (x / sigma)) * std::cos(t) *
               probability_within(sigmas.subspan(1), rest);
    };
    constexpr unsigned max_depth = 8;
    // The rule's estimate of its error is far above the error: this leaves less than 1e-12.
    constexpr double tolerance = 1e-9;
    const double integral = boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        integrand, 0.0, std::numbers::pi / 2, max_depth, tolerance);
    const double density_scale = std::numbers::sqrt2 * std::numbers::inv_sqrtpi;
    return std::min(1.0, density_scale * height / sigma * integral);
}

template <std::size_t N>
double radius_of(const std::array<double, N>& sigmas, double probability) {
    require_probability(probability);
    // Between the radii of the line and of the sphere that have the largest axis.
    const double largest = sigmas.back();
    const double line = largest * std::sqrt(chi_squared_quantile(probability, 1));
    const double sphere = largest * std::sqrt(chi_squared_quantile(probability, N));
    if (line == sphere) return line;
    const auto excess = [&](double radius) {
        return probability_within(sigmas, radius) - probability;
    };
    const double below = line * (1.0 - 1e-9);
    const double above = sphere * (1.0 + 1e-9);
    const double excess_below = excess(below);
    const double excess_above = excess(above);
    // Within rounding of 1 the probability no longer tells radii apart.
    if (!(excess_below < 0.0)) return line;
    if (!(excess_above > 0.0)) return sphere;
    std::uintmax_t iterations = 100;
    const auto bracket = boost::math::tools::toms748_solve(
        excess, below, above, excess_below, excess_above,
        boost::math::tools::eps_tolerance<double>(46), iterations);
    return 0.5 * (bracket.first + bracket.second);
}

}  // namespace

double probability_within_1d(double sigma, double radius) {
    require_sigma(sigma);
    require_radius(radius);
    if (sigma == 0.0) return 1.0;
    return std::erf(radius / (sigma * std::numbers::sqrt2));
}

double probability_within_2d(const Eigen::Matrix2d& covariance, double radius) {
    require_radius(radius);
    return probability_within(principal_sigmas<2>(covariance), radius);
}

double probability_within_3d(const Eigen::Matrix3d& covariance, double radius) {
    require_radius(radius);
    return probability_within(principal_sigmas<3>(covariance), radius);
}

double radius_1d(double sigma, double probability) {
    require_sigma(sigma);
    require_probability(probability);
    return sigma * std::numbers::sqrt2 * boost::math::erf_inv(probability);
}

double radius_2d(const Eigen::Matrix2d& covariance, double probability) {
    return radius_of(principal_sigmas<2>(covariance), probability);
}

double radius_3d(const Eigen::Matrix3d& covariance, double probability) {
    return radius_of(principal_sigmas<3>(covariance), probability);
}

double lep(double sigma) {
    return radius_1d(sigma, 0.5);
}

double r95_1d(double sigma) {
    return radius_1d(sigma, 0.95);
}

double cep(const Eigen::Matrix2d& covariance) {
    return radius_2d(covariance, 0.5);
}

double r95(const Eigen::Matrix2d& covariance) {
    return radius_2d(covariance, 0.95);
}

double drms(const Eigen::Matrix2d& covariance) {
    principal_sigmas<2>(covariance);  // for its checks
    return std::sqrt(covariance.trace());
}

double two_drms(const Eigen::Matrix2d& covariance) {
    return 2.0 * drms(covariance);
}

double sep(const Eigen::Matrix3d& covariance) {
    return radius_3d(covariance, 0.5);
}

double mrse(const Eigen::Matrix3d& covariance) {
    principal_sigmas<3>(covariance);  // for its checks
    return std::sqrt(covariance.trace());
}

}  // namespace runcert
