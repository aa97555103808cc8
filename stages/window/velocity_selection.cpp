#include "stages/window/velocity_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "core/parallel.h"
#include "core/random.h"
#include "core/statistics.h"
#include "stages/window/best_window_sums.h"

namespace runcert {
namespace {

/// The memory of receivers' filters.
constexpr double brief_tau_s = 0.5;
constexpr double slow_tau_min_s = 5.0;
constexpr double slow_tau_max_s = 60.0;

/// A window, by the indices of its samples among all that are drawn.
struct Candidate {
    std::size_t first = 0, last = 0;
    double assured_m_s = 0.0;
    std::size_t leg = 0;  ///< windows of one leg overlap one another, or a window between
};

/// All candidates, and their samples in order of time.
struct Search {
    std::vector<double> time_s;
    std::vector<Candidate> candidates;
    std::size_t chosen = 0;
};

bool same(const FoundWindow& one, const FoundWindow& other) {
    return one.series == other.series && one.start == other.start && one.end == other.end;
}

Search search_of(const std::vector<std::vector<ElapsedTime>>& times,
                 const std::vector<FoundWindow>& all, const FoundWindow& chosen, double reach_m_s) {
    std::vector<FoundWindow> near{chosen};
    for (const FoundWindow& window : all)
        if (window.assured_m_s() >= chosen.assured_m_s() - reach_m_s && !same(window, chosen))
            near.push_back(window);
    std::ranges::sort(near, {}, [](const FoundWindow& window) {
        return std::tuple(window.series, window.first, window.last, window.start, window.end);
    });
    Search search;
    std::size_t series = 0, next = 0, leg = 0;
    for (const FoundWindow& window : near) {
        if (window.series != series) next = 0;
        series = window.series;
        if (!search.candidates.empty() && window.first >= next) ++leg;
        // Samples of the series before `next` are already present, the last of them at the end.
        for (std::size_t k = std::max(next, window.first); k <= window.last; ++k)
            search.time_s.push_back(times[series][k].seconds());
        next = std::max(next, window.last + 1);
        const std::size_t end = search.time_s.size() - (next - window.last);
        if (same(window, chosen)) search.chosen = search.candidates.size();
        search.candidates.push_back({.first = end - (window.last - window.first),
                                     .last = end,
                                     .assured_m_s = window.assured_m_s(),
                                     .leg = leg});
    }
    return search;
}

/// Adds samples of a first-order Gauss-Markov process.
void add_gauss_markov(const std::vector<double>& time_s, double sigma, double tau_s,
                      const double* normals, std::vector<double>& errors) {
    double value = 0.0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const double kept = k > 0 ? std::exp(-std::abs(time_s[k] - time_s[k - 1]) / tau_s) : 0.0;
        value = kept * value + std::sqrt(1.0 - kept * kept) * normals[k];
        errors[k] += sigma * value;
    }
}

/// The error of each candidate's speed.
std::vector<double> window_errors(const Search& search, SpeedDefinition definition,
                                  const std::vector<double>& errors) {
    SpeedSums sums;
    double path_m = 0.0, sum_m_s = 0.0;
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (k > 0)
            path_m += 0.5 * (search.time_s[k] - search.time_s[k - 1]) * (errors[k] + errors[k - 1]);
        sums.path_m.push_back(path_m);
        sums.speeds_m_s.push_back(sum_m_s += errors[k]);
    }
    std::vector<double> of_windows;
    for (const auto& [first, last, assured, leg] : search.candidates)
        of_windows.push_back(
            sums.speed_m_s({first, last}, search.time_s[last] - search.time_s[first], definition));
    return of_windows;
}

/// The assured speeds with the legs drawn together, as far as errors of this variance explain why
/// their fastest windows differ: so would errors that are drawn onto them make legs like those
/// recorded.
std::vector<double> drawn_together(const Search& search, std::vector<double> assured_m_s,
                                   double variance) {
    constexpr std::size_t fewest = 3;
    std::vector<double> fastest;
    for (std::size_t i = 0; i < assured_m_s.size(); ++i)
        if (search.candidates[i].leg < fastest.size())
            fastest.back() = std::max(fastest.back(), assured_m_s[i]);
        else
            fastest.push_back(assured_m_s[i]);
    if (fastest.size() < fewest) return assured_m_s;
    const double middle_m_s = mean(fastest);
    const double spread = std::pow(standard_deviation(fastest), 2);
    const double explained =
        spread > 0.0 ? 1.0 - std::sqrt(std::max(0.0, 1.0 - variance / spread)) : 0.0;
    for (std::size_t i = 0; i < assured_m_s.size(); ++i)
        assured_m_s[i] -= explained * (fastest[search.candidates[i].leg] - middle_m_s);
    return assured_m_s;
}

/// How much more errors add to the speed of the window that is the fastest with them than to the
/// chosen one. The mean is the same as without that comparison, and converges with fewer draws.
double gained(const Search& search, const std::vector<double>& assured_m_s,
              const std::vector<double>& errors) {
    std::size_t best = search.chosen;
    for (std::size_t i = 0; i < errors.size(); ++i)
        if (assured_m_s[i] + errors[i] > assured_m_s[best] + errors[best]) best = i;
    return errors[best] - errors[search.chosen];
}

