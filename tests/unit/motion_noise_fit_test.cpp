#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "motion/noise_fit.h"
#include "motion/noise_search.h"
#include "motion_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using test::simulate_arc;

template <int Axes>
NoiseFit fit_of(const std::vector<ArcEpoch<Axes>>& arc, const NoiseFitOptions& options = {}) {
    const std::span<const ArcEpoch<Axes>> arcs[] = {arc};
    return fit_noise<Axes>(arcs, options);
}

EstimationModel white_model(double jerk_density, double scale) {
    EstimationModel model;
    model.motion.jerk_density = jerk_density;
    model.measurement_scale = scale;
    return model;
}

/// 3 mm white noise, as stated, and an error of 8 mm with a correlation time of 2 s.
EstimationModel model_with_error() {
    EstimationModel model;
    model.error = GaussMarkovError::steady(0.008, 2.0);
    return model;
}

template <int Axes>
std::vector<ArcEpoch<Axes>> arc_of(const EstimationModel& model, std::size_t epochs,
                                   double stated_sigma_m, std::uint64_t seed) {
    RandomGenerator random(seed);
    return simulate_arc<Axes>(model, epochs, 0.1, stated_sigma_m, random).arc;
}

/// Error of a fitted parameter over its stated uncertainty.
double normalised(const FittedParameter& fitted, double truth) {
    return std::log(fitted.value / truth) / fitted.relative_uncertainty;
}

TEST(NoiseFit, FindsJerkDensityAndScaleWithinTheirUncertainties) {
    constexpr int runs = 20;
    double jerk = 0.0;
    double scale = 0.0;
    int told = 0;
    int singer = 0;
    for (std::uint64_t seed = 100; seed < 100 + runs; ++seed) {
        const NoiseFit fit = fit_of<1>(arc_of<1>(white_model(1.0, 1.5), 600, 0.01, seed));
        EXPECT_EQ(fit.status, NoiseFit::Status::fitted);
        EXPECT_EQ(fit.epochs, 600);
        EXPECT_TRUE(fit.converged);
        EXPECT_FALSE(fit.jerk_density.at_bound);
        EXPECT_LT(std::abs(normalised(fit.jerk_density, 1.0)), 3.0) << seed;
        EXPECT_LT(std::abs(normalised(fit.measurement_scale, 1.5)), 3.0) << seed;
        jerk += std::pow(normalised(fit.jerk_density, 1.0), 2) / runs;
        scale += std::pow(normalised(fit.measurement_scale, 1.5), 2) / runs;
        told += fit.correlated_error_detected ? 1 : 0;
        singer += std::isfinite(fit.acceleration_time.value) ? 1 : 0;
    }
    EXPECT_GT(jerk, 0.5);
    EXPECT_LT(jerk, 2.0);
    EXPECT_GT(scale, 0.5);
    EXPECT_LT(scale, 2.0);
    EXPECT_LE(told, 3);
    EXPECT_LE(singer, 3);
}

TEST(NoiseFit, StatedUncertaintyOfTheScaleIsThatOfItsTheory) {
    // n innovations tell a standard deviation to 1 / sqrt(2 n); the jerk density takes a little.
    const NoiseFit fit = fit_of<1>(arc_of<1>(white_model(1.0, 1.5), 600, 0.01, 1));
    EXPECT_GT(fit.measurement_scale.relative_uncertainty, 1.0 / std::sqrt(2.0 * 597));
    EXPECT_LT(fit.measurement_scale.relative_uncertainty, 1.3 / std::sqrt(2.0 * 597));
}

TEST(NoiseFit, TellsACorrelatedError) {
    const double diffusion = 0.008 * std::sqrt(2.0 / 2.0);
    NoiseFitOptions options;
    options.motion = NoiseFitOptions::Motion::constant_acceleration;
    int told = 0;
    int within = 0;
    constexpr int runs = 5;
    for (std::uint64_t seed = 100; seed < 100 + runs; ++seed) {
        const NoiseFit fit = fit_of<2>(arc_of<2>(model_with_error(), 1500, 0.003, seed), options);
        EXPECT_EQ(fit.status, NoiseFit::Status::fitted);
        EXPECT_LT(std::abs(normalised(fit.jerk_density, 1.0)), 3.0) << seed;
        // White noise alone takes part of the error for itself.
        EXPECT_GT(fit.white_scale, 1.05);
        if (!fit.correlated_error_detected) continue;
        ++told;
        EXPECT_GT(fit.error_gain, 2.9957);
        EXPECT_LT(std::abs(normalised(fit.measurement_scale, 1.0)), 3.0) << seed;
        EXPECT_LT(fit.error_diffusion.relative_uncertainty, 0.3);
        within += std::abs(normalised(fit.error_diffusion, diffusion)) < 3.0 ? 1 : 0;
        EXPECT_NEAR(fit.error_sigma.value,
                    fit.error_diffusion.value * std::sqrt(fit.error_tau.value / 2.0), 1e-12);
        EXPECT_NEAR(fit.model.error.process_density / fit.error_diffusion.value, 1.0, 1e-12);
        EXPECT_EQ(fit.model.error.tau_s, fit.error_tau.value);
        // The models without an error have next to no share.
        double share = 0.0;
        for (const WeightedModel& one : fit.posterior)
            if (one.model.error.initial_sigma_m < 1e-3) share += one.weight;
        EXPECT_LT(share, 0.05);
    }
    EXPECT_GE(told, runs - 1);
    EXPECT_GE(within, told - 1);
}

