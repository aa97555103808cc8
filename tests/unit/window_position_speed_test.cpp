#include <gtest/gtest.h>

#include <array>

#include "core/statistics.h"
#include "motion_test_support.h"
#include "stages/window/position_speed.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Noise and motion of the kind that are fitted.
EstimationModel fitted_model() {
    return {.motion = {.jerk_density = 0.6},
            .measurement_scale = 1.3,
            .error = GaussMarkovError::steady(0.008, 2.0)};
}

/// What a certificate meets beside them: a bounded 20 mm error.
ErrorBound bound_of(double sigma_m = 0.02) {
    ErrorBound bound;
    bound.tau_min_s = 0.5;
    bound.tau_max_s = 10.0;
    bound.sigma_m = sigma_m;
    return bound;
}

/// A window of about 3 s in an arc with irregular steps, covariances that change and are
/// correlated between the axes, and one epoch without a measurement.
WindowStretch<2> irregular_stretch() {
    WindowStretch<2> stretch;
    stretch.epochs = test::sample_arc<2>(91, 40);
    stretch.window = {30, 60};
    stretch.duration_s = stretch.epochs[60].time_s - stretch.epochs[30].time_s;
    return stretch;
}

PositionSpeed noise_of(const WindowStretch<2>& stretch, const EstimationModel& model,
                       SpeedDefinition definition, const ErrorBound& bound = bound_of()) {
    const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
    const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                .smoothed = smoothed,
                                .model = model,
                                .window = stretch.window,
                                .duration_s = stretch.duration_s};
    return speed_by_positions(at, {definition}, speed_weights(at, {definition}), bound);
}

Eigen::Vector2d displacement(const WindowStretch<2>& stretch, const EstimationModel& model) {
    const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
    return smoothed.mean(stretch.window.last).head<2>() -
           smoothed.mean(stretch.window.first).head<2>();
}

/// What each measured coordinate weighs in the speed: the smoothed displacement, along its
/// direction and over time, moves by it when the coordinate moves by 1 m.
std::vector<Eigen::Vector2d> weights(const WindowStretch<2>& stretch,
                                     const EstimationModel& model) {
    const Eigen::Vector2d plain = displacement(stretch, model);
    std::vector<Eigen::Vector2d> result(stretch.epochs.size(), Eigen::Vector2d::Zero());
    for (std::size_t k = 0; k < stretch.epochs.size(); ++k) {
        if (!stretch.epochs[k].measurement) continue;
        for (int axis = 0; axis < 2; ++axis) {
            WindowStretch<2> moved = stretch;
            moved.epochs[k].measurement->position(axis) += 1.0;
            result[k](axis) =
                plain.normalized().dot(displacement(moved, model) - plain) / stretch.duration_s;
        }
    }
    return result;
}

/// w' R w of one axis, by dense linear algebra: R is the covariance between all epochs of a
/// stationary Gauss-Markov error of variance 1.
double dense_variance(const std::vector<ArcEpoch<2>>& epochs, const SpeedWeights<2>& weights,
                      Eigen::Index axis, double tau_s) {
    const auto n = static_cast<Eigen::Index>(epochs.size());
    Eigen::VectorXd w(n);
    Eigen::MatrixXd covariance(n, n);
    for (Eigen::Index k = 0; k < n; ++k) {
        w(k) = weights[static_cast<std::size_t>(k)](axis);
        for (Eigen::Index l = 0; l < n; ++l)
            covariance(k, l) = std::exp(-std::abs(epochs[static_cast<std::size_t>(k)].time_s -
                                                  epochs[static_cast<std::size_t>(l)].time_s) /
                                        tau_s);
    }
    return w.dot(covariance * w);
}

