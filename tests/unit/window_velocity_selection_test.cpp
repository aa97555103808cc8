#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/random.h"
#include "core/statistics.h"
#include "stages/window/velocity_selection.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Two arcs of an hour at 10 Hz, one after the other.
std::vector<std::vector<ElapsedTime>> times() {
    std::vector<std::vector<ElapsedTime>> all(2);
    for (std::int64_t k = 0; k < 72'000; ++k)
        all[k < 36'000 ? 0 : 1].push_back({k * 100'000'000});
    return all;
}

FoundWindow window_at(std::size_t series, std::size_t first, double speed_m_s,
                      std::size_t samples = 20) {
    FoundWindow window;
    window.series = series;
    window.first = first;
    window.last = first + samples;
    const auto at = [&](std::size_t k) {
        return ElapsedTime{static_cast<std::int64_t>(k + 36'000 * series) * 100'000'000};
    };
    window.start = at(window.first);
    window.end = at(window.last);
    window.speed_m_s = speed_m_s;
    return window;
}

SelectionBias bias_of(const std::vector<FoundWindow>& all, const DrawnSpeedErrors& errors,
                      double reach_m_s, SpeedDefinition definition = SpeedDefinition::mean_n,
                      std::int64_t draws = 2000) {
    static const auto of_samples = times();
    const auto chosen = std::ranges::max_element(all, {}, &FoundWindow::speed_m_s);
    return speed_choice_bias(of_samples, legs_of(all, *chosen, chosen->assured_m_s() - reach_m_s),
                             definition, errors, draws, 1);
}

TEST(GaussMarkovMean, HasTheVarianceOfItsSum) {
    EXPECT_DOUBLE_EQ(gauss_markov_mean_sd(1, 0.1, 1.0), 1.0);
    const double kept = std::exp(-0.1);
    EXPECT_NEAR(gauss_markov_mean_sd(2, 0.1, 1.0), std::sqrt(2.0 + 2.0 * kept) / 2.0, 1e-12);
    EXPECT_NEAR(gauss_markov_mean_sd(3, 0.1, 1.0),
                std::sqrt(3.0 + 4.0 * kept + 2.0 * kept * kept) / 3.0, 1e-12);
    EXPECT_NEAR(gauss_markov_mean_sd(50, 0.1, 1e9), 1.0, 1e-6);
    EXPECT_NEAR(gauss_markov_mean_sd(100, 0.1, 1e-9), 0.1, 1e-12);
}

TEST(SpeedChoice, OfOneWindowHasNoBias) {
    const DrawnSpeedErrors errors{.white_m_s = 0.3, .brief_m_s = 0.1, .slow_m_s = 0.1};
    const SelectionBias alone = bias_of({window_at(0, 100, 15.0)}, errors, 1.0);
    EXPECT_EQ(alone.candidates, 1);
    EXPECT_EQ(alone.bounded_bias_m_s, 0.0);
    // Those that are slower than errors make them are none.
    const SelectionBias slower =
        bias_of({window_at(0, 100, 15.0), window_at(0, 900, 13.9)}, errors, 1.0);
    EXPECT_EQ(slower.candidates, 1);
}

/// Of windows that are equally fast in truth, errors of this size choose one: the mean of the
/// largest of so many.
TEST(SpeedChoice, IsInTheMeanWhatTheLargestErrorIs) {
    struct Case {
        std::size_t windows;
        double of_sigma;
    };
    for (const auto& [windows, of_sigma] : {Case{2, 0.5642}, Case{10, 1.5388}}) {
        SCOPED_TRACE(windows);
        RandomGenerator random(4);
        constexpr double white_m_s = 0.2;
        const double sigma_m_s = white_m_s / std::sqrt(20.0);
        std::vector<double> estimates;
        for (int run = 0; run < 60; ++run) {
            std::vector<FoundWindow> all;
            for (std::size_t i = 0; i < windows; ++i)
                all.push_back(window_at(i % 2, 100 + 2000 * i, 15.0 + sigma_m_s * random.normal()));
            const SelectionBias bias =
                bias_of(all, {.white_m_s = white_m_s}, 1.0, SpeedDefinition::mean_n, 400);
            EXPECT_EQ(bias.fitted_bias_m_s, bias.bounded_bias_m_s);
            estimates.push_back(bias.fitted_bias_m_s);
        }
        // Of two windows it is not known whether errors part them: a third is left.
        EXPECT_NEAR(mean(estimates), of_sigma * sigma_m_s,
                    (windows < 3 ? 0.35 : 0.15) * of_sigma * sigma_m_s);
    }
}

TEST(SpeedChoice, RangesFromWhiteNoiseToAllErrors) {
    std::vector<FoundWindow> all;
    for (std::size_t i = 0; i < 8; ++i)
        all.push_back(window_at(i % 2, 100 + 2000 * i, 15.0));
    const DrawnSpeedErrors errors{.white_m_s = 0.1, .brief_m_s = 0.05, .slow_m_s = 0.08};
    const SelectionBias bias = bias_of(all, errors, 1.0);
    // Twice the mean of the largest of eight, less that where errors part the windows before.
    const double white = 0.1 / std::sqrt(20.0);
    EXPECT_GT(bias.fitted_bias_m_s, 1.42 * white);
    EXPECT_LT(bias.fitted_bias_m_s, 2.0 * 1.42 * white);
    const double every = std::hypot(white, 0.05, 0.08);
    EXPECT_GT(bias.bounded_bias_m_s, 1.42 * 0.95 * every);
    EXPECT_LT(bias.bounded_bias_m_s, 2.0 * 1.42 * every);
    EXPECT_GT(bias.bias_uncertainty_m_s, 0.0);
    EXPECT_LT(bias.bias_uncertainty_m_s, 0.1 * bias.bounded_bias_m_s);
    // Of windows next to one another a lasting error moves all alike.
    std::vector<FoundWindow> together;
    for (std::size_t i = 0; i < 8; ++i)
        together.push_back(window_at(0, 100 + i, 15.0));
    EXPECT_LT(bias_of(together, {.slow_m_s = 0.08}, 1.0).bounded_bias_m_s,
              0.25 * bias.bounded_bias_m_s);
}

TEST(SpeedChoice, IsOfTheSamplesThatTheRuleCounts) {
    // Two samples each, at rest but for the noise of the one that does not count.
    const std::vector<FoundWindow> all{window_at(0, 100, 15.0, 1), window_at(0, 900, 15.0, 1),
                                       window_at(1, 50, 15.0, 1)};
    const DrawnSpeedErrors errors{.white_m_s = 0.1};
    const double one = bias_of(all, errors, 1.0, SpeedDefinition::mean_n).bounded_bias_m_s;
    const double both = bias_of(all, errors, 1.0, SpeedDefinition::mean_n_plus_1).bounded_bias_m_s;
    const double path = bias_of(all, errors, 1.0, SpeedDefinition::path_length).bounded_bias_m_s;
    EXPECT_NEAR(both, one / std::sqrt(2.0), 0.1 * one);
    EXPECT_NEAR(path, both, 0.1 * one);
}

TEST(SpeedChoice, IsTheSameOnAnyNumberOfThreads) {
    std::vector<FoundWindow> all;
    for (std::size_t i = 0; i < 8; ++i)
        all.push_back(window_at(i % 2, 100 + 15 * i, 15.0));
    const DrawnSpeedErrors errors{.white_m_s = 0.1, .brief_m_s = 0.05, .slow_m_s = 0.08};
    setenv("RUNCERT_THREADS", "1", 1);
    const double once = bias_of(all, errors, 1.0).bounded_bias_m_s;
    setenv("RUNCERT_THREADS", "3", 1);
    EXPECT_EQ(bias_of(all, errors, 1.0).bounded_bias_m_s, once);
    unsetenv("RUNCERT_THREADS");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