TEST(NoiseFit, TellsAnAccelerationThatDiesAway) {
    EstimationModel model;
    model.motion = {.jerk_density = 3.0, .acceleration_time_s = 1.0};
    for (std::uint64_t seed = 100; seed < 103; ++seed) {
        const auto arc = arc_of<1>(model, 1500, 0.003, seed);
        const NoiseFit fit = fit_of<1>(arc);
        EXPECT_GT(fit.singer_gain, 1.9207) << seed;
        EXPECT_LT(std::abs(normalised(fit.acceleration_time, 1.0)), 3.0) << seed;
        EXPECT_LT(fit.acceleration_time.relative_uncertainty, 0.5);
        EXPECT_EQ(fit.model.motion.acceleration_time_s, fit.acceleration_time.value);
        EXPECT_FALSE(std::isinf(fit.posterior[0].model.motion.acceleration_time_s));
        NoiseFitOptions persistent;
        persistent.motion = NoiseFitOptions::Motion::constant_acceleration;
        const NoiseFit other = fit_of<1>(arc, persistent);
        EXPECT_TRUE(std::isinf(other.acceleration_time.value));
        EXPECT_TRUE(std::isinf(other.model.motion.acceleration_time_s));
    }
}

TEST(NoiseFit, SingerWhereItIsAskedFor) {
    NoiseFitOptions options;
    options.motion = NoiseFitOptions::Motion::singer;
    const NoiseFit fit = fit_of<1>(arc_of<1>(white_model(1.0, 1.0), 300, 0.01, 4), options);
    EXPECT_TRUE(std::isfinite(fit.acceleration_time.value));
    EXPECT_EQ(fit.model.motion.acceleration_time_s, fit.acceleration_time.value);
}

TEST(NoiseFit, ModelIsThatOfTheParameters) {
    const NoiseFit fit = fit_of<2>(arc_of<2>(white_model(0.5, 2.0), 200, 0.01, 3));
    EXPECT_NEAR(fit.model.motion.jerk_density / fit.jerk_density.value, 1.0, 1e-12);
    EXPECT_NEAR(fit.model.measurement_scale / fit.measurement_scale.value, 1.0, 1e-12);
    EXPECT_FALSE(fit.correlated_error_detected);
    EXPECT_LT(fit.model.error.initial_sigma_m, 1e-4);
    EXPECT_EQ(fit.error_diffusion.value, 0.0);
    EXPECT_GT(fit.passes, 20.0);
    // It is the maximum: neighbours are less likely.
    const auto arc = arc_of<2>(white_model(0.5, 2.0), 200, 0.01, 3);
    const std::span<const ArcEpoch<2>> arcs[] = {arc};
    const double best = innovation_sums<2>(arcs, fit.model).log_likelihood();
    for (const double factor : {0.9, 1.1}) {
        EstimationModel model = fit.model;
        model.motion.jerk_density *= factor;
        EXPECT_LT(innovation_sums<2>(arcs, model).log_likelihood(), best);
        model = fit.model;
        model.measurement_scale *= factor;
        EXPECT_LT(innovation_sums<2>(arcs, model).log_likelihood(), best);
    }
}

