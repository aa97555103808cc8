#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "stages/window/velocity_noise.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// What a recording is made of; speeds about 15 m/s.
struct Made {
    double step_s = 0.1;
    double white_m_s = 0.1;
    double constant_m_s = 0.0;  ///< of the recorded speeds, all along
    double smoothed_m_s = 0.0;  ///< of the smoothed speeds: an error that wavers for 3 s
    double from_m_s = 15.0;     ///< of the first half
    std::int64_t samples = 20'000;
};

std::vector<ComparedSpeed> compared(const Made& made, std::uint64_t seed = 1) {
    RandomGenerator random(seed);
    std::vector<ComparedSpeed> all;
    for (std::int64_t k = 0; k < made.samples; ++k) {
        ComparedSpeed one;
        one.time_s = made.step_s * static_cast<double>(k);
        const double true_m_s =
            (2 * k < made.samples ? made.from_m_s : 15.0) + 0.5 * std::sin(0.3 * one.time_s);
        one.recorded_m_s = true_m_s + made.constant_m_s + made.white_m_s * random.normal();
        one.smoothed_m_s = true_m_s + made.smoothed_m_s * std::numbers::sqrt2 *
                                          std::sin(2.0 * std::numbers::pi / 3.0 * one.time_s);
        if (!all.empty()) {
            const ComparedSpeed& before = all.back();
            one.recorded_m =
                before.recorded_m + 0.5 * made.step_s * (before.recorded_m_s + one.recorded_m_s);
            one.smoothed_m =
                before.smoothed_m + 0.5 * made.step_s * (before.smoothed_m_s + one.smoothed_m_s);
        }
        all.push_back(one);
    }
    return all;
}

TEST(WhiteNoiseOfSpeeds, IsWhatEachSampleHas) {
    for (const double white_m_s : {0.03, 0.3}) {
        const auto white = white_noise(compared({.white_m_s = white_m_s}), 1000.0, 1002.0);
        ASSERT_TRUE(white);
        // 620 samples tell it to 5 % (one standard deviation).
        EXPECT_NEAR(white->sd_m_s, white_m_s, 0.2 * white_m_s);
        EXPECT_NEAR(white->independent, 0.37 * 618.0, 3.0);
    }
}

TEST(WhiteNoiseOfSpeeds, HoldsNeitherThePositionsNoiseNorTheMotion) {
    // Smoothed speeds at 1 Hz whose own errors are larger.
    const auto beside = white_noise(
        compared({.step_s = 0.1, .white_m_s = 0.05, .smoothed_m_s = 1.0}), 1000.0, 1002.0);
    EXPECT_NEAR(beside->sd_m_s, 0.05, 0.015);
    // A motion that third differences do not take away.
    std::vector<ComparedSpeed> rough = compared({.white_m_s = 0.05});
    RandomGenerator random(3);
    for (ComparedSpeed& one : rough) {
        const double motion_m_s = 0.5 * random.normal();
        one.recorded_m_s += motion_m_s;
        one.smoothed_m_s += motion_m_s;
    }
    EXPECT_NEAR(white_noise(rough, 1000.0, 1002.0)->sd_m_s, 0.05, 0.01);
}

