#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "core/random.h"

namespace runcert {

/// The two ends of a coverage interval, in the unit of the result.
struct CoverageInterval {
    double lower = 0.0;
    double upper = 0.0;
};

/// Options for propagating distributions, [GUM-S1] 7.9.4.
struct MonteCarloOptions {
    std::uint64_t seed = 1;
    /// Trials in a block, raised if below the minimum of [GUM-S1] 7.9.4 b),
    /// 100 / (1 - probability).
    std::int64_t block = 10'000;
    /// Blocks before the first test for convergence, at least 2. [GUM-S1] tests from the second
    /// block on. The standard deviation of two averages is by chance often small enough to stop far
    /// too early [WHCE10]. With a normal result of u = 2.0, 32 of 200 seeds gave a figure beyond
    /// the tolerance, and none with 10 blocks.
    std::int64_t blocks_min = 10;
    /// Largest number of trials. It bounds the memory, because each value is kept in 8 bytes.
    std::int64_t trials_max = 2'000'000;
    double probability = 0.95;   ///< of the coverage intervals
    int significant_digits = 2;  ///< correct digits required of the standard uncertainty, 1 to 15
    /// Trials continue until the figures are stable to this fraction of the tolerance. Use 1, or
    /// 0.2 to validate the law of propagation of uncertainty ([GUM-S1] 8.2).
    double tolerance_fraction = 1.0;
};

/// Figures of a result, from its simulated distribution.
struct MonteCarloResult {
    std::int64_t trials = 0;
    double mean = 0.0;
    double standard_uncertainty = 0.0;
    CoverageInterval symmetric;  ///< equal probability to either side ([GUM-S1] 3.15)
    /// The shortest interval ([GUM-S1] 3.16). On a flat-topped or nearly symmetric distribution its
    /// position is poorly determined, so the tolerance is not claimed for it.
    CoverageInterval shortest;
    double tolerance = 0.0;  ///< numerical tolerance delta of [GUM-S1] 7.9.2
    /// Whether twice the standard deviation of the mean, of the standard uncertainty and of both
    /// ends of the symmetric interval fell to tolerance_fraction * tolerance.
    bool converged = false;
};

/// Propagation of distributions by the adaptive procedure of [GUM-S1] 7.9.4.
///
/// `draw` gives one value of the result from one draw of all its inputs. The figures use all
/// trials: mean and standard deviation ([GUM-S1] 7.6), and intervals from all values sorted
/// ([GUM-S1] 7.7). The same options and `draw` give the same bits. No convergence within
/// `trials_max` is a finding, reported in the result. Failure (at "Monte Carlo propagation") for
/// options out of range, fewer trials than `blocks_min` blocks, or a value that is not finite.
MonteCarloResult propagate(const MonteCarloOptions& options,
                           const std::function<double(RandomGenerator&)>& draw);

/// The numerical tolerance of [GUM-S1] 7.9.2. With u = c 10^l, where the integer c has
/// `significant_digits` digits, it is 10^l / 2; for u = 0 it is 0. Failure if u is negative or
/// not finite, or the number of digits is not 1 to 15.
double numerical_tolerance(double standard_uncertainty, int significant_digits);

/// The probabilistically symmetric coverage interval of simulated values in ascending order
/// ([GUM-S1] 7.7). Failure if there are too few values for the probability.
CoverageInterval symmetric_interval(std::span<const double> sorted, double probability);

/// The shortest coverage interval of simulated values in ascending order ([GUM-S1] 7.7). Of equally
/// short ones it is the lowest. Failure as for `symmetric_interval`.
CoverageInterval shortest_interval(std::span<const double> sorted, double probability);

/// A random number uniform in (-half_width, half_width).
double draw_rectangular(RandomGenerator& random, double half_width);

/// A random number of Student's t distribution with 1 or more degrees of freedom, not necessarily
/// an integer. Empty means standard normal. A quantity estimated as x with standard uncertainty u
/// and nu degrees of freedom is x + u t ([GUM-S1] 6.4.9). Its standard deviation exceeds u by the
/// factor sqrt(nu / (nu - 2)), and is infinite up to nu = 2.
///
/// Drawn by rejection from a Cauchy variate, itself the quotient of a point's coordinates in the
/// unit disc. At worst a value takes 1.52 points on average. The C library's logarithm decides only
/// on acceptance, and values are products of basic operations. Platforms therefore differ only
/// where a uniform number falls within the last bits of the threshold. Failure if the degrees of
/// freedom are below 1 or not finite.
double draw_student_t(RandomGenerator& random, std::optional<double> degrees_of_freedom);

}  // namespace runcert
