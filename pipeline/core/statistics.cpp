#include "core/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <boost/math/special_functions/erf.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "core/failure.h"

namespace runcert {

namespace {

[[noreturn]] void fail_statistics(const std::string& what, const char* remedy) {
    throw Failure("statistics", what, remedy);
}

void require_degrees(int degrees_of_freedom) {
    if (degrees_of_freedom < 1)
        fail_statistics(fmt::format("{} degrees of freedom", degrees_of_freedom), "Give 1 or more");
}

bool is_normal(const std::optional<double>& degrees_of_freedom) {
    if (!degrees_of_freedom) return true;
    if (!(*degrees_of_freedom > 0.0))
        fail_statistics(fmt::format("{} degrees of freedom", *degrees_of_freedom),
                        "Give a number above 0, or none for infinitely many");
    return std::isinf(*degrees_of_freedom);
}

void require_count(std::size_t count, std::size_t least) {
    if (count < least)
        fail_statistics(fmt::format("{} values, at least {} required", count, least),
                        "Give a longer stretch of data");
}

}  // namespace

double chi_squared_quantile(double probability, int degrees_of_freedom) {
    require_degrees(degrees_of_freedom);
    if (!(probability >= 0.0 && probability < 1.0))
        fail_statistics(fmt::format("the probability {} is not in [0, 1)", probability),
                        "Give a probability below 1");
    return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

double chi_squared_upper_quantile(double tail_probability, int degrees_of_freedom) {
    require_degrees(degrees_of_freedom);
    if (!(tail_probability > 0.0 && tail_probability <= 1.0))
        fail_statistics(fmt::format("the tail probability {} is not in (0, 1]", tail_probability),
                        "Give a probability above 0");
    return boost::math::quantile(
        boost::math::complement(boost::math::chi_squared(degrees_of_freedom), tail_probability));
}

double log_chi_squared_upper_tail(double x, int degrees_of_freedom) {
    require_degrees(degrees_of_freedom);
    if (!(x >= 0.0))
        fail_statistics(fmt::format("the value {} is not 0 or more", x), "Give a sum of squares");
    const double a = 0.5 * degrees_of_freedom;
    const double z = 0.5 * x;
    constexpr double series_from = 600.0;
    // Closed forms for the most frequent degrees of freedom: Q(1, z) = exp(-z) and
    // Q(1/2, z) = erfc(sqrt(z)), Abramowitz & Stegun 6.5.17.
    if (degrees_of_freedom == 2) return -z;
    if (degrees_of_freedom == 1 && z < series_from) return std::log(std::erfc(std::sqrt(z)));
    if (z < std::max(series_from, 10.0 * a)) return std::log(boost::math::gamma_q(a, z));
    // Gamma(a, z) = z^(a-1) exp(-z) (1 + (a-1)/z + (a-1)(a-2)/z^2 + ...), Abramowitz & Stegun
    // 6.5.32. Here its terms fall by a factor of ten or more.
    double term = 1.0;
    double sum = 1.0;
    for (int n = 1; n < 20; ++n) {
        term *= (a - n) / z;
        sum += term;
    }
    return (a - 1.0) * std::log(z) - z - std::lgamma(a) + std::log(sum);
}

double noncentrality(double test_size, double power, int degrees_of_freedom) {
    if (!(test_size > 0.0 && test_size < power && power < 1.0))
        fail_statistics(fmt::format("a test of size {} cannot have the power {}", test_size, power),
                        "Give a size above 0 and a power between the size and 1");
    const double critical = chi_squared_upper_quantile(test_size, degrees_of_freedom);
    return boost::math::non_central_chi_squared::find_non_centrality(
        boost::math::complement(static_cast<double>(degrees_of_freedom), critical, power));
}

double normal_quantile(double probability) {
    if (!(probability > 0.0 && probability < 1.0))
        fail_statistics(fmt::format("the probability {} is not in (0, 1)", probability),
                        "Give a probability between 0 and 1");
    return -std::numbers::sqrt2 * boost::math::erfc_inv(2.0 * probability);
}

double normal_cdf(double x) {
    return 0.5 * std::erfc(-x / std::numbers::sqrt2);
}

double student_t_cdf(double x, std::optional<double> degrees_of_freedom) {
    const bool normal = is_normal(degrees_of_freedom);
    if (std::isnan(x)) fail_statistics("the value is not a number", "Leave out missing values");
    if (normal || std::isinf(x)) return normal_cdf(x);
    return boost::math::cdf(boost::math::students_t(*degrees_of_freedom), x);
}

double student_t_quantile(double probability, std::optional<double> degrees_of_freedom) {
    if (is_normal(degrees_of_freedom)) return normal_quantile(probability);
    if (!(probability > 0.0 && probability < 1.0))
        fail_statistics(fmt::format("the probability {} is not in (0, 1)", probability),
                        "Give a probability between 0 and 1");
    return boost::math::quantile(boost::math::students_t(*degrees_of_freedom), probability);
}

double mean(std::span<const double> values) {
    require_count(values.size(), 1);
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

double standard_deviation(std::span<const double> values) {
    require_count(values.size(), 2);
    const double centre = mean(values);
    double sum = 0.0;
    for (const double value : values)
        sum += (value - centre) * (value - centre);
    return std::sqrt(sum / static_cast<double>(values.size() - 1));
}

double root_mean_square(std::span<const double> values) {
    require_count(values.size(), 1);
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

double median(std::vector<double> values) {
    require_count(values.size(), 1);
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::isnan(v); }))
        fail_statistics("a value is not a number", "Leave out missing values");
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2 == 1) return *middle;
    return 0.5 * *std::max_element(values.begin(), middle) + 0.5 * *middle;
}

double robust_sd(std::vector<double> absolute, double gain) {
    return median(std::move(absolute)) / (normal_quantile(0.75) * std::sqrt(gain));
}

}  // namespace runcert
