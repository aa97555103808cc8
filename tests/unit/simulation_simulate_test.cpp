#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/failure.h"
#include "core/statistics.h"
#include "simulation/simulate.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// A long recording with errors, to take statistics from.
SimulationSpec long_spec() {
    SimulationSpec spec;
    spec.run.duration_s = 10'000.0;  // 100 001 epochs
    return spec;
}

/// Measured minus true along one axis.
std::vector<double> errors_of(const std::vector<SimulatedEpoch>& epochs, int axis) {
    std::vector<double> errors;
    for (const SimulatedEpoch& epoch : epochs)
        errors.push_back((epoch.measured_enu_m - epoch.true_enu_m)(axis));
    return errors;
}

double autocorrelation(const std::vector<double>& errors, std::size_t lag) {
    double products = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        squares += errors[i] * errors[i];
        if (i + lag < errors.size()) products += errors[i] * errors[i + lag];
    }
    return products / squares;
}

TEST(Simulate, WithoutErrorIsTheTruth) {
    for (const SimulatedEpoch& epoch : simulate({})) {
        EXPECT_EQ(epoch.measured_enu_m, epoch.true_enu_m);
        EXPECT_TRUE(epoch.fixed && epoch.recorded);
    }
}

TEST(Simulate, RunsAlongTheBearing) {
    SimulationSpec spec;
    spec.run.bearing_deg = 160.0;
    spec.run.start = {3.0, -2.0, 1.5};
    const SimulatedEpoch last = simulate(spec).back();
    const Eigen::Vector3d way = last.true_enu_m - Eigen::Vector3d(3.0, -2.0, 1.5);
    EXPECT_NEAR(way.norm(), last.truth.distance_m, 1e-9);
    EXPECT_EQ(way.z(), 0.0);
    EXPECT_NEAR(std::atan2(way.x(), way.y()), Angle::from_degrees(160.0).radians(), 1e-12);
}

TEST(Simulate, WhiteNoiseHasTheMomentsAskedFor) {
    SimulationSpec spec = long_spec();
    spec.white_noise = {.horizontal_m = 0.010, .vertical_m = 0.020};
    const auto epochs = simulate(spec);
    const double n = static_cast<double>(epochs.size());
    for (const int axis : {0, 1, 2}) {
        const double sigma = axis == 2 ? 0.020 : 0.010;
        const auto errors = errors_of(epochs, axis);
        // Four times the standard deviation of each statistic.
        EXPECT_NEAR(mean(errors), 0.0, 4.0 * sigma / std::sqrt(n));
        EXPECT_NEAR(standard_deviation(errors), sigma, 4.0 * sigma / std::sqrt(2.0 * n));
        EXPECT_NEAR(autocorrelation(errors, 1), 0.0, 4.0 / std::sqrt(n));
    }
}

TEST(Simulate, GaussMarkovErrorFadesWithItsCorrelationTime) {
    SimulationSpec spec = long_spec();
    spec.correlated_error = {.horizontal_m = 0.008, .vertical_m = 0.016, .correlation_time_s = 2.0};
    const auto epochs = simulate(spec);
    // One independent value each 2 tau: 2500 of them in 10 000 s.
    const double n = 2500.0;
    for (const int axis : {0, 1, 2}) {
        const double sigma = axis == 2 ? 0.016 : 0.008;
        const auto errors = errors_of(epochs, axis);
        EXPECT_NEAR(mean(errors), 0.0, 4.0 * sigma / std::sqrt(n));
        EXPECT_NEAR(standard_deviation(errors), sigma, 4.0 * sigma / std::sqrt(2.0 * n));
        for (const std::size_t lag : {1U, 10U, 20U, 40U}) {
            const double expected = std::exp(-0.1 * static_cast<double>(lag) / 2.0);
            EXPECT_NEAR(autocorrelation(errors, lag), expected, 4.0 / std::sqrt(n)) << lag;
        }
        EXPECT_NEAR(autocorrelation(errors, 1), std::exp(-0.05), 0.005);
    }
}

TEST(Simulate, GaussMarkovErrorIsSteadyFromTheFirstEpoch) {
    SimulationSpec spec;
    spec.run.duration_s = 0.1;
    spec.correlated_error = {.horizontal_m = 1.0, .vertical_m = 1.0, .correlation_time_s = 1000.0};
    std::vector<double> first;
    for (spec.seed = 1; spec.seed <= 2000; ++spec.seed)
        first.push_back(errors_of(simulate(spec), 0).front());
    EXPECT_NEAR(standard_deviation(first), 1.0, 4.0 / std::sqrt(4000.0));
}

TEST(Simulate, DrawsEachErrorAtItsPlaceInTheSequence) {
    SimulationSpec spec;
    spec.white_noise = {.horizontal_m = 0.010, .vertical_m = 0.020};
    const auto reference = simulate(spec);
    SimulationSpec other = spec;
    other.run.duration_s = 10.0;
    other.white_noise.vertical_m = 0.0;
    other.faults.gaps.push_back({.from_s = 1.0, .to_s = 2.0});
    const auto epochs = simulate(other);
    for (std::size_t i = 0; i < epochs.size(); ++i)
        EXPECT_EQ(epochs[i].measured_enu_m.head<2>(), reference[i].measured_enu_m.head<2>());
    other.seed = 2;
    EXPECT_NE(simulate(other)[0].measured_enu_m, reference[0].measured_enu_m);
}

TEST(Simulate, FaultsLandAtTheirEpochs) {
    SimulationSpec spec;
    spec.faults.outliers.push_back({.epoch = 101, .east_m = 0.3, .north_m = -0.2, .up_m = 0.1});
    spec.faults.steps.push_back({.time_s = 12.3, .east_m = 0.5});
    spec.faults.gaps.push_back({.from_s = 5.0, .to_s = 5.3});
    spec.faults.float_fixes.push_back({.from_s = 20.0, .to_s = 20.2});
    for (const SimulatedEpoch& epoch : simulate(spec)) {
        Eigen::Vector3d expected = epoch.true_enu_m;
        if (epoch.epoch == 101) expected += Eigen::Vector3d(0.3, -0.2, 0.1);
        if (epoch.time_ms >= 12'300) expected += Eigen::Vector3d(0.5, 0.0, 0.0);
        EXPECT_EQ(epoch.measured_enu_m, expected) << epoch.epoch;
        EXPECT_EQ(epoch.recorded, epoch.epoch < 51 || epoch.epoch > 53) << epoch.epoch;
        EXPECT_EQ(epoch.fixed, epoch.epoch != 201 && epoch.epoch != 202) << epoch.epoch;
    }
}

TEST(Simulate, RefusesWhatIsNoSimulation) {
    const auto refused = [](auto change) {
        SimulationSpec spec;
        change(spec);
        EXPECT_THROW((void)simulate(spec), Failure);
    };
    refused([](SimulationSpec& spec) { spec.run.rate_hz = 0; });
    refused([](SimulationSpec& spec) { spec.run.duration_s = 0.0; });
    refused([](SimulationSpec& spec) { spec.white_noise.horizontal_m = -0.001; });
    refused([](SimulationSpec& spec) { spec.correlated_error.vertical_m = std::nan(""); });
    refused([](SimulationSpec& spec) { spec.correlated_error.correlation_time_s = 0.0; });
    refused([](SimulationSpec& spec) { spec.run.start_speed_m_s = 30.0; });
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