TEST(NoiseFit, PosteriorWeightsSumToOne) {
    for (const EstimationModel& model : {white_model(1.0, 1.0), model_with_error()}) {
        const NoiseFit fit = fit_of<1>(arc_of<1>(model, 400, 0.003, 5));
        double sum = 0.0;
        double largest = 0.0;
        for (const WeightedModel& one : fit.posterior) {
            EXPECT_GT(one.weight, 0.0);
            EXPECT_GT(one.model.motion.jerk_density, 0.0);
            EXPECT_GT(one.model.measurement_scale, 0.0);
            EXPECT_GE(one.model.error.tau_s, 0.5 * (1.0 - 1e-12));
            EXPECT_LE(one.model.error.tau_s, 10.0 * (1.0 + 1e-12));
            sum += one.weight;
            largest = std::max(largest, one.weight);
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
        EXPECT_GT(fit.posterior.size(), 3U);
        for (const WeightedModel& one : fit.posterior)
            EXPECT_GE(one.weight, 1e-3 * largest * (1.0 - 1e-12));
    }
}

TEST(NoiseFit, IsTheSameTwice) {
    const auto arc = arc_of<2>(model_with_error(), 300, 0.003, 9);
    const NoiseFit first = fit_of<2>(arc);
    const NoiseFit second = fit_of<2>(arc);
    const auto numbers = [](const NoiseFit& fit) {
        std::vector<double> all{fit.jerk_density.value,
                                fit.jerk_density.relative_uncertainty,
                                fit.measurement_scale.value,
                                fit.measurement_scale.relative_uncertainty,
                                fit.acceleration_time.value,
                                fit.error_diffusion.value,
                                fit.error_tau.value,
                                fit.error_gain,
                                fit.singer_gain,
                                fit.white_scale,
                                fit.passes};
        for (const WeightedModel& one : fit.posterior) {
            all.push_back(one.weight);
            all.push_back(one.model.motion.jerk_density);
            all.push_back(one.model.measurement_scale);
        }
        return all;
    };
    EXPECT_EQ(numbers(first), numbers(second));
}

TEST(NoiseFit, OfTheSameArcTwiceIsSurerByTheRootOfTwo) {
    const auto arc = arc_of<1>(white_model(1.0, 1.5), 600, 0.01, 6);
    const std::span<const ArcEpoch<1>> arcs[] = {arc, arc};
    NoiseFitOptions options;
    options.motion = NoiseFitOptions::Motion::constant_acceleration;
    const NoiseFit once = fit_of<1>(arc, options);
    const NoiseFit twice = fit_noise<1>(arcs, options);
    ASSERT_FALSE(once.correlated_error_detected || twice.correlated_error_detected);
    EXPECT_EQ(twice.epochs, 1200);
    EXPECT_NEAR(twice.jerk_density.value / once.jerk_density.value, 1.0, 5e-3);
    EXPECT_NEAR(twice.measurement_scale.value / once.measurement_scale.value, 1.0, 5e-3);
    EXPECT_NEAR(twice.jerk_density.relative_uncertainty / once.jerk_density.relative_uncertainty,
                std::sqrt(0.5), 0.01);
    EXPECT_NEAR(
        twice.measurement_scale.relative_uncertainty / once.measurement_scale.relative_uncertainty,
        std::sqrt(0.5), 0.01);
}

TEST(NoiseFit, OfBothHalvesIsAlmostThatOfTheWhole) {
    const auto arc = arc_of<1>(white_model(1.0, 1.5), 600, 0.01, 6);
    const std::span<const ArcEpoch<1>> whole(arc);
    const std::span<const ArcEpoch<1>> halves[] = {whole.first(300), whole.subspan(300)};
    const NoiseFit one = fit_of<1>(arc);
    const NoiseFit two = fit_noise<1>(halves, {});
    EXPECT_EQ(two.epochs, 600);
    EXPECT_LT(std::abs(normalised(two.jerk_density, one.jerk_density.value)), 0.5);
    EXPECT_LT(std::abs(normalised(two.measurement_scale, one.measurement_scale.value)), 0.5);
    EXPECT_NE(two.jerk_density.value, one.jerk_density.value);
}

/// What is not fitted is the model as given.
void expect_as_given(const NoiseFit& fit, NoiseFit::Status status) {
    EXPECT_EQ(fit.status, status);
    EXPECT_EQ(fit.model.motion.jerk_density, 2.5);
    EXPECT_EQ(fit.model.measurement_scale, 1.0);
    EXPECT_TRUE(std::isinf(fit.model.motion.acceleration_time_s));
    EXPECT_EQ(fit.model.error.initial_sigma_m, 1e-5);
    EXPECT_EQ(fit.jerk_density.value, 2.5);
    EXPECT_FALSE(fit.correlated_error_detected);
    ASSERT_EQ(fit.posterior.size(), 1U);
    EXPECT_EQ(fit.posterior[0].weight, 1.0);
    EXPECT_EQ(fit.posterior[0].model.motion.jerk_density, 2.5);
}

/// That no model near the fitted one is more likely.
template <int Axes>
void expect_a_maximum(const std::vector<ArcEpoch<Axes>>& arc, const NoiseFit& fit) {
    const std::span<const ArcEpoch<Axes>> arcs[] = {arc};
    const double best = innovation_sums<Axes>(arcs, fit.model).log_likelihood();
    for (const double factor : {0.1, 0.5, 0.9, 0.97, 1.03, 1.1, 2.0, 10.0}) {
        EstimationModel model = fit.model;
        model.motion.jerk_density *= factor;
        EXPECT_LT(innovation_sums<Axes>(arcs, model).log_likelihood(), best) << factor;
        model = fit.model;
        model.measurement_scale *= factor;
        EXPECT_LT(innovation_sums<Axes>(arcs, model).log_likelihood(), best) << factor;
    }
}

TEST(NoiseFit, OfALongArcIsTheMaximumOfAllOfIt) {
    const auto arc = arc_of<2>(model_with_error(), 10'000, 0.003, 5);
    const NoiseFit fit = fit_of<2>(arc);
    EXPECT_TRUE(fit.converged);
    EXPECT_TRUE(fit.correlated_error_detected);
    expect_a_maximum<2>(arc, fit);
    EXPECT_LT(std::abs(normalised(fit.error_sigma, 0.008)), 4.0);
    double weights = 0.0;
    for (const WeightedModel& one : fit.posterior)
        weights += one.weight;
    EXPECT_NEAR(weights, 1.0, 1e-12);
}

TEST(NoiseFit, OfALongArcIsFoundByItsPartWhereSizeAndTimeOfTheErrorAreNotTold) {
    // They trade against each other, and next to no white noise is beside them: the part's are
    // others, the diffusion is not.
    EstimationModel model{.motion = {.jerk_density = 3.0, .acceleration_time_s = 0.5},
                          .measurement_scale = 0.003,
                          .error = GaussMarkovError::steady(0.05, 0.5)};
    RandomGenerator random(1);
    const auto arc = simulate_arc<1>(model, 10'000, 0.04, 1.0, random).arc;
    const NoiseFit fit = fit_of<1>(arc);
    EXPECT_LT(fit.passes, 500.0);
    // On the ridge that the two make the place of the maximum is hardly told. The fit is no further
    // below the truth than 95 % of truths are below their maximum: half of chi-squared's quantile
    // for five parameters.
    const std::span<const ArcEpoch<1>> arcs[] = {arc};
    EXPECT_GT(innovation_sums<1>(arcs, fit.model).log_likelihood(),
              innovation_sums<1>(arcs, model).log_likelihood() - 5.54);
    // The posterior has models next to the maximum of the whole, coarse as its grid is.
    const auto heaviest = std::ranges::max_element(fit.posterior, {}, &WeightedModel::weight);
    EXPECT_GT(innovation_sums<1>(arcs, heaviest->model).log_likelihood(),
              innovation_sums<1>(arcs, fit.model).log_likelihood() - 20.0);
}

TEST(NoiseFit, OfALongArcThatStandsStillWhereItIsLookedAtFirstIsTheMaximumOfAllOfIt) {
    RandomGenerator random(7);
    std::vector<ArcEpoch<1>> arc(12'000);
    for (std::size_t k = 0; k < arc.size(); ++k) {
        arc[k].time_s = 0.1 * static_cast<double>(k);
        // The stretches are looked for about the odd eighths; it sails between them.
        const double sails = (static_cast<double>((k + 1500) % 3000) - 1000.0) / 1000.0;
        const double swing =
            sails > 0.0 && sails < 1.0
                ? 10.0 * std::pow(std::sin(3.14159 * sails), 4) * std::sin(1.2 * arc[k].time_s)
                : 0.0;
        PositionMeasurement<1> measurement;
        measurement.position(0) = swing + 0.01 * random.normal();
        measurement.covariance(0, 0) = 1e-4;
        arc[k].measurement = measurement;
    }
    const NoiseFit fit = fit_of<1>(arc);
    expect_a_maximum<1>(arc, fit);
    EXPECT_GT(fit.jerk_density.value, 0.1);
    const std::span<const ArcEpoch<1>> arcs[] = {arc};
    const auto heaviest = std::ranges::max_element(fit.posterior, {}, &WeightedModel::weight);
    EXPECT_GT(innovation_sums<1>(arcs, heaviest->model).log_likelihood(),
              innovation_sums<1>(arcs, fit.model).log_likelihood() - 10.0);
}

TEST(NoiseFit, NeedsEnoughEpochs) {
    NoiseFitOptions options;
    options.initial_jerk_density = 2.5;
    const auto arc = arc_of<2>(white_model(1.0, 1.0), 36, 0.01, 2);
    const std::span<const ArcEpoch<2>> whole(arc);
    // 30, and for each arc the three that its vague prior predicts.
    const std::span<const ArcEpoch<2>> few[] = {whole.first(32)};
    expect_as_given(fit_noise<2>(few, options), NoiseFit::Status::too_few_epochs);
    expect_as_given(fit_noise<2>({}, options), NoiseFit::Status::too_few_epochs);
    const std::span<const ArcEpoch<2>> halves_too_few[] = {whole.first(18), whole.subspan(18, 17)};
    expect_as_given(fit_noise<2>(halves_too_few, options), NoiseFit::Status::too_few_epochs);
    const std::span<const ArcEpoch<2>> enough[] = {whole.first(18), whole.subspan(18)};
    EXPECT_EQ(fit_noise<2>(enough, options).status, NoiseFit::Status::fitted);
    // Epochs without a measurement do not count.
    auto holes = arc;
    for (const std::size_t k : {7U, 14U, 20U, 28U})
        holes[k].measurement.reset();
    expect_as_given(fit_of<2>(holes, options), NoiseFit::Status::too_few_epochs);
}

TEST(NoiseFit, OfConstantPositionsIsTheModelAsGiven) {
    NoiseFitOptions options;
    options.initial_jerk_density = 2.5;
    auto arc = arc_of<2>(white_model(1.0, 1.0), 100, 0.01, 2);
    for (ArcEpoch<2>& epoch : arc)
        epoch.measurement->position = Eigen::Vector2d(3.0, 4.0);
    expect_as_given(fit_of<2>(arc, options), NoiseFit::Status::constant_positions);
    // Nor do two places with nothing between them tell anything.
    auto other = arc;
    for (ArcEpoch<2>& epoch : other)
        epoch.measurement->position = Eigen::Vector2d(-30.0, 4.0);
    const std::span<const ArcEpoch<2>> arcs[] = {arc, other};
    expect_as_given(fit_noise<2>(arcs, options), NoiseFit::Status::constant_positions);
}

TEST(NoiseFit, AtRestTheJerkDensityIsAtItsBound) {
    RandomGenerator random(8);
    auto arc = arc_of<1>(white_model(1.0, 1.0), 400, 0.01, 2);
    for (ArcEpoch<1>& epoch : arc)
        epoch.measurement->position(0) = 5.0 + 0.02 * random.normal();
    const NoiseFit fit = fit_of<1>(arc);
    EXPECT_EQ(fit.status, NoiseFit::Status::fitted);
    EXPECT_LT(fit.jerk_density.value, 1e-2);
    EXPECT_LT(std::abs(normalised(fit.measurement_scale, 2.0)), 3.0);
}

TEST(NoiseFit, AQuadraticIsFoundThroughItsValuesAndKeepsItsMixedCurvature) {
    Eigen::Matrix3d curvature;
    curvature << -4.0, 1.0, 0.5, 1.0, -3.0, -0.7, 0.5, -0.7, -2.0;
    const Eigen::Vector3d slope(0.3, -0.2, 0.1);
    const Point at{1.0, 2.0, 9.0, 3.0};
    const std::vector<std::size_t> free{0, 1, 3};  // the third parameter is held
    const auto value = [&](const Point& x) {
        const Eigen::Vector3d moved(x[0] - at[0], x[1] - at[1], x[3] - at[3]);
        return 5.0 + slope.dot(moved) + 0.5 * moved.dot(curvature * moved);
    };
    std::vector<double> values;
    for (const Point& x : points_about(at, free, 0.05))
        values.push_back(value(x));
    const Quadratic all = quadratic_through(5.0, values, free.size(), 0.05);
    EXPECT_LT((all.slope - slope).norm(), 1e-10);
    EXPECT_LT((all.curvature - curvature).norm(), 1e-8);
    // From points along the parameters alone: the mixed curvature of half of it is rescaled.
    values.resize(2 * free.size());
    const Quadratic carried =
        quadratic_through(5.0, values, free.size(), 0.05, 0.5 * all.curvature);
    EXPECT_LT((carried.slope - slope).norm(), 1e-10);
    EXPECT_LT((carried.curvature - curvature).norm(), 1e-8);
    // A parameter that changed nothing before has no mixed curvature.
    Eigen::MatrixXd flat = all.curvature;
    flat.row(1).setZero();
    flat.col(1).setZero();
    const Quadratic told = quadratic_through(5.0, values, free.size(), 0.05, flat);
    EXPECT_TRUE(told.curvature.allFinite());
    EXPECT_EQ(told.curvature(0, 1), 0.0);
    EXPECT_LT(std::abs(told.curvature(0, 2) - curvature(0, 2)), 1e-8);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