/// The largest such variance with the bound's size, of both axes, from so many correlation times.
double dense_largest(const std::vector<ArcEpoch<2>>& epochs, const SpeedWeights<2>& weights,
                     const ErrorBound& bound, int times) {
    double sum = 0.0;
    for (const Eigen::Index axis : {0, 1}) {
        double largest = 0.0;
        for (int i = 0; i < times; ++i) {
            const double tau_s = bound.tau_min_s * std::pow(bound.tau_max_s / bound.tau_min_s,
                                                            i / static_cast<double>(times - 1));
            largest = std::max(largest, std::pow(sigma_at(bound, tau_s), 2) *
                                            dense_variance(epochs, weights, axis, tau_s));
        }
        sum += largest;
    }
    return sum;
}

/// An arc whose steps have all kinds of lengths, and weights of a sum that looks at three
/// scales of time.
struct Weighted {
    std::vector<ArcEpoch<2>> epochs;
    SpeedWeights<2> weights;

    explicit Weighted(std::uint64_t seed) {
        RandomGenerator random(seed);
        double time_s = 0.0;
        for (int k = 0; k < 120; ++k) {
            time_s += k % 40 < 20 ? 0.1 : 3.0 * random.uniform();
            ArcEpoch<2>& epoch = epochs.emplace_back();
            epoch.time_s = time_s;
            epoch.measurement.emplace();
            weights.emplace_back(random.normal(), random.normal());
        }
        // Differences over steps, over a second, and over all, of sizes that differ from arc to
        // arc.
        const double of_steps = random.uniform(), of_blocks = random.uniform();
        for (std::size_t k = 0; k < weights.size(); ++k)
            weights[k] = of_steps * (k % 2 == 0 ? 1.0 : -1.0) * weights[k].cwiseAbs() +
                         Eigen::Vector2d::Constant(of_blocks * (k / 10 % 2 == 0 ? 1.0 : -1.0) +
                                                   (k < 60 ? -0.5 : 0.5));
    }
};

TEST(PositionSpeed, PartsAddUpToTheWhole) {
    for (const SpeedDefinition definition :
         {SpeedDefinition::displacement, SpeedDefinition::path_length,
          SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n}) {
        const PositionSpeed measured = noise_of(irregular_stretch(), fitted_model(), definition);
        const double u = measured.speed.standard_uncertainty_m_s;
        for (const double part : {measured.white_m_s, measured.correlated_m_s, measured.motion_m_s})
            EXPECT_GT(part, 0.01 * u) << to_text(definition);
        EXPECT_NEAR(std::pow(measured.white_m_s, 2) + std::pow(measured.correlated_m_s, 2) +
                        std::pow(measured.motion_m_s, 2),
                    u * u, 1e-6 * u * u)
            << to_text(definition);
    }
}

TEST(PositionSpeed, WhiteAndCorrelatedPartsAreThoseOfTheSameWeights) {
    const WindowStretch<2> stretch = irregular_stretch();
    const EstimationModel model = fitted_model();
    const std::vector<Eigen::Vector2d> h = weights(stretch, model);
    double white = 0.0;
    for (std::size_t k = 0; k < h.size(); ++k) {
        if (!stretch.epochs[k].measurement) continue;
        white += std::pow(model.measurement_scale, 2) *
                 h[k].dot(stretch.epochs[k].measurement->covariance * h[k]);
    }
    const double correlated = dense_largest(stretch.epochs, h, bound_of(), 200);
    const PositionSpeed measured = noise_of(stretch, model, SpeedDefinition::displacement);
    EXPECT_NEAR(measured.white_m_s, std::sqrt(white), 1e-4 * std::sqrt(white));
    EXPECT_NEAR(measured.correlated_m_s, std::sqrt(correlated), 1e-4 * std::sqrt(correlated));
}

