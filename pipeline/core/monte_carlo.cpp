#include "core/monte_carlo.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "core/failure.h"
#include "core/statistics.h"

namespace runcert {

namespace {

constexpr int kDigitsMost = 15;

[[noreturn]] void fail_propagation(const std::string& what, const char* remedy) {
    throw Failure("Monte Carlo propagation", what, remedy);
}

void require_probability(double probability) {
    if (!(probability > 0.0 && probability < 1.0))
        fail_propagation(fmt::format("the coverage probability {} is not in (0, 1)", probability),
                         "Give a probability such as 0.95");
}

void require_digits(int significant_digits) {
    if (significant_digits < 1 || significant_digits > kDigitsMost)
        fail_propagation(fmt::format("{} significant digits", significant_digits), "Give 1 or 2");
}

/// [GUM-S1] 7.9.4 b): fewer would leave too few values beyond the ends of the interval.
std::int64_t block_size(const MonteCarloOptions& options) {
    // Capped, because a probability near 1 would exceed the type's range.
    const double least = std::min(std::ceil(100.0 / (1.0 - options.probability)), 0x1p62);
    return std::max(options.block, static_cast<std::int64_t>(least));
}

void require_options(const MonteCarloOptions& options) {
    require_probability(options.probability);
    require_digits(options.significant_digits);
    if (options.block < 1 || options.blocks_min < 2)
        fail_propagation(fmt::format("{} trials in a block and at least {} blocks", options.block,
                                     options.blocks_min),
                         "Give 1 trial and 2 blocks or more");
    if (!(options.tolerance_fraction > 0.0 && options.tolerance_fraction <= 1.0))
        fail_propagation(fmt::format("the fraction {} of the tolerance is not in (0, 1]",
                                     options.tolerance_fraction),
                         "Give 1, or 0.2 to judge the law of propagation of uncertainty");
    if (options.trials_max / block_size(options) < options.blocks_min)
        fail_propagation(fmt::format("at most {} trials, which is less than {} blocks of {}",
                                     options.trials_max, options.blocks_min, block_size(options)),
                         "Allow more trials");
}

/// Number of values between the ends of an interval ([GUM-S1] 7.7).
std::size_t interval_span(std::size_t count, double probability) {
    require_probability(probability);
    const double span = std::floor(probability * static_cast<double>(count) + 0.5);
    if (!(span >= 1.0 && span < static_cast<double>(count)))
        fail_propagation(fmt::format("{} values are too few for an interval of probability {}",
                                     count, probability),
                         "Simulate more values");
    return static_cast<std::size_t>(span);
}

/// Index at which the symmetric interval begins among the sorted values. The standard's r counts
/// from 1.
std::size_t first_of_symmetric(std::size_t count, std::size_t span) {
    return (count - span + 1) / 2 - 1;
}

/// The four figures of each block, [GUM-S1] 7.9.4 e).
struct BlockFigures {
    std::vector<double> mean;
    std::vector<double> standard_uncertainty;
    std::vector<double> lower;
    std::vector<double> upper;
};

/// Sorts partially: both ends of every coverage interval of this probability are where a full
/// ascending sort would put them. Only values between the spans of the lowest and of the highest
/// such interval may be out of place.
void sort_ends(std::vector<double>& values, double probability) {
    const std::size_t span = interval_span(values.size(), probability);
    const std::size_t beyond = values.size() - span;
    if (beyond >= span) {
        std::sort(values.begin(), values.end());
        return;
    }
    const auto lower = values.begin() + static_cast<std::ptrdiff_t>(beyond);
    const auto upper = values.begin() + static_cast<std::ptrdiff_t>(span);
    std::nth_element(values.begin(), lower, values.end());
    std::nth_element(lower, upper, values.end());
    std::sort(values.begin(), lower);
    std::sort(upper, values.end());
}

/// Means and deviations are taken from `origin`, a value of the distribution. A large result with a
/// small spread then keeps its digits, and one without any spread has exactly none.
void add_block(BlockFigures& figures, std::vector<double> values, double origin,
               double probability) {
    for (double& value : values)
        value -= origin;
    figures.mean.push_back(mean(values));
    figures.standard_uncertainty.push_back(standard_deviation(values));
    const std::size_t span = interval_span(values.size(), probability);
    const std::size_t first = first_of_symmetric(values.size(), span);
    const auto lower = values.begin() + static_cast<std::ptrdiff_t>(first);
    const auto upper = lower + static_cast<std::ptrdiff_t>(span);
    std::nth_element(values.begin(), lower, values.end());
    std::nth_element(lower + 1, upper, values.end());
    figures.lower.push_back(*lower);
    figures.upper.push_back(*upper);
}

/// Standard deviation of all values, from the pooled squares within and between the blocks.
double overall_uncertainty(const BlockFigures& figures, std::int64_t block) {
    const double size = static_cast<double>(block);
    const double count = static_cast<double>(figures.mean.size());
    const double within = root_mean_square(figures.standard_uncertainty);
    const double between = standard_deviation(figures.mean);
    const double squares =
        count * (size - 1.0) * within * within + size * (count - 1.0) * between * between;
    return std::sqrt(squares / (count * size - 1.0));
}

/// [GUM-S1] 7.9.4 g) to l).
bool stable(const BlockFigures& figures, double limit) {
    const double root = std::sqrt(static_cast<double>(figures.mean.size()));
    for (const std::vector<double>* figure :
         {&figures.mean, &figures.standard_uncertainty, &figures.lower, &figures.upper})
        if (!(2.0 * standard_deviation(*figure) / root <= limit)) return false;
    return true;
}

/// Whether a Cauchy variate with this square is accepted as a Student's t variate by a uniform
/// number.
bool accepts_student_t(double square, double nu, double uniform) {
    // The quotient of the densities, (1 + t^2) (1 + t^2 / nu)^(-(nu + 1) / 2), is largest at t = 1.
    // Two logarithms replace four wherever their rounding cannot change the decision.
    const double of_cauchy = std::log((1.0 + square) / (2.0 * uniform));
    const double of_t = (nu + 1.0) / 2.0 * std::log((nu + square) / (nu + 1.0));
    const double rounding = 1e-13 * (nu + std::abs(of_cauchy) + std::abs(of_t));
    if (std::abs(of_cauchy - of_t) > rounding) return of_cauchy > of_t;
    const double log_acceptance =
        std::log((1.0 + square) / 2.0) -
        (nu + 1.0) / 2.0 * (std::log1p(square / nu) - std::log1p(1.0 / nu));
    return std::log(uniform) <= log_acceptance;
}

std::vector<double> draw_block(RandomGenerator& random, std::int64_t block,
                               const std::function<double(RandomGenerator&)>& draw) {
    std::vector<double> values(static_cast<std::size_t>(block));
    for (double& value : values) {
        value = draw(random);
        if (!std::isfinite(value))
            fail_propagation(fmt::format("a simulated result is {}", value),
                             "Limit the inputs to values that the model has a result for");
    }
    return values;
}

}  // namespace

MonteCarloResult propagate(const MonteCarloOptions& options,
                           const std::function<double(RandomGenerator&)>& draw) {
    require_options(options);
    const std::int64_t block = block_size(options);
    RandomGenerator random(options.seed);
    MonteCarloResult result;
    BlockFigures figures;
    std::vector<double> all;
    while (!result.converged && result.trials + block <= options.trials_max) {
        std::vector<double> values = draw_block(random, block, draw);
        all.insert(all.end(), values.begin(), values.end());
        add_block(figures, std::move(values), all.front(), options.probability);
        result.trials += block;
        if (result.trials < options.blocks_min * block) continue;
        result.standard_uncertainty = overall_uncertainty(figures, block);
        result.tolerance =
            numerical_tolerance(result.standard_uncertainty, options.significant_digits);
        result.converged = stable(figures, options.tolerance_fraction * result.tolerance);
    }
    result.mean = all.front() + mean(figures.mean);
    sort_ends(all, options.probability);
    result.symmetric = symmetric_interval(all, options.probability);
    result.shortest = shortest_interval(all, options.probability);
    return result;
}

double numerical_tolerance(double standard_uncertainty, int significant_digits) {
    require_digits(significant_digits);
    if (!(standard_uncertainty >= 0.0 && std::isfinite(standard_uncertainty)))
        fail_propagation(fmt::format("the standard uncertainty is {}", standard_uncertainty),
                         "Give a finite number, 0 or more");
    if (standard_uncertainty == 0.0) return 0.0;
    // Rounded in decimal, as a reader would: 0.0996 to two digits is 10 x 10^-2.
    const std::string rounded =
        fmt::format("{:.{}e}", standard_uncertainty, significant_digits - 1);
    const int exponent = std::stoi(rounded.substr(rounded.find('e') + 1));
    const std::string half_unit = fmt::format("5e{}", exponent - significant_digits);
    double tolerance = 0.0;
    std::from_chars(half_unit.data(), half_unit.data() + half_unit.size(), tolerance);
    return tolerance;
}

CoverageInterval symmetric_interval(std::span<const double> sorted, double probability) {
    const std::size_t span = interval_span(sorted.size(), probability);
    const std::size_t first = first_of_symmetric(sorted.size(), span);
    return {sorted[first], sorted[first + span]};
}

CoverageInterval shortest_interval(std::span<const double> sorted, double probability) {
    const std::size_t span = interval_span(sorted.size(), probability);
    std::size_t best = 0;
    for (std::size_t first = 1; first + span < sorted.size(); ++first)
        if (sorted[first + span] - sorted[first] < sorted[best + span] - sorted[best]) best = first;
    return {sorted[best], sorted[best + span]};
}

double draw_rectangular(RandomGenerator& random, double half_width) {
    return half_width * (2.0 * random.uniform() - 1.0);
}

double draw_student_t(RandomGenerator& random, std::optional<double> degrees_of_freedom) {
    if (!degrees_of_freedom) return random.normal();
    const double nu = *degrees_of_freedom;
    if (!(nu >= 1.0 && std::isfinite(nu)))
        fail_propagation(fmt::format("{} degrees of freedom", nu),
                         "Give a finite number of 1 or more, or none for infinitely many");
    while (true) {
        const double x = 2.0 * random.uniform() - 1.0;
        const double y = 2.0 * random.uniform() - 1.0;
        if (x * x + y * y >= 1.0 || y == 0.0) continue;
        const double cauchy = x / y;
        const double square = cauchy * cauchy;
        if (accepts_student_t(square, nu, random.uniform())) return cauchy;
    }
}

}  // namespace runcert
