#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace runcert {

/// A quantity that a result depends on: one line of an uncertainty budget.
struct InputQuantity {
    double standard_uncertainty = 0.0;  ///< in the unit of the quantity, not negative
    double sensitivity = 1.0;           ///< derivative of the result with respect to the quantity
    std::optional<double> degrees_of_freedom = std::nullopt;  ///< above 0; empty: infinite
};

/// Standard uncertainty of a result, in the unit of the result.
struct CombinedUncertainty {
    double standard_uncertainty = 0.0;
    /// Empty: infinite, or undefined (see below).
    std::optional<double> effective_degrees_of_freedom = std::nullopt;
    /// False if correlated inputs have finite degrees of freedom. The Welch-Satterthwaite
    /// formula does not apply to them, and the coverage factor of infinitely many would be too
    /// small.
    bool degrees_of_freedom_defined = true;
};

/// The signed contribution c_i u(x_i) of one input to the uncertainty of the result, in the unit
/// of the result ([GUM] 5.1.3).
double contribution(const InputQuantity& input);

/// Combined standard uncertainty of independent inputs, u_c^2 = sum (c_i u_i)^2 ([GUM] (10)). The
/// effective degrees of freedom follow Welch and Satterthwaite ([GUM] (G.2b)) and are not
/// truncated. First order: the terms of [GUM] 5.1.2, note, are left out. No inputs give zero.
/// Failure (at "uncertainty budget") for an uncertainty that is negative or not finite, a
/// sensitivity that is not finite, or degrees of freedom that are not finite and above 0.
CombinedUncertainty combine(std::span<const InputQuantity> inputs);

/// Combined standard uncertainty of correlated inputs, u_c^2 = sum_ij c_i c_j u_i u_j r_ij ([GUM]
/// (16)).
///
/// `correlation` is n by n for n inputs; the identity gives the result of the independent form.
/// Failure as for the independent form, and if it is not a correlation matrix: wrong size, not
/// symmetric, diagonal not 1, or an eigenvalue below 0 (all to 1e-12; a singular matrix is
/// allowed).
CombinedUncertainty combine(std::span<const InputQuantity> inputs,
                            const Eigen::MatrixXd& correlation);

/// Coverage factor k of an expanded uncertainty where no other is stated.
inline constexpr double usual_coverage_factor = 2.0;

/// Coverage factor k: the interval y - k u to y + k u holds Student's t distribution with
/// probability `probability` ([GUM] G.3; table G.2). Empty `degrees_of_freedom` mean the normal
/// distribution. They are not truncated to an integer: [GUM] G.4.1 lets the caller do so first,
/// which gives a k no smaller. Failure unless 0 < probability < 1 and the degrees of freedom are
/// finite and above 0.
double coverage_factor(double probability, std::optional<double> degrees_of_freedom);

/// The coverage factor that holds the same probability for a standard uncertainty with
/// `degrees_of_freedom` (empty: infinite) as `factor` does for the normal distribution ([GUM] G.3).
double equivalent_coverage_factor(double factor, std::optional<double> degrees_of_freedom);

/// Standard uncertainty of a quantity uniformly distributed within +- `half_width`:
/// half_width / sqrt(3) ([GUM] (7)). Failure if half_width is negative or not finite.
double rectangular_uncertainty(double half_width);

/// Degrees of freedom of a standard uncertainty that is itself uncertain by the fraction
/// `relative_uncertainty`: 1 / (2 relative_uncertainty^2) ([GUM] (G.3)). Empty, for infinite, where
/// the fraction is 0. Failure if the fraction is negative or not finite.
std::optional<double> degrees_of_freedom(double relative_uncertainty);

/// The n eigenvalues of a symmetric n by n matrix in ascending order, in the unit of its elements.
/// Only the lower triangle is read. The elements must be finite. Neither symmetry nor finiteness is
/// checked, and no Failure is thrown.
///
/// All callers share this function because Eigen's solver for each fixed size costs the compiler a
/// quarter of a minute.
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& matrix);

}  // namespace runcert