TEST(PositionSpeed, TheRestIsTheMotions) {
    // The variance is of first degree in the three noises together: what white noise and the
    // time-correlated error leave is its derivative by the logarithm of the motion's variance.
    const WindowStretch<2> stretch = irregular_stretch();
    const auto variance = [&](double factor) {
        EstimationModel model = fitted_model();
        model.motion.jerk_density *= std::sqrt(factor);
        const double u =
            smoothed_speed(Chain<2>(stretch.epochs, model), stretch.window, stretch.duration_s, {})
                .standard_uncertainty_m_s;
        return u * u;
    };
    const double motion = (variance(std::exp(0.01)) - variance(std::exp(-0.01))) / 0.02;
    const PositionSpeed measured = noise_of(stretch, fitted_model(), SpeedDefinition::displacement);
    EXPECT_NEAR(measured.motion_m_s, std::sqrt(motion), 1e-3 * std::sqrt(motion));
}

TEST(PositionSpeed, WithoutASlowErrorThereIsNoPartOfIt) {
    EstimationModel model = fitted_model();
    model.error = GaussMarkovError::steady(0.0, 1.0);
    const PositionSpeed measured =
        noise_of(irregular_stretch(), model, SpeedDefinition::displacement, bound_of(0.0));
    EXPECT_EQ(measured.correlated_m_s, 0.0);
    EXPECT_GT(measured.white_m_s, 1e-3);
}

TEST(PositionSpeed, OfSamplesIsThatOfTwoPositions) {
    WindowStretch<2> stretch = irregular_stretch();
    const EstimationModel model = fitted_model();
    const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
    const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                .smoothed = smoothed,
                                .model = model,
                                .window = stretch.window,
                                .duration_s = stretch.duration_s};
    SpeedQuantity samples{SpeedDefinition::displacement};
    samples.of_samples = true;
    const PositionSpeed measured =
        speed_by_positions(at, samples, speed_weights(at, samples), bound_of());
    const auto& first = *stretch.epochs[stretch.window.first].measurement;
    const auto& last = *stretch.epochs[stretch.window.last].measurement;
    const Eigen::Vector2d moved = last.position - first.position;
    const double t = stretch.duration_s;
    EXPECT_NEAR(measured.speed.speed_m_s, moved.norm() / t, 1e-12);
    const Eigen::Vector2d u = moved.normalized();
    const double white = 1.3 * std::sqrt(u.dot((first.covariance + last.covariance) * u)) / t;
    EXPECT_NEAR(measured.white_m_s, white, 1e-12);
    EXPECT_EQ(measured.motion_m_s, 0.0);
    // A time-correlated error is worst where it forgets soonest: sqrt(2) of its size.
    EXPECT_NEAR(measured.correlated_m_s, 0.02 * std::sqrt(2.0 * (1.0 - std::exp(-t / 0.5))) / t,
                1e-12);
}

TEST(OtherEstimates, SayHowMuchHangsOnTheModel) {
    WindowStretch<2> stretch = irregular_stretch();
    const auto estimates_of = [&](double jerk_density) {
        EstimationModel model = fitted_model();
        model.motion.jerk_density = jerk_density;
        const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
        const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                    .smoothed = smoothed,
                                    .model = model,
                                    .window = stretch.window,
                                    .duration_s = stretch.duration_s};
        const SpeedQuantity quantity{SpeedDefinition::displacement};
        const auto by_weights = speed_weights(at, quantity);
        const PositionSpeed measured = speed_by_positions(at, quantity, by_weights, bound_of());
        return std::pair(measured.speed.speed_m_s,
                         other_estimates(at, quantity, by_weights, measured));
    };
    const auto [speed, other] = estimates_of(0.6);
    EXPECT_NEAR(other.stiffer_m_s, estimates_of(0.6 / std::sqrt(10.0)).first, 1e-9);
    EXPECT_NEAR(other.softer_m_s, estimates_of(0.6 * std::sqrt(10.0)).first, 1e-9);
    EXPECT_NEAR(other.whole_m_s, speed, 1e-9);  // there is but one density here
    EXPECT_GE(other.half_width_m_s, std::abs(other.stiffer_m_s - speed));
    EXPECT_GE(other.half_width_m_s, std::abs(other.softer_m_s - speed));
    const auto& first = *stretch.epochs[stretch.window.first].measurement;
    const auto& last = *stretch.epochs[stretch.window.last].measurement;
    ASSERT_TRUE(other.chord_m_s && other.chord_difference_uncertainty_m_s);
    EXPECT_NEAR(*other.chord_m_s, (last.position - first.position).norm() / stretch.duration_s,
                1e-12);
    // A model that is wrong shows against the chord: motion smoothed away is not there.
    for (ArcEpoch<2>& epoch : stretch.epochs)
        if (epoch.measurement)
            epoch.measurement->position.x() += 3.0 * std::sin(1.6 * epoch.time_s);
    const auto [stiff_speed, stiff] = estimates_of(1e-4);
    EXPECT_GT(std::abs(*stiff.chord_m_s - stiff_speed),
              2.0 * *stiff.chord_difference_uncertainty_m_s);
    EXPECT_GE(stiff.half_width_m_s, std::abs(*stiff.chord_m_s - stiff_speed) -
                                        2.0 * *stiff.chord_difference_uncertainty_m_s);
}

