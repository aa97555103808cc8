#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "core/random.h"

namespace runcert {

/// Two ends of a coverage interval, in the unit of the result.
struct CoverageInterval {
    double lower = 0.0;
    double upper = 0.0;
};

/// How to propagate distributions, [GUM-S1] 7.9.4.
struct MonteCarloOptions {
    std::uint64_t seed = 1;
    /// Trials in a block; raised to the least of [GUM-S1] 7.9.4 b), 100 / (1 - probability).
    std::int64_t block = 10'000;
    /// Blocks before the first test for convergence, at least 2. [GUM-S1] tests from the second
    /// on, where the standard deviation of two averages is small by chance often enough to stop
    /// far too early [WHCE10]: of 200 seeds of a
    /// normal result with u = 2.0, 32 had a figure beyond the tolerance, and none with 10 blocks.
    std::int64_t blocks_min = 10;
    /// Most trials, and what bounds the memory: each value is kept, 8 bytes.
    std::int64_t trials_max = 2'000'000;
    double probability = 0.95;   ///< of the coverage intervals
    int significant_digits = 2;  ///< of the standard uncertainty that shall be right, 1 to 15
    /// Go on until the figures are stable to this fraction of the tolerance: 1, or 0.2 where they
    /// shall judge the law of propagation of uncertainty ([GUM-S1] 8.2).
    double tolerance_fraction = 1.0;
};

/// What is known of a result from its simulated distribution.
struct MonteCarloResult {
    std::int64_t trials = 0;
    double mean = 0.0;
    double standard_uncertainty = 0.0;
    CoverageInterval symmetric;  ///< equal probability to either side ([GUM-S1] 3.15)
    /// The shortest ([GUM-S1] 3.16). Its place on a flat-topped or nearly symmetric distribution
    /// is loosely determined: the tolerance is not claimed for it.
    CoverageInterval shortest;
    double tolerance = 0.0;  ///< numerical tolerance delta of [GUM-S1] 7.9.2
    /// Whether twice the standard deviation of the mean, the standard uncertainty and both ends
    /// of the symmetric interval came down to tolerance_fraction * tolerance.
    bool converged = false;
};

/// Propagation of distributions by the adaptive procedure of [GUM-S1] 7.9.4.
///
/// `draw` gives one value of the result for one draw of all its inputs. The figures are those of
/// all trials: the mean and standard deviation ([GUM-S1] 7.6), the intervals from all values
/// sorted ([GUM-S1] 7.7). The same options and `draw` give the same bits. Not converged after
/// `trials_max` is a finding, told in the result. Failure (at "Monte Carlo propagation") for
/// options out of range, fewer trials than `blocks_min` blocks, or a value that is not finite.
MonteCarloResult propagate(const MonteCarloOptions& options,
                           const std::function<double(RandomGenerator&)>& draw);

/// The numerical tolerance of [GUM-S1] 7.9.2: with u = c 10^l, c an integer of so many digits,
/// 10^l / 2; 0 for u = 0. Failure where u is negative or not finite, or the digits not 1 to 15.
double numerical_tolerance(double standard_uncertainty, int significant_digits);

/// The probabilistically symmetric coverage interval of simulated values, sorted upwards
/// ([GUM-S1] 7.7). Failure where there are too few values for the probability.
CoverageInterval symmetric_interval(std::span<const double> sorted, double probability);

/// The shortest coverage interval of simulated values, sorted upwards ([GUM-S1] 7.7); the
/// lowest of equally short ones. Failure as of `symmetric_interval`.
CoverageInterval shortest_interval(std::span<const double> sorted, double probability);

/// Uniform in (-half_width, half_width).
double draw_rectangular(RandomGenerator& random, double half_width);

/// Student's t with degrees of freedom of 1 or more, an integer or not; standard normal where
/// empty. A quantity estimated by x with a standard uncertainty u of so many degrees of freedom is
/// x + u t ([GUM-S1] 6.4.9), whose standard deviation is above u: by sqrt(nu / (nu - 2)), and
/// infinite up to nu = 2.
///
/// By rejection from a Cauchy variate, itself the quotient of a point's coordinates in the unit
/// disc; at worst 1.52 of them for a value. The C library's logarithm decides on acceptance alone:
/// values are products of basic operations, and platforms part where a uniform number falls
/// within its last bits of the threshold. Failure where the degrees are below 1 or not finite.
double draw_student_t(RandomGenerator& random, std::optional<double> degrees_of_freedom);

}  // namespace runcert
