#include "stages/screen/stretch_tests.h"

#include <algorithm>
#include <cmath>

#include "core/statistics.h"

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
    template std::vector<double> local_variance_factors(const Chain<AXES>&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

namespace {

// An error that the data determine less well than this is not tested, because the vague prior
// would decide.
constexpr double largest_sigma_m = 20.0;
constexpr double largest_sigma_m_s = 20.0;
constexpr double largest_sigma_s = 1.0;
constexpr double largest_sigma_m_s2 = 5.0;
/// Fraction of the statistic that a manoeuvre must explain near another one. Hard motion
/// consists of several changes, and each explains only a part.
constexpr double share_of_hard_motion = 0.3;

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

template <int Size>
bool is_determined(const ScoreTest<Size>& test, double largest_sigma) {
    return test.covariance().trace() < Size * largest_sigma * largest_sigma;
}

}  // namespace

template <int Axes>
EstimatedError StretchTests<Axes>::estimate_of(const Candidate& candidate) const {
    if (candidate.manoeuvre) return {};
    switch (candidate.hypothesis) {
        case Hypothesis::outlier:
            return estimated_error(diagnosis_.outlier(candidate.first));
        case Hypothesis::step:
            return estimated_error(diagnosis_.step(candidate.first));
        case Hypothesis::ramp:
            return estimated_rate(diagnosis_.ramp(candidate.first));
        case Hypothesis::time_shift:
            return estimated_time(diagnosis_.time_shift(candidate.first).value());
        default:
            return {};  // each epoch of a burst has its own error, known once it is left out
    }
}

template <int Axes>
double StretchTests<Axes>::manoeuvre_of(const Candidate& candidate) const {
    return diagnosis_.manoeuvre(candidate.first).estimate().norm();
}

template <int Axes>
double StretchTests<Axes>::sigma_rate_of(const Candidate& candidate) const {
    if (candidate.hypothesis != Hypothesis::ramp) return 0.0;
    return std::sqrt(diagnosis_.ramp(candidate.first).covariance().trace());
}

template <int Axes>
std::vector<Candidate> StretchTests<Axes>::candidates() const {
    std::vector<Candidate> found;
    const auto& epochs = stretch_.epochs;
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        if (!epochs[k].measurement) continue;
        consider(diagnosis_.outlier(k), largest_sigma_m, Hypothesis::outlier, k, k, found);
        if (k == 0) continue;
        if (!epochs[k].step_before) {
            consider(diagnosis_.step(k), largest_sigma_m, Hypothesis::step, k, k, found);
            if constexpr (Axes == 2)
                if (const auto test = diagnosis_.time_shift(k))
                    consider(*test, largest_sigma_s, Hypothesis::time_shift, k, k, found);
        }
        consider(diagnosis_.ramp(k), largest_sigma_m_s, Hypothesis::ramp, k, k, found);
        consider_manoeuvre(k, found);
    }
    diagnosis_.for_each_burst(plan_.burst_epochs_max(), [&](std::size_t k, std::size_t length,
                                                            const ScoreTest<Axes>& test) {
        consider(test, largest_sigma_m, Hypothesis::burst, k, k + length - 1, found);
    });
    return found;
}

template <int Axes>
Candidate StretchTests<Axes>::best_explanation(const Candidate& candidate, bool hard) const {
    constexpr double share = 0.6;
    if (candidate.manoeuvre) return candidate;
    if (candidate.hypothesis != Hypothesis::outlier)
        if (const auto motion = motion_instead(
                candidate, (hard ? share_of_hard_motion : share) * candidate.statistic))
            return *motion;
    return best_set(candidate);
}

template <int Axes>
Candidate StretchTests<Axes>::explanation_of_span(const Candidate& span) const {
    constexpr double share = 0.2;
    const double excess = span.statistic - span.degrees_of_freedom;
    return motion_instead(span, share * excess).value_or(span);
}

/// The set of neighbouring epochs, each with its own error, that is better supported than the
/// candidate, or else the candidate itself. It grows from the candidate's epochs to whichever
/// side gains more.
template <int Axes>
Candidate StretchTests<Axes>::best_set(const Candidate& candidate) const {
    const double factor = factors_[candidate.first];
    Candidate best = set_of(candidate.first, candidate.last, factor);
    Candidate grown = best;
    // Growth may continue for a few steps without a gain, because a good epoch may lie between
    // two outliers.
    constexpr int patience = 3;
    for (int without_gain = 0; without_gain < patience;) {
        if (grown.last - grown.first + 1 >= plan_.burst_epochs_max()) break;
        std::optional<Candidate> next;
        if (grown.first > 0) next = set_of(grown.first - 1, grown.last, factor);
        if (grown.last + 1 < stretch_.epochs.size()) {
            const Candidate right = set_of(grown.first, grown.last + 1, factor);
            if (!next || right.log_tail < next->log_tail) next = right;
        }
        if (!next) break;
        grown = *next;
        without_gain = grown.log_tail < best.log_tail ? 0 : without_gain + 1;
        if (without_gain == 0) best = grown;
    }
    return best.log_tail < candidate.log_tail ? best : candidate;
}