TEST(LargestCorrelatedVariance, IsThatOfTheWorstCorrelationTimeOfEachAxis) {
    ErrorBound bound = bound_of();
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Weighted one(seed);
        for (const double fitted_m : {0.0, 0.006, 0.02}) {
            bound.fitted_m = fitted_m;
            const double expected = dense_largest(one.epochs, one.weights, bound, 400);
            EXPECT_NEAR(largest_correlated_variance<2>(one.epochs, one.weights, bound) / expected,
                        1.0, 2e-5)
                << seed << " " << fitted_m;
        }
    }
}

TEST(LargestCorrelatedVariance, IsMissedByNoNeighbourhood) {
    // Two measurements that one sum adds and two that it subtracts, of all distances: the worst
    // time is anywhere in the interval, at its ends too, and there may be two of them.
    ErrorBound bound = bound_of(1.0);
    int inside = 0;
    for (const double apart_s : {0.05, 0.2, 0.7, 2.0, 6.0, 20.0})
        for (const double between_s : {0.1, 0.5, 2.0, 8.0, 30.0})
            for (const double share : {0.1, 0.5, 1.0, 3.0}) {
                std::vector<ArcEpoch<1>> epochs(4);
                SpeedWeights<1> weights(4);
                const double times_s[] = {0.0, apart_s, apart_s + between_s,
                                          2.0 * apart_s + between_s};
                const double sizes[] = {1.0, share, -share, -1.0};
                for (std::size_t k = 0; k < 4; ++k) {
                    epochs[k].time_s = times_s[k];
                    weights[k](0) = sizes[k];
                }
                const auto variance = [&](double tau_s) {
                    double sum = 0.0;
                    for (std::size_t k = 0; k < 4; ++k)
                        for (std::size_t l = 0; l < 4; ++l)
                            sum += sizes[k] * sizes[l] *
                                   std::exp(-std::abs(times_s[k] - times_s[l]) / tau_s);
                    return sum;
                };
                double expected = 0.0;
                for (int i = 0; i <= 3000; ++i)
                    expected = std::max(expected, variance(0.5 * std::pow(20.0, i / 3000.0)));
                if (expected > 1.0001 * std::max(variance(0.5), variance(10.0))) ++inside;
                const double found = largest_correlated_variance<1>(epochs, weights, bound);
                EXPECT_NEAR(found / expected, 1.0, 1e-6)
                    << apart_s << " " << between_s << " " << share;
            }
    EXPECT_GT(inside, 10);
}

