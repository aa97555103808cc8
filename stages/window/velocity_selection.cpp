#include "stages/window/velocity_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "core/random.h"
#include "stages/window/best_window_sums.h"

namespace runcert {
namespace {

/// The memory of receivers' filters.
constexpr double brief_tau_s = 0.5;
constexpr double slow_tau_min_s = 5.0;
constexpr double slow_tau_max_s = 60.0;

/// The samples of all legs, in order of time, and the windows by indices into them.
struct DrawnSamples {
    std::vector<double> time_s;
    std::vector<EpochPair> windows;
    Rivals rivals;

    double duration_s(EpochPair window) const { return time_s[window.last] - time_s[window.first]; }
};

DrawnSamples samples_of(const std::vector<std::vector<ElapsedTime>>& times,
                        const std::vector<WindowLeg>& legs) {
    DrawnSamples drawn;
    Rivals& rivals = drawn.rivals;
    for (std::size_t leg = 0; leg < legs.size(); ++leg) {
        const auto& [windows, chosen] = legs[leg];
        const std::size_t before = drawn.time_s.size();
        const std::size_t first = windows.front().first;
        const std::size_t last = std::ranges::max(windows, {}, &FoundWindow::last).last;
        for (std::size_t k = first; k <= last; ++k)
            drawn.time_s.push_back(times[legs[leg].series()][k].seconds());
        if (chosen) rivals.chosen = rivals.size() + *chosen;
        for (const FoundWindow& window : windows) {
            drawn.windows.push_back({before + window.first - first, before + window.last - first});
            rivals.velocities_m_s.push_back(window.speed_m_s);
            rivals.allowances_m_s.push_back(window.allowance_m_s);
            rivals.legs.push_back(leg);
        }
    }
    return drawn;
}

/// Adds samples of a first-order Gauss-Markov process.
void add_gauss_markov(const std::vector<double>& time_s, double sigma, double tau_s,
                      const double* normals, std::vector<double>& errors) {
    double value = 0.0;
    for (std::size_t k = 0; k < time_s.size(); ++k) {
        const double correlation =
            k > 0 ? std::exp(-std::abs(time_s[k] - time_s[k - 1]) / tau_s) : 0.0;
        value = correlation * value + std::sqrt(1.0 - correlation * correlation) * normals[k];
        errors[k] += sigma * value;
    }
}

/// The error of each window's speed.
Eigen::VectorXd window_errors(const DrawnSamples& drawn, SpeedDefinition definition,
                              const std::vector<double>& errors) {
    SpeedSums sums;
    double path_m = 0.0, sum_m_s = 0.0;
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (k > 0)
            path_m += 0.5 * (drawn.time_s[k] - drawn.time_s[k - 1]) * (errors[k] + errors[k - 1]);
        sums.path_m.push_back(path_m);
        sums.speeds_m_s.push_back(sum_m_s += errors[k]);
    }
    Eigen::VectorXd of_windows(std::ssize(drawn.windows));
    for (std::size_t w = 0; w < drawn.windows.size(); ++w)
        of_windows(static_cast<Eigen::Index>(w)) =
            sums.speed_m_s(drawn.windows[w], drawn.duration_s(drawn.windows[w]), definition);
    return of_windows;
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

SelectionBias speed_choice_bias(const std::vector<std::vector<ElapsedTime>>& times,
                                const std::vector<WindowLeg>& legs, SpeedDefinition definition,
                                const DrawnSpeedErrors& errors, std::int64_t samples,
                                std::int64_t seed) {
    constexpr std::int64_t most_numbers = 4'000'000;
    constexpr std::int64_t fewest_draws = 100;
    const DrawnSamples drawn = samples_of(times, legs);
    const std::int64_t candidates = std::ssize(drawn.windows);
    if (candidates < 2) return {.candidates = candidates, .samples = samples, .seed = seed};
    const EpochPair chosen = drawn.windows[drawn.rivals.chosen];
    const auto steps = static_cast<double>(chosen.last - chosen.first);
    const double brief_sd_m_s =
        errors.brief_m_s / gauss_markov_mean_sd(chosen.last - chosen.first,
                                                drawn.duration_s(chosen) / steps, brief_tau_s);
    const std::size_t count = drawn.time_s.size();
    const std::int64_t draws =
        std::min(samples, std::max(fewest_draws, most_numbers / static_cast<std::int64_t>(count)));
    const double mean_white_m_s = errors.white_m_s / std::sqrt(steps);
    const ChoiceSimulation white(drawn.rivals, mean_white_m_s);
    const ChoiceSimulation all(drawn.rivals,
                               std::hypot(mean_white_m_s, errors.brief_m_s, errors.slow_m_s));
    RandomGenerator random(static_cast<std::uint64_t>(seed));
    Turnstile turnstile;
    const auto both = results_of(draws, threads_allowed(), [&](std::int64_t i) {
        const auto normals = turnstile.pass(i, [&] { return random.normals(6 * count); });
        const double slow_tau_s =
            slow_tau_min_s * std::pow(slow_tau_max_s / slow_tau_min_s,
                                      (static_cast<double>(i) + 0.5) / static_cast<double>(draws));
        std::array<Eigen::VectorXd, 2> of_white, of_all;
        for (std::size_t twice = 0; twice < 2; ++twice) {
            const double* const at = normals.data() + 3 * count * twice;
            std::vector<double> of_samples(count);
            for (std::size_t k = 0; k < count; ++k)
                of_samples[k] = errors.white_m_s * at[k];
            of_white[twice] = window_errors(drawn, definition, of_samples);
            add_gauss_markov(drawn.time_s, brief_sd_m_s, brief_tau_s, at + count, of_samples);
            add_gauss_markov(drawn.time_s, errors.slow_m_s, slow_tau_s, at + 2 * count, of_samples);
            of_all[twice] = window_errors(drawn, definition, of_samples);
        }
        return std::pair(white(of_white[1], of_white[0]), all(of_all[1], of_all[0]));
    });
    std::vector<SimulatedChoice> least, most;
    for (const auto& [of_white, of_all] : both) {
        least.push_back(of_white);
        most.push_back(of_all);
    }
    SelectionBias bias = bias_between(least, most, errors.combined_m_s);
    bias.candidates = candidates;
    bias.seed = seed;
    return bias;
}

}  // namespace runcert
