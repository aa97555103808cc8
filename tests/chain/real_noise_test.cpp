#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "motion/speed.h"
#include "real_support.h"
#include "stages/window/instants.h"
#include "stages/window/position_speed.h"

// What the noise estimated from real recordings is worth.

namespace runcert::chain::RUNCERT_FILE {
namespace {

class CarrierPhase : public testing::TestWithParam<const char*> {};

TEST_P(CarrierPhase, InnovationsAreWhitenedByTheFittedModel) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Tables tables = certified(*data / GetParam() / "rover.pos");
    const auto& [noise, health] = tables.trajectory.estimation.horizontal;
    fmt::print("{}: lag 1 {:+.3f} with noise as stated, {:+.3f} with the fitted model\n",
               GetParam(), health.autocorrelation_stated, health.autocorrelation);
    // Among the buildings the car's positions err more than where it stands: one scale for all
    // leaves the motion to take that, which the filter then follows too closely (below zero).
    const bool among_buildings = GetParam() == std::string("ppk_urban_car");
    EXPECT_LE(health.autocorrelation, 0.1);
    EXPECT_GE(health.autocorrelation, among_buildings ? -0.2 : -0.1);
    EXPECT_EQ(health.white, !among_buildings);
    EXPECT_EQ(noise.status, NoiseBasis::fitted);
    EXPECT_TRUE(noise.converged);
    EXPECT_GE(noise.epochs, noise.epochs_needed);
    EXPECT_GT(noise.jerk_density.value, 0.0);
    EXPECT_GT(noise.measurement_scale.value, 0.0);
    EXPECT_GT(noise.passes, 0.0);
    EXPECT_FALSE(noise.posterior.empty());
    fmt::print("    {} epochs, scale {:.3f} of {:.1f} mm, jerk density {:.2f} m s^-2.5",
               noise.epochs, noise.measurement_scale.value, noise.stated_sigma_m * 1e3,
               noise.jerk_density.value);
    if (noise.correlated_error_detected) {
        EXPECT_GT(noise.error_diffusion.value().value, 0.0);
        fmt::print(", time-correlated error {:.1f} mm over {:.1f} s",
                   noise.error_sigma_m.value().value * 1e3, noise.error_tau_s.value().value);
    }
    fmt::print("\n");
    std::string statements;
    for (const YamlValue& statement : tables.verdict["statements"].list())
        statements += statement.text() + "\n";
    EXPECT_NE(
        statements.find(fmt::format("horizontal noise was estimated from {} epochs", noise.epochs)),
        std::string::npos)
        << statements;
}

INSTANTIATE_TEST_SUITE_P(RealRecordings, CarrierPhase,
                         testing::Values("ppk_urban_car", "ppk_tokyo_ecef", "rtk_imu_drive",
                                         "ubx_walk"));

TEST(RealRecordings, TheReferenceIsInsideTheStatedIntervalsOfTheUrbanCar) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const fs::path folder = *data / "ppk_urban_car";
    const Tables tables = certified(folder / "rover.pos", base_station);
    const ScreenedTable& screened = tables.screened;
    const NoiseSummary& noise = tables.trajectory.estimation.horizontal.noise;
    const Profile nalsa = read_profile(builtin_profile("nalsa"), "nalsa");
    const auto reference = reference_positions(folder / "reference.csv", urban_frame());
    const auto reference_at = [&](ElapsedTime time) {
        return position_at(reference, screened.facts, time);
    };
    std::int64_t windows = 0;
    std::int64_t inside = 0;
    double half_widths = 0.0;
    double squares = 0.0;
    const EstimationModel model = model_of(noise);
    for (const Arc<2>& arc : arcs_of<2>(screened, tables.trajectory))
        for (const EpochPair& window : certifiable(screened, arc)) {
            const std::size_t first = arc.rows[window.first];
            const std::size_t last = arc.rows[window.last];
            const ErrorBound bound =
                error_bound<2>(screened, first, last, noise, nalsa.uncertainty);
            const WindowStretch stretch = cut_stretch(arc, window, 30.0);
            const Chain<2> smoothed = Chain<2>(stretch.epochs, model);
            const EstimatedWindow<2> at{.epochs = stretch.epochs,
                                        .smoothed = smoothed,
                                        .model = model,
                                        .window = stretch.window,
                                        .duration_s = stretch.duration_s};
            const SpeedQuantity quantity{SpeedDefinition::displacement};
            const SpeedEstimate speed =
                speed_by_positions(at, quantity, speed_weights(at, quantity), bound).speed;
            const double expanded = 2.0 * speed.standard_uncertainty_m_s;
            const double error = speed.speed_m_s - (reference_at(screened.rows[last].time) -
                                                    reference_at(screened.rows[first].time))
                                                           .norm() /
                                                       stretch.duration_s;
            ++windows;
            inside += std::abs(error) <= expanded ? 1 : 0;
            half_widths += expanded;
            squares += error * error;
        }
    const auto n = static_cast<double>(windows);
    const double coverage = static_cast<double>(inside) / n;
    fmt::print(
        "{} windows, {:.1f} % of the reference's speeds inside, mean half width {:.3f} km/h, "
        "RMS difference {:.3f} km/h\n",
        windows, 100.0 * coverage, 3.6 * half_widths / n, 3.6 * std::sqrt(squares / n));
    EXPECT_GT(windows, 1000);
    EXPECT_GE(coverage, 0.95);
    // An interval as wide as the rule allows would hold anything: it must stay well below.
    EXPECT_LT(3.6 * half_widths / n, 0.4);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