TEST(LargestCorrelatedVariance, HoldsEveryMixtureAndIsBelowTheSumOfWeights) {
    const ErrorBound bound = bound_of();
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Weighted one(seed);
        const double largest = largest_correlated_variance<2>(one.epochs, one.weights, bound);
        RandomGenerator random(1000 + seed);
        double mixed = 0.0;
        for (const Eigen::Index axis : {0, 1}) {
            double left = 1.0;
            for (int i = 0; i < 4; ++i) {
                const double share = i == 3 ? left : left * random.uniform();
                left -= share;
                mixed += share * 4e-4 *
                         dense_variance(one.epochs, one.weights, axis,
                                        0.5 * std::pow(20.0, random.uniform()));
            }
        }
        EXPECT_LE(mixed, largest * (1.0 + 1e-9)) << seed;
        EXPECT_GT(mixed, 0.1 * largest) << seed;
        double sum = 0.0;
        for (const Eigen::Vector2d& weight : one.weights)
            sum += weight.norm();
        EXPECT_LE(largest, std::pow(0.02 * sum, 2)) << seed;
    }
}

/// How much larger than the maximum an error may be that is no mixture of steady processes. Of
/// windows of 2 to 10 s amid a minute at 10 Hz, in standard deviations.
struct Beyond {
    double changing = 0.0;  ///< correlation times of 0.5 s and 10 s, in turn each second
    double jumping = 0.0;   ///< to and fro with the window
    double any = 0.0;       ///< sigma sum|w|
};
Beyond beyond_of(double window_s, double jerk_density, const GaussMarkovError& fitted) {
    constexpr double step_s = 0.1;
    EstimationModel model{.motion = {.jerk_density = jerk_density}};
    model.error = fitted;
    std::vector<ArcEpoch<1>> epochs(601);
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        epochs[k].time_s = step_s * static_cast<double>(k);
        epochs[k].measurement.emplace();
        epochs[k].measurement->position(0) = 50.0 * epochs[k].time_s;
        epochs[k].measurement->covariance(0, 0) = 9e-6;
    }
    const Chain<1> smoothed(epochs, model);
    const auto half = static_cast<std::size_t>(std::lround(0.5 * window_s / step_s));
    const EstimatedWindow<1> at{.epochs = epochs,
                                .smoothed = smoothed,
                                .model = model,
                                .window = {300 - half, 300 + half},
                                .duration_s = window_s};
    const SpeedWeights<1> weights = speed_weights(at, {SpeedDefinition::displacement});
    const double largest =
        std::sqrt(largest_correlated_variance<1>(epochs, weights, bound_of(1.0)));
    Beyond beyond;
    for (const auto& weight : weights)
        beyond.any += std::abs(weight(0)) / largest;
    for (int phase = 0; phase < 20; ++phase) {
        double with_sum = 0.0, of_sum = 0.0;
        for (std::size_t k = 0; k < epochs.size(); ++k) {
            const bool is_short = (static_cast<int>(k) + phase) / 10 % 2 == 0;
            with_sum *= std::exp(-step_s / (is_short ? 0.5 : 10.0));
            of_sum += weights[k](0) * (2.0 * with_sum + weights[k](0));
            with_sum += weights[k](0);
        }
        beyond.changing = std::max(beyond.changing, std::sqrt(of_sum) / largest);
    }
    const auto period = static_cast<std::size_t>(std::lround(2.0 * window_s / step_s));
    for (std::size_t phase = 0; phase < period; ++phase) {
        double sum = 0.0;
        for (std::size_t k = 0; k < epochs.size(); ++k)
            sum += (k + phase) % period < period / 2 ? weights[k](0) : -weights[k](0);
        beyond.jumping = std::max(beyond.jumping, sum / largest);
    }
    return beyond;
}

