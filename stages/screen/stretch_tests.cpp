#include "stages/screen/stretch_tests.h"

namespace runcert {

template <int Axes>
EstimatedError estimated_error(const ScoreTest<Axes>& test) {
    const auto estimate = test.estimate();
    const auto covariance = test.covariance();
    EstimatedError error;
    if constexpr (Axes == 1) {
        error.up_m = estimate(0);
        error.sigma_up_m = std::sqrt(covariance(0, 0));
    } else {
        error.east_m = estimate(0);
        error.north_m = estimate(1);
        error.sigma_east_m = std::sqrt(covariance(0, 0));
        error.sigma_north_m = std::sqrt(covariance(1, 1));
        error.correlation_east_north =
            covariance(0, 1) / std::sqrt(covariance(0, 0) * covariance(1, 1));
    }
    return error;
}

template <int Axes>
EstimatedError estimated_rate(const ScoreTest<Axes>& test) {
    const auto estimate = test.estimate();
    EstimatedError error;
    if constexpr (Axes == 1) {
        error.rate_up_m_s = estimate(0);
    } else {
        error.rate_east_m_s = estimate(0);
        error.rate_north_m_s = estimate(1);
    }
    return error;
}

EstimatedError estimated_time(const ScoreTest<1>& test) {
    EstimatedError error;
    error.time_s = test.estimate()(0);
    return error;
}

template <int Axes>
std::vector<double> local_variance_factors(const Chain<Axes>& diagnosis) {
    constexpr std::size_t fewest = 30;
    constexpr std::size_t local_epochs = 100;  // on each side
    const double expected = chi_squared_quantile(0.5, Axes);
    std::vector<double> statistics;
    std::vector<std::size_t> before;          // number of statistics up to each epoch
    std::vector<std::size_t> as_expected{0};  // number of statistics up to each that are no larger
                                              // than expected
    for (std::size_t k = 0; k < diagnosis.size(); ++k) {
        before.push_back(statistics.size());
        const auto innovation = diagnosis.innovation(k);
        if (!innovation) continue;
        statistics.push_back(*innovation);
        as_expected.push_back(as_expected.back() + (*innovation <= expected ? 1 : 0));
    }
    std::vector<double> factors(diagnosis.size(), 1.0);
    if (statistics.size() < fewest) return factors;
    std::vector<double> some;
    // The variance factor of consecutive statistics, at least 1: their median over the expected
    // one. The median is computed only where it exceeds the expected one.
    const auto factor_of = [&](std::size_t first, std::size_t last) {
        const std::size_t half = (last - first) / 2;
        if (as_expected[last] - as_expected[first] > half) return 1.0;
        some.assign(statistics.begin() + static_cast<std::ptrdiff_t>(first),
                    statistics.begin() + static_cast<std::ptrdiff_t>(last));
        const auto at = some.begin() + static_cast<std::ptrdiff_t>(half);
        std::nth_element(some.begin(), at, some.end());
        return std::max(1.0, *at / expected);
    };
    // Changes slowly, so every tenth epoch suffices.
    constexpr std::size_t every = 10;
    double factor = 1.0;
    for (std::size_t k = 0; k < diagnosis.size(); ++k) {
        if (k % every == 0) {
            const std::size_t middle = std::min(before[k], statistics.size() - 1);
            const std::size_t first = middle < local_epochs ? 0 : middle - local_epochs;
            const std::size_t last = std::min(statistics.size(), middle + local_epochs + 1);
            factor = factor_of(first, last);
            // Where the noise level changes, the surroundings of the epoch are a mixture of both
            // levels.
            if (middle - first >= fewest && last - middle >= fewest) {
                const double of_those_before = factor_of(first, middle);
                const double of_those_after = factor_of(middle, last);
                const auto [less, more] = std::minmax(of_those_before, of_those_after);
                if (more > 2.0 * less) factor = more;
            }
        }
        factors[k] = factor;
    }
    return factors;
}

#define RUNCERT_INSTANTIATE(AXES)                                    \
    template EstimatedError estimated_error(const ScoreTest<AXES>&); \
    template EstimatedError estimated_rate(const ScoreTest<AXES>&);  \
    template std::vector<double> local_variance_factors(const Chain<AXES>&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