/// The speeds of the candidates as errors of this variance leave them likely.
struct Likely {
    double variance = 0.0;
    std::vector<double> assured_m_s;

    Likely(const Search& search, double of_mean_m_s) : variance(of_mean_m_s * of_mean_m_s) {
        for (const Candidate& one : search.candidates)
            assured_m_s.push_back(one.assured_m_s);
        assured_m_s = drawn_together(search, std::move(assured_m_s), variance);
    }

    /// Once with these speeds, and once with errors drawn onto them before.
    double calibrated(const Search& search, const std::vector<double>& before,
                      const std::vector<double>& errors) const {
        std::vector<double> again = assured_m_s;
        for (std::size_t i = 0; i < before.size(); ++i)
            again[i] += before[i];
        return 2.0 * gained(search, assured_m_s, errors) -
               gained(search, drawn_together(search, std::move(again), variance), errors);
    }
};

struct Draw {
    double white_m_s = 0.0, all_m_s = 0.0;
};

/// Both kinds of errors, with the speeds that each leaves likely.
struct BothLikely {
    Likely white, all;
};

Draw draw_from(const Search& search, const BothLikely& likely, SpeedDefinition definition,
               const DrawnSpeedErrors& errors, double brief_sd_m_s, double slow_tau_s,
               const std::vector<double>& normals) {
    const std::size_t count = search.time_s.size();
    std::array<std::vector<double>, 2> white, all;
    for (std::size_t i = 0; i < 2; ++i) {
        const double* const at = normals.data() + 3 * count * i;
        std::vector<double> samples(count);
        for (std::size_t k = 0; k < count; ++k)
            samples[k] = errors.white_m_s * at[k];
        white[i] = window_errors(search, definition, samples);
        add_gauss_markov(search.time_s, brief_sd_m_s, brief_tau_s, at + count, samples);
        add_gauss_markov(search.time_s, errors.slow_m_s, slow_tau_s, at + 2 * count, samples);
        all[i] = window_errors(search, definition, samples);
    }
    return {.white_m_s = likely.white.calibrated(search, white[0], white[1]),
            .all_m_s = likely.all.calibrated(search, all[0], all[1])};
}

}  // namespace

double gauss_markov_mean_sd(std::size_t samples, double step_s, double tau_s) {
    const auto count = static_cast<double>(samples);
    double variance = count;
    for (std::size_t k = 1; k < samples; ++k)
        variance += 2.0 * (count - static_cast<double>(k)) *
                    std::exp(-static_cast<double>(k) * step_s / tau_s);
    return std::sqrt(variance) / count;
}

SpeedChoiceBias speed_choice_bias(const std::vector<std::vector<ElapsedTime>>& times,
                                  const std::vector<FoundWindow>& all, const FoundWindow& chosen,
                                  SpeedDefinition definition, const DrawnSpeedErrors& errors,
                                  double reach_m_s, std::int64_t samples, std::int64_t seed) {
    constexpr std::int64_t most_numbers = 4'000'000;
    constexpr std::int64_t fewest_draws = 100;
    const Search search = search_of(times, all, chosen, reach_m_s);
    SpeedChoiceBias bias{.candidates = std::ssize(search.candidates)};
    if (search.candidates.size() < 2) return bias;
    const auto steps = static_cast<double>(chosen.last - chosen.first);
    const double step_s = chosen.duration_s() / steps;
    const double brief_sd_m_s =
        errors.brief_m_s / gauss_markov_mean_sd(chosen.last - chosen.first, step_s, brief_tau_s);
    const std::size_t numbers = 6 * search.time_s.size();
    const std::int64_t draws = std::min(
        samples,
        std::max(fewest_draws, most_numbers / static_cast<std::int64_t>(search.time_s.size())));
    const double mean_white_m_s = errors.white_m_s / std::sqrt(steps);
    const BothLikely likely{
        .white = Likely(search, mean_white_m_s),
        .all = Likely(search, std::hypot(mean_white_m_s, errors.brief_m_s, errors.slow_m_s))};
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    Turnstile turnstile;
    const std::vector<Draw> drawn = results_of(draws, threads_allowed(), [&](std::int64_t i) {
        const auto normals = turnstile.pass(i, [&] { return random.normals(numbers); });
        const double slow_tau_s =
            slow_tau_min_s * std::pow(slow_tau_max_s / slow_tau_min_s,
                                      (static_cast<double>(i) + 0.5) / static_cast<double>(draws));
        return draw_from(search, likely, definition, errors, brief_sd_m_s, slow_tau_s, normals);
    });
    std::vector<double> white, every;
    for (const Draw& one : drawn) {
        white.push_back(one.white_m_s);
        every.push_back(one.all_m_s);
    }
    bias.least_m_s = std::max(0.0, mean(white));
    bias.most_m_s = std::max(bias.least_m_s, mean(every));
    bias.uncertainty_m_s = standard_deviation(every) / std::sqrt(static_cast<double>(draws));
    return bias;
}

}  // namespace runcert
