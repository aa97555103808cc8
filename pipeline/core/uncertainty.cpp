#include "core/uncertainty.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <string>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert {

namespace {

constexpr double kCorrelationTolerance = 1e-12;

[[noreturn]] void fail_budget(const std::string& what, const char* remedy) {
    throw Failure("uncertainty budget", what, remedy);
}

void require_not_negative(double value, const char* name) {
    if (!(value >= 0.0 && std::isfinite(value)))
        fail_budget(fmt::format("the {} is {}", name, value), "Give a finite number, 0 or more");
}

void require_degrees(const std::optional<double>& degrees) {
    if (degrees && !(*degrees > 0.0 && std::isfinite(*degrees)))
        fail_budget(fmt::format("{} degrees of freedom", *degrees),
                    "Give a finite number above 0, or none for infinitely many");
}

void require_input(const InputQuantity& input) {
    require_not_negative(input.standard_uncertainty, "standard uncertainty");
    if (!std::isfinite(input.sensitivity))
        fail_budget(fmt::format("the sensitivity is {}", input.sensitivity),
                    "Give a finite number");
    require_degrees(input.degrees_of_freedom);
}

/// [GUM] (G.2b), divided through by u_c^4. Empty if every contribution has infinite degrees of
/// freedom.
std::optional<double> welch_satterthwaite(std::span<const InputQuantity> inputs, double combined) {
    double reciprocal = 0.0;
    for (const InputQuantity& input : inputs) {
        if (!input.degrees_of_freedom || contribution(input) == 0.0) continue;
        const double share = contribution(input) / combined;
        reciprocal += share * share * share * share / *input.degrees_of_freedom;
    }
    const double degrees = 1.0 / reciprocal;
    if (!std::isfinite(degrees)) return std::nullopt;
    return degrees;
}

Eigen::VectorXd contributions(std::span<const InputQuantity> inputs) {
    Eigen::VectorXd all(static_cast<Eigen::Index>(inputs.size()));
    Eigen::Index row = 0;
    for (const InputQuantity& input : inputs) {
        require_input(input);
        all[row++] = contribution(input);
    }
    return all;
}

void require_correlation(const Eigen::MatrixXd& matrix, Eigen::Index count) {
    constexpr const char* remedy = "Give the correlation coefficients of all inputs";
    if (matrix.rows() != count || matrix.cols() != count)
        fail_budget(fmt::format("the correlation matrix is {} by {} for {} inputs", matrix.rows(),
                                matrix.cols(), count),
                    remedy);
    if (!matrix.allFinite()) fail_budget("a correlation coefficient is not finite", remedy);
    if (!((matrix.diagonal().array() - 1.0).abs() <= kCorrelationTolerance).all())
        fail_budget("the diagonal of the correlation matrix is not 1", remedy);
    if (!((matrix - matrix.transpose()).array().abs() <= kCorrelationTolerance).all())
        fail_budget("the correlation matrix is not symmetric", remedy);
    if (count == 0) return;
    const double least = symmetric_eigenvalues(matrix)(0);
    if (least < -kCorrelationTolerance * static_cast<double>(count))
        fail_budget(
            fmt::format("the correlation matrix has the eigenvalue {:.3g}: no quantities can be "
                        "correlated so",
                        least),
            "Estimate all coefficients from the same observations");
}

bool any_finite_degrees(std::span<const InputQuantity> inputs) {
    for (const InputQuantity& input : inputs)
        if (input.degrees_of_freedom && contribution(input) != 0.0) return true;
    return false;
}

}  // namespace

double contribution(const InputQuantity& input) {
    return input.sensitivity * input.standard_uncertainty;
}

CombinedUncertainty combine(std::span<const InputQuantity> inputs) {
    const double combined = contributions(inputs).stableNorm();
    return {.standard_uncertainty = combined,
            .effective_degrees_of_freedom = welch_satterthwaite(inputs, combined)};
}

CombinedUncertainty combine(std::span<const InputQuantity> inputs,
                            const Eigen::MatrixXd& correlation) {
    const Eigen::VectorXd parts = contributions(inputs);
    require_correlation(correlation, parts.size());
    if (correlation.isIdentity(0.0)) return combine(inputs);
    // With full anticorrelation, rounding can leave a variance below 0.
    const double variance = std::max(0.0, parts.dot(correlation * parts));
    return {.standard_uncertainty = std::sqrt(variance),
            .degrees_of_freedom_defined = !any_finite_degrees(inputs)};
}

double coverage_factor(double probability, std::optional<double> degrees_of_freedom) {
    if (!(probability > 0.0 && probability < 1.0))
        fail_budget(fmt::format("the coverage probability {} is not in (0, 1)", probability),
                    "Give a probability such as 0.95");
    require_degrees(degrees_of_freedom);
    const double tail = (1.0 - probability) / 2.0;
    if (!degrees_of_freedom) return -normal_quantile(tail);
    return -boost::math::quantile(boost::math::students_t(*degrees_of_freedom), tail);
}

double equivalent_coverage_factor(double factor, std::optional<double> degrees_of_freedom) {
    if (!degrees_of_freedom) return factor;
    return coverage_factor(1.0 - 2.0 * normal_cdf(-factor), degrees_of_freedom);
}

double rectangular_uncertainty(double half_width) {
    require_not_negative(half_width, "half width");
    return half_width / std::sqrt(3.0);
}

std::optional<double> degrees_of_freedom(double relative_uncertainty) {
    require_not_negative(relative_uncertainty, "relative uncertainty of an uncertainty");
    const double degrees = 0.5 / (relative_uncertainty * relative_uncertainty);
    if (!std::isfinite(degrees)) return std::nullopt;
    return degrees;
}

Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly)
        .eigenvalues();
}

}  // namespace runcert