TEST(WhiteNoiseOfSpeeds, IsThatAroundTheWindow) {
    std::vector<ComparedSpeed> all = compared({.white_m_s = 0.05});
    const std::vector<ComparedSpeed> noisy = compared({.white_m_s = 0.4});
    for (std::size_t k = 0; k < all.size(); ++k)
        if (std::abs(all[k].time_s - 500.0) < 40.0) all[k] = noisy[k];
    EXPECT_NEAR(white_noise(all, 499.0, 501.0)->sd_m_s, 0.4, 0.06);
    EXPECT_NEAR(white_noise(all, 1499.0, 1501.0)->sd_m_s, 0.05, 0.01);
    // One wild speed changes nothing.
    all[15'000].recorded_m_s += 50.0;
    EXPECT_NEAR(white_noise(all, 1499.0, 1501.0)->sd_m_s, 0.05, 0.01);
}

TEST(WhiteNoiseOfSpeeds, IsNotToldByFewSamples) {
    EXPECT_FALSE(white_noise(compared({.samples = 32}), 0.0, 2.0));
    EXPECT_TRUE(white_noise(compared({.samples = 33}), 0.0, 2.0));
    // Samples of different stretches are never compared.
    std::vector<ComparedSpeed> parted = compared({.samples = 400});
    for (std::size_t k = 0; k < parted.size(); ++k)
        parted[k].stretch = static_cast<std::int64_t>(k / 3);
    EXPECT_FALSE(white_noise(parted, 0.0, 40.0));
}

TEST(SpreadOfSpans, IsTheRootMeanSquareOfMeanSpeedsLessPathOverTime) {
    const auto white = span_spread(compared({.white_m_s = 0.2}), 2.0);
    ASSERT_TRUE(white);
    EXPECT_EQ(white->independent, 999.0);  // of 1999.9 s
    EXPECT_NEAR(white->sd_m_s, 0.2 / std::sqrt(20.0), 0.003);
    EXPECT_NEAR(span_spread(compared({.white_m_s = 0.0, .constant_m_s = 0.3}), 10.0)->sd_m_s, 0.3,
                1e-9);
    // An error that wavers within 3 s shows over 1 s and not over 10 s.
    const Made wavers{.white_m_s = 0.0, .smoothed_m_s = 0.3};
    EXPECT_NEAR(span_spread(compared(wavers), 1.0)->sd_m_s, 0.3 * 0.827, 0.02);
    EXPECT_LT(span_spread(compared(wavers), 10.0)->sd_m_s, 0.04);
}

TEST(SpreadOfSpans, IsThatOfTheFastHalf) {
    std::vector<ComparedSpeed> all = compared({.white_m_s = 0.0, .from_m_s = 5.0});
    // While it is slow the two differ by a metre a second.
    for (ComparedSpeed& one : all)
        one.recorded_m += std::min(1000.0, one.time_s);
    EXPECT_NEAR(span_spread(all, 10.0)->sd_m_s, 0.0, 1e-9);
    EXPECT_NEAR(span_spread(all, 10.0)->independent, 100.0, 1.0);
}

TEST(SpreadOfSpans, NeedsFiveOfThemWithinStretches) {
    EXPECT_TRUE(span_spread(compared({.samples = 501}), 10.0));
    EXPECT_FALSE(span_spread(compared({.samples = 500}), 10.0));
    std::vector<ComparedSpeed> parted = compared({.samples = 5'000});
    for (std::size_t k = 0; k < parted.size(); ++k)
        parted[k].stretch = static_cast<std::int64_t>(k / 95);
    EXPECT_FALSE(span_spread(parted, 10.0));
    EXPECT_TRUE(span_spread(parted, 9.0));
}

TEST(NoiseOfSpeeds, IsInCommonWhereTheTwoAgreeBetterThanTheNoiseLetsThem) {
    const ScreenedTable screened;
    std::vector<ComparedSpeed> all = compared({.white_m_s = 0.2});
    EXPECT_FALSE(speed_noise(all, screened, Dimension::horizontal, 1000.0, 2.0, 20.0).in_common);
    EXPECT_FALSE(speed_noise(all, screened, Dimension::horizontal, 1000.0, 60.0, 600.0).in_common);
    for (ComparedSpeed& one : all)
        one.smoothed_m = one.recorded_m;  // integrated from the speeds
    EXPECT_TRUE(speed_noise(all, screened, Dimension::horizontal, 1000.0, 2.0, 20.0).in_common);
    EXPECT_TRUE(speed_noise(all, screened, Dimension::horizontal, 1000.0, 60.0, 600.0).in_common);
    ScreenedTable derived;
    derived.basis.velocity = VelocityComparison{.origin = VelocityOrigin::positions};
    EXPECT_TRUE(
        speed_noise(compared({}), derived, Dimension::horizontal, 1000.0, 2.0, 20.0).in_common);
}

/// Positions that are the integral of the speeds, with noise added, agree with them whatever the
/// speeds err by.
TEST(NoiseOfSpeeds, IsInCommonWhereCoarsePositionsHardlyPartFromThem) {
    ScreenedTable coarse;
    for (int k = 0; k < 10; ++k) {
        ScreenedEpoch& row = coarse.rows.emplace_back();
        row.usable = true;
        row.arc = 1;
        row.east_m = row.north_m = 0.0;
        row.sigma_east_m = row.sigma_north_m = 1.0;
    }
    RandomGenerator random(5);
    std::vector<ComparedSpeed> all = compared({.white_m_s = 0.02});
    for (ComparedSpeed& one : all)
        one.smoothed_m = one.recorded_m + 0.1 * random.normal();
    const auto in_common = [&] {
        return speed_noise(all, coarse, Dimension::horizontal, 1000.0, 2.0, 20.0).in_common;
    };
    EXPECT_TRUE(in_common());
    for (ComparedSpeed& one : all)
        one.smoothed_m += 2.0 * std::sin(0.1 * one.time_s);  // as independent ones wander
    EXPECT_FALSE(in_common());
}

TEST(ScaleOfSpeeds, IsWhatTheStraightFastSpansShow) {
    for (const double scale : {0.0, 0.015, -0.005}) {
        SCOPED_TRACE(scale);
        std::vector<ComparedSpeed> all = compared({.white_m_s = 0.1});
        for (ComparedSpeed& one : all) {
            one.recorded_m_s *= 1.0 + scale;
            one.recorded_m *= 1.0 + scale;
        }
        const SpeedScale found = speed_scale(all).value();
        EXPECT_NEAR(found.shown, scale, 0.0005);
        EXPECT_NEAR(found.value, scale, 2.0 * found.uncertainty + 1e-4);
        EXPECT_LT(found.uncertainty, 0.0006);
        // Without it, nothing of it is left in the spread.
        EXPECT_LT(span_spread(all, 10.0, found.value)->sd_m_s, 0.03);
    }
    EXPECT_FALSE(speed_scale({}));
    EXPECT_FALSE(speed_scale(compared({.samples = 400})));
}

TEST(SpreadOfSpans, IsThatOfStraightOnes) {
    std::vector<ComparedSpeed> all = compared({.white_m_s = 0.0});
    // The first half goes round in circles.
    const double half_m = all[all.size() / 2].smoothed_m;
    for (ComparedSpeed& one : all) {
        one.track.position.x() = std::max(0.0, one.smoothed_m - half_m);
        if (one.smoothed_m < half_m) one.recorded_m += 2.0 * std::sin(one.time_s);
    }
    EXPECT_NEAR(span_spread(all, 10.0)->sd_m_s, 0.0, 1e-9);
}

SpeedNoise noise_of(double white, double over_window, double over_ten) {
    return {.white = SpeedSpread{white, 100.0},
            .over_window = SpeedSpread{over_window, 100.0},
            .over_ten = SpeedSpread{over_ten, 50.0}};
}

StatedSpeedAccuracy stated(double sigma_m_s) {
    return {.sigma_m_s = sigma_m_s};
}

TEST(ErrorsOfSpeeds, AreThoseShown) {
    // Below 10 s: what D_T shows beyond D_10, white noise in it.
    const SpeedErrors two = speed_errors(noise_of(0.1, 0.13, 0.12), stated(0.5), 2.0, 20.0);
    EXPECT_DOUBLE_EQ(two.white_m_s, 0.1);
    EXPECT_DOUBLE_EQ(two.mean_white_m_s, 0.1 / std::sqrt(20.0));
    EXPECT_NEAR(std::hypot(two.mean_white_m_s, two.brief_m_s), 0.05, 1e-12);
    EXPECT_DOUBLE_EQ(two.slow_m_s, 0.12);
    EXPECT_EQ(two.slow, SlowError::shown);
    EXPECT_NEAR(two.combined(), 0.13, 1e-12);
    // White noise alone where D_T shows less.
    const SpeedErrors white = speed_errors(noise_of(0.3, 0.1, 0.09), stated(0.5), 2.0, 4.0);
    EXPECT_DOUBLE_EQ(white.mean_white_m_s, 0.15);
    EXPECT_EQ(white.brief_m_s, 0.0);
    // From 10 s on D_T says nothing, and no lasting error is taken to be below 0.05 m/s.
    const SpeedErrors ten = speed_errors(noise_of(0.1, 0.4, 0.01), stated(0.5), 10.0, 100.0);
    EXPECT_EQ(ten.brief_m_s, 0.0);
    EXPECT_DOUBLE_EQ(ten.slow_m_s, 0.05);
    EXPECT_EQ(ten.slow, SlowError::floor);
    EXPECT_DOUBLE_EQ(ten.combined(), std::hypot(0.01, 0.05));
}

/// A receiver that stated half its error was held to that.
TEST(ErrorsOfSpeeds, AreNotCappedByWhatTheReceiverStates) {
    const SpeedErrors slow = speed_errors(noise_of(0.1, 0.9, 0.8), stated(0.2), 2.0, 20.0);
    EXPECT_EQ(slow.slow, SlowError::shown);
    EXPECT_NEAR(slow.combined(), 0.9, 1e-12);
    // Coarse positions tell nothing below what they may err by themselves.
    SpeedNoise coarse = noise_of(0.1, 0.12, 0.1);
    coarse.positions_m_s = 0.3;
    const SpeedErrors as_stated = speed_errors(coarse, stated(0.25), 2.0, 20.0);
    EXPECT_EQ(as_stated.slow, SlowError::stated);
    EXPECT_NEAR(std::hypot(as_stated.slow_m_s, as_stated.mean_white_m_s), 0.25, 1e-12);
    EXPECT_EQ(speed_errors(coarse, stated(0.35), 2.0, 20.0).slow, SlowError::shown);
    EXPECT_EQ(speed_errors(coarse, stated(0.05), 2.0, 20.0).slow, SlowError::shown);
}

TEST(ErrorsOfSpeeds, HoldWhatSingleSamplesAreStatedToErrBy) {
    const SpeedErrors errors = speed_errors(noise_of(0.1, 0.13, 0.12),
                                            {.sigma_m_s = 0.4, .of_worse_m_s = 0.15}, 2.0, 20.0);
    EXPECT_DOUBLE_EQ(errors.mean_white_m_s, std::hypot(0.1 / std::sqrt(20.0), 0.15));
}

TEST(ErrorsOfSpeeds, CountAsStatedWhereNothingElseTellsThem) {
    SpeedNoise in_common = noise_of(0.1, 0.02, 0.02);
    in_common.in_common = true;
    SpeedNoise no_spans = noise_of(0.1, 0.02, 0.02);
    no_spans.over_ten.reset();
    SpeedNoise no_window = noise_of(0.1, 0.02, 0.02);
    no_window.over_window.reset();
    for (const SpeedNoise& noise : {in_common, no_spans, no_window, SpeedNoise{}}) {
        const SpeedErrors errors = speed_errors(noise, stated(0.5), 2.0, 20.0);
        EXPECT_NEAR(errors.combined(), 0.5, 1e-12);
        EXPECT_EQ(errors.slow, SlowError::stated);
    }
    EXPECT_EQ(speed_errors(no_window, stated(0.5), 20.0, 200.0).slow, SlowError::floor);
}

TEST(ErrorsOfSpeeds, AreNoSmallerForASmallerClaim) {
    const auto claimed = [](double sigma_m_s, const SpeedNoise& noise) {
        return speed_errors(noise, {.sigma_m_s = sigma_m_s, .claimed = true, .scatter_m_s = 0.15},
                            2.0, 20.0)
            .combined();
    };
    const SpeedNoise shown = noise_of(0.1, 0.13, 0.12);
    EXPECT_NEAR(claimed(0.2, shown), 0.13, 1e-12);
    EXPECT_NEAR(claimed(20.0, shown), 0.13, 1e-12);
    // A claim that the white noise contradicts: it does not average.
    EXPECT_NEAR(claimed(0.09, shown), std::hypot(0.1, 0.12), 1e-12);
    EXPECT_NEAR(claimed(0.0, shown), std::hypot(0.1, 0.12), 1e-12);
    // Where nothing is shown, no less than the scatter.
    EXPECT_NEAR(claimed(0.0, SpeedNoise{}), 0.15, 1e-12);
    EXPECT_NEAR(claimed(0.4, SpeedNoise{}), 0.4, 1e-12);
    SpeedNoise in_common = noise_of(0.01, 0.0, 0.0);
    in_common.in_common = true;
    EXPECT_NEAR(
        speed_errors(in_common, {.sigma_m_s = 0.001, .claimed = true}, 2.0, 20.0).combined(), 0.05,
        1e-12);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