TEST(LargestCorrelatedVariance, IsExceededLittleByWhatIsNoMixture) {
    Beyond largest;
    double least_any = 10.0;
    for (const double window_s : {2.0, 3.0, 5.0, 10.0})
        for (const double jerk_density : {0.3, 3.0})
            for (const auto& fitted :
                 {GaussMarkovError::steady(0.0, 1.0), GaussMarkovError::steady(0.008, 2.0),
                  GaussMarkovError::steady(0.02, 1.0)}) {
                const Beyond one = beyond_of(window_s, jerk_density, fitted);
                largest.changing = std::max(largest.changing, one.changing);
                largest.jumping = std::max(largest.jumping, one.jumping);
                largest.any = std::max(largest.any, one.any);
                least_any = std::min(least_any, one.any);
                EXPECT_LE(one.jumping, one.any);
            }
    EXPECT_NEAR(largest.changing, 1.2, 0.05);
    EXPECT_NEAR(largest.jumping, 2.0, 0.05);
    EXPECT_NEAR(largest.any, 2.04, 0.05);
    EXPECT_NEAR(least_any, 1.69, 0.05);
}

TEST(LargestCorrelatedVariance, OfAFittedErrorIsAtTheLongestCorrelationTime) {
    // Its spectrum, for the same wandering in the first second, grows at every frequency.
    ErrorBound bound = bound_of(0.05);
    bound.fitted_m = 0.05;
    const Weighted one(7);
    EXPECT_NEAR(largest_correlated_variance<2>(one.epochs, one.weights, bound),
                0.05 * 0.05 * 20.0 *
                    (dense_variance(one.epochs, one.weights, 0, 10.0) +
                     dense_variance(one.epochs, one.weights, 1, 10.0)),
                1e-9);
}

TEST(PositionSpeed, MotionIsThatAtTheWindow) {
    WindowStretch<2> stretch = irregular_stretch();
    const PositionSpeed even = noise_of(stretch, fitted_model(), SpeedDefinition::displacement);
    stretch.epochs = test::with_changing_motion(std::move(stretch.epochs));
    const PositionSpeed measured = noise_of(stretch, fitted_model(), SpeedDefinition::displacement);
    EXPECT_GT(std::abs(measured.motion_m_s / even.motion_m_s - 1.0), 0.02);
}

TEST(OtherEstimates, OfOneDensityForAllIsTheEstimateThatDoesNotFollowTheMotion) {
    WindowStretch<2> stretch = irregular_stretch();
    const EstimationModel model = fitted_model();
    const SpeedQuantity quantity{SpeedDefinition::displacement};
    const auto other_of = [&](const std::vector<ArcEpoch<2>>& epochs) {
        const Chain<2> smoothed = Chain<2>(epochs, model);
        const EstimatedWindow<2> at{.epochs = epochs,
                                    .smoothed = smoothed,
                                    .model = model,
                                    .window = stretch.window,
                                    .duration_s = stretch.duration_s};
        const auto by_weights = speed_weights(at, quantity);
        const PositionSpeed measured = speed_by_positions(at, quantity, by_weights, bound_of());
        return std::pair(measured.speed.speed_m_s,
                         other_estimates(at, quantity, by_weights, measured));
    };
    const double even_m_s = other_of(stretch.epochs).first;
    const auto [followed_m_s, other] = other_of(test::with_changing_motion(stretch.epochs));
    EXPECT_NEAR(other.whole_m_s, even_m_s, 1e-9);
    EXPECT_GT(std::abs(followed_m_s - even_m_s), 1e-5);
}

TEST(OtherEstimates, OfSamplesNoModelChangesAnything) {
    const WindowStretch<2> stretch = irregular_stretch();
    const EstimationModel model = fitted_model();
    const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
    const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                .smoothed = smoothed,
                                .model = model,
                                .window = stretch.window,
                                .duration_s = stretch.duration_s};
    SpeedQuantity samples{SpeedDefinition::displacement};
    samples.of_samples = true;
    const auto by_weights = speed_weights(at, samples);
    const PositionSpeed measured = speed_by_positions(at, samples, by_weights, bound_of());
    const OtherEstimates other = other_estimates(at, samples, by_weights, measured);
    EXPECT_EQ(other.half_width_m_s, 0.0);
    EXPECT_EQ(other.stiffer_m_s, measured.speed.speed_m_s);
    EXPECT_EQ(other.softer_m_s, measured.speed.speed_m_s);
    EXPECT_FALSE(other.chord_m_s);
}