template <int Axes>
std::optional<Candidate> StretchTests<Axes>::failing_span() const {
    for (const std::size_t length : span_lengths) {
        std::optional<Candidate> worst;
        double sum = 0.0;
        std::vector<std::pair<std::size_t, double>> window;  // epochs with an innovation
        std::size_t begin = 0;
        for (std::size_t k = 0; k < diagnosis_.size(); ++k) {
            const auto innovation = diagnosis_.innovation(k);
            if (!innovation) continue;
            window.emplace_back(k, *innovation / factors_[k]);
            sum += window.back().second;
            if (window.size() - begin > length) sum -= window[begin++].second;
            if (window.size() - begin < length) continue;
            const int degrees = static_cast<int>(length) * Axes;
            if (sum > plan_.critical(degrees) && (!worst || sum > worst->statistic))
                worst = Candidate{.log_tail = log_chi_squared_upper_tail(sum, degrees),
                                  .hypothesis = Hypothesis::model,
                                  .first = window[begin].first,
                                  .last = k,
                                  .statistic = sum,
                                  .degrees_of_freedom = degrees};
        }
        if (worst) return worst;
    }
    return std::nullopt;
}

template <int Axes>
template <int Size>
void StretchTests<Axes>::consider(const ScoreTest<Size>& test, double largest_sigma,
                                  Hypothesis hypothesis, std::size_t first, std::size_t last,
                                  std::vector<Candidate>& found) const {
    const double statistic = test.statistic() / factors_[first];
    if (!(statistic > plan_.critical(Size))) return;
    if (!is_determined(test, largest_sigma)) return;
    found.push_back({.log_tail = log_chi_squared_upper_tail(statistic, Size),
                     .hypothesis = hypothesis,
                     .first = first,
                     .last = last,
                     .statistic = statistic,
                     .degrees_of_freedom = Size});
}

/// Considers a manoeuvre, if it is no larger than a craft of the class can make.
template <int Axes>
void StretchTests<Axes>::consider_manoeuvre(std::size_t k, std::vector<Candidate>& found) const {
    if (plan_.manoeuvre_max_m_s2() <= 0.0) return;
    const ScoreTest<Axes> test = diagnosis_.manoeuvre(k);
    const std::size_t before = found.size();
    consider(test, largest_sigma_m_s2, Hypothesis::ramp, k, k, found);
    if (found.size() == before) return;
    if (test.estimate().norm() <= plan_.manoeuvre_max_m_s2())
        found.back().manoeuvre = true;
    else
        found.pop_back();
}

/// A manoeuvre near an error whose statistic exceeds `support`. Hard motion is never purely one
/// or the other. A real error remains visible after the manoeuvre is allowed for, whereas a
/// false drift takes the whole stretch with it.
template <int Axes>
std::optional<Candidate> StretchTests<Axes>::motion_instead(const Candidate& error,
                                                            double support) const {
    if (plan_.manoeuvre_max_m_s2() <= 0.0) return std::nullopt;
    const std::size_t reach = 2 * plan_.burst_epochs_max();
    const std::size_t end = std::min(stretch_.epochs.size(), error.first + reach + 1);
    std::optional<Candidate> best;
    for (std::size_t k = error.first > reach ? error.first - reach : 1; k < end; ++k) {
        if (!stretch_.epochs[k].measurement) continue;
        const ScoreTest<Axes> test = diagnosis_.manoeuvre(k);
        const double statistic = test.statistic() / factors_[k];
        if (!(statistic > support) || (best && statistic <= best->statistic)) continue;
        if (!is_determined(test, largest_sigma_m_s2) ||
            test.estimate().norm() > plan_.manoeuvre_max_m_s2())
            continue;
        best = Candidate{.log_tail = log_chi_squared_upper_tail(statistic, Axes),
                         .hypothesis = Hypothesis::ramp,
                         .manoeuvre = true,
                         .first = k,
                         .last = k,
                         .statistic = statistic,
                         .degrees_of_freedom = Axes};
    }
    return best;
}

template <int Axes>
Candidate StretchTests<Axes>::set_of(std::size_t first, std::size_t last,
                                     double variance_factor) const {
    const SetTest test = diagnosis_.own_errors(first, last);
    if (test.degrees_of_freedom == 0) return {.first = first, .last = last};
    const double statistic = test.statistic / variance_factor;
    return {.log_tail = log_chi_squared_upper_tail(statistic, test.degrees_of_freedom),
            .hypothesis = first == last ? Hypothesis::outlier : Hypothesis::burst,
            .first = first,
            .last = last,
            .statistic = statistic,
            .degrees_of_freedom = test.degrees_of_freedom};
}

template class StretchTests<1>;
template class StretchTests<2>;

}  // namespace runcert
