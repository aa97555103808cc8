#pragma once

#include <optional>
#include <span>
#include <vector>

namespace runcert {

/// The x with P(chi-squared <= x) = probability. Failure (at "statistics") unless
/// 0 <= probability < 1 and degrees_of_freedom >= 1. Relative accuracy 1e-13.
double chi_squared_quantile(double probability, int degrees_of_freedom);

/// The x with P(chi-squared > x) = tail_probability, accurate however small the tail. Failure
/// unless 0 < tail_probability <= 1 and degrees_of_freedom >= 1.
double chi_squared_upper_quantile(double tail_probability, int degrees_of_freedom);

/// ln P(chi-squared > x), accurate even where the probability itself underflows. Failure unless
/// x >= 0 and degrees_of_freedom >= 1. Relative accuracy 1e-9.
double log_chi_squared_upper_tail(double x, int degrees_of_freedom);

/// The non-centrality parameter at which a chi-squared test of size `test_size` rejects with
/// probability `power`. Failure unless 0 < test_size < power < 1 and degrees_of_freedom >= 1.
double noncentrality(double test_size, double power, int degrees_of_freedom);

/// The x with P(z <= x) = probability, z standard normal. Failure unless 0 < probability < 1.
double normal_quantile(double probability);

/// P(z <= x), z standard normal. Relative accuracy is kept in the lower tail.
double normal_cdf(double x);

/// P(t <= x) for Student's t distribution. The degrees of freedom are any number above 0, also
/// infinite; empty means infinite, the normal distribution. x may be infinite. Failure if x is
/// NaN or the degrees of freedom are not above 0. Relative accuracy 1e-11, kept in the lower tail.
double student_t_cdf(double x, std::optional<double> degrees_of_freedom);

/// The x with P(t <= x) = probability. Failure unless 0 < probability < 1 and the degrees of
/// freedom are above 0.
double student_t_quantile(double probability, std::optional<double> degrees_of_freedom);

/// Arithmetic mean, summed in order. Failure if there are no values.
double mean(std::span<const double> values);

/// Sample standard deviation, with divisor n - 1. Failure if there are fewer than two values.
double standard_deviation(std::span<const double> values);

/// Square root of the mean square. Failure if there are no values.
double root_mean_square(std::span<const double> values);

/// The middle value, or the mean of the two middle ones. Failure if there are no values or one
/// is NaN.
double median(std::vector<double> values);

/// The standard deviation of a white noise from the lengths of its differences, which have `gain`
/// times its variance (2 of first differences, 20 of third ones), by their median: robust. Failure
/// as of `median`.
double robust_sd(std::vector<double> absolute, double gain);

}  // namespace runcert