TEST(OtherEstimates, AChordIsOfMeasuredEnds) {
    WindowStretch<2> stretch = irregular_stretch();
    const EstimationModel model = fitted_model();
    const auto has_chord = [&](SpeedDefinition definition) {
        const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
        const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                    .smoothed = smoothed,
                                    .model = model,
                                    .window = stretch.window,
                                    .duration_s = stretch.duration_s};
        const auto by_weights = speed_weights(at, {definition});
        const PositionSpeed measured = speed_by_positions(at, {definition}, by_weights, bound_of());
        return other_estimates(at, {definition}, by_weights, measured).chord_m_s.has_value();
    };
    EXPECT_TRUE(has_chord(SpeedDefinition::displacement));
    EXPECT_FALSE(has_chord(SpeedDefinition::path_length));
    stretch.epochs[stretch.window.last].measurement.reset();
    EXPECT_FALSE(has_chord(SpeedDefinition::displacement));
}

TEST(ErrorAlong, OfAnErrorInOneDirectionIsThatDirections) {
    // The whole of an error of 80 mm lies along the track: pooled over both axes it looks
    // like one of 80 / sqrt(2).
    RandomGenerator random(12);
    const double decay = std::exp(-0.1 / 1.5);
    std::vector<ArcEpoch<2>> epochs;
    double error = 0.08 * random.normal();
    for (int k = 0; k < 1200; ++k) {
        error = decay * error + 0.08 * std::sqrt(1.0 - decay * decay) * random.normal();
        ArcEpoch<2>& epoch = epochs.emplace_back();
        epoch.time_s = 0.1 * k;
        epoch.measurement.emplace();
        epoch.measurement->covariance = Eigen::Matrix2d::Identity() * 1e-4;
        epoch.measurement->position =
            Eigen::Vector2d(6.0 * k + error + 0.01 * random.normal(), 0.01 * random.normal());
    }
    EstimationModel pooled;
    pooled.motion.jerk_density = 0.3;
    pooled.error = GaussMarkovError::steady(0.08 / std::sqrt(2.0), 1.5);
    EXPECT_GT(error_along(epochs, pooled, Eigen::Vector2d::UnitX()), 1.3);
    EXPECT_EQ(error_along(epochs, pooled, Eigen::Vector2d::UnitY()), 1.0);
}

/// Speed of the true motion of a window, by definition.
double true_speed(const test::SimulatedArc<2>& run, const WindowStretch<2>& stretch,
                  SpeedDefinition definition) {
    const auto& [first, last] = stretch.window;
    if (definition == SpeedDefinition::displacement)
        return (run.truth[last].head<2>() - run.truth[first].head<2>()).norm() / stretch.duration_s;
    double path_m = 0.0;
    double speeds = 0.0;
    for (std::size_t k = first + 1; k <= last; ++k) {
        path_m += (run.truth[k].head<2>() - run.truth[k - 1].head<2>()).norm();
        speeds += run.truth[k].segment<2>(2).norm();
    }
    const auto steps = static_cast<double>(last - first);
    if (definition == SpeedDefinition::path_length) return path_m / stretch.duration_s;
    if (definition == SpeedDefinition::mean_n) return speeds / steps;
    return (speeds + run.truth[first].segment<2>(2).norm()) / (steps + 1.0);
}

TEST(SpeedByDefinition, UncertaintyIsTheScatterOfDrawsFromTheModel) {
    constexpr std::size_t draws = 2000;
    EstimationModel model{.motion = {.jerk_density = 0.6},
                          .measurement_scale = 1.3,
                          .error = GaussMarkovError::steady(0.008, 2.0)};
    const std::array definitions{SpeedDefinition::displacement, SpeedDefinition::path_length,
                                 SpeedDefinition::mean_n_plus_1, SpeedDefinition::mean_n};
    std::array<std::vector<double>, 4> errors;
    std::array<double, 4> stated{};
    RandomGenerator random(20261121);
    for (std::size_t i = 0; i < draws; ++i) {
        const auto run = test::simulate_arc<2>(model, 51, 0.1, 0.005, random);
        const WindowStretch<2> stretch{.epochs = run.arc, .window = {10, 40}, .duration_s = 3.0};
        const Chain<2> smoothed = Chain<2>(run.arc, model);
        for (std::size_t d = 0; d < definitions.size(); ++d) {
            const SpeedEstimate speed =
                smoothed_speed(smoothed, stretch.window, 3.0, {definitions[d]});
            errors[d].push_back(speed.speed_m_s - true_speed(run, stretch, definitions[d]));
            stated[d] += speed.standard_uncertainty_m_s / static_cast<double>(draws);
        }
    }
    for (std::size_t d = 0; d < definitions.size(); ++d) {
        SCOPED_TRACE(to_text(definitions[d]));
        // A standard deviation of 2,000 draws is itself uncertain by 1.6 %.
        EXPECT_NEAR(standard_deviation(errors[d]), stated[d], 0.05 * stated[d]);
        EXPECT_NEAR(mean(errors[d]), 0.0, 4.0 * stated[d] / std::sqrt(2000.0));
    }
}

TEST(CutStretch, WhatLiesBeyondTheMarginChangesNothing) {
    RandomGenerator random(5);
    EstimationModel model = fitted_model();
    model.error = GaussMarkovError::steady(0.02, 10.0);
    Arc<2> arc;
    arc.epochs = test::simulate_arc<2>(model, 2001, 0.1, 0.005, random).arc;
    const EpochPair window{1000, 1030};
    const WindowStretch<2> stretch = cut_stretch(arc, window, 60.0);
    EXPECT_EQ(stretch.epochs.size(), 1231U);
    EXPECT_EQ(stretch.window.first, 600U);
    EXPECT_EQ(stretch.window.last, 630U);
    const SpeedEstimate cut = smoothed_speed(Chain<2>(stretch.epochs, model), stretch.window,
                                             stretch.duration_s, {SpeedDefinition::displacement});
    const SpeedEstimate whole =
        smoothed_speed(Chain<2>(arc.epochs, model), window, 3.0, {SpeedDefinition::displacement});
    EXPECT_NEAR(cut.speed_m_s, whole.speed_m_s, 1e-7);
    EXPECT_NEAR(cut.standard_uncertainty_m_s, whole.standard_uncertainty_m_s,
                1e-6 * whole.standard_uncertainty_m_s);
}

TEST(CutStretch, BeginsWithAMeasuredEpochAndEndsWithTheArc) {
    RandomGenerator random(6);
    Arc<2> arc;
    arc.epochs = test::simulate_arc<2>(fitted_model(), 100, 0.1, 0.005, random).arc;
    for (const std::size_t k : {40U, 41U, 42U})
        arc.epochs[k].measurement.reset();
    const WindowStretch<2> stretch = cut_stretch(arc, {50, 80}, 0.95);
    ASSERT_TRUE(stretch.epochs.front().measurement);
    EXPECT_EQ(stretch.epochs.front().time_s, arc.epochs[43].time_s);
    EXPECT_EQ(stretch.epochs.back().time_s, arc.epochs[89].time_s);
    EXPECT_EQ(stretch.epochs[stretch.window.first].time_s, arc.epochs[50].time_s);
    EXPECT_EQ(stretch.epochs[stretch.window.last].time_s, arc.epochs[80].time_s);
    EXPECT_EQ(cut_stretch(arc, {50, 80}, 60.0).epochs.size(), 100U);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
