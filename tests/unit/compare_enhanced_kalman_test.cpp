#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "core/random.h"
#include "reports/compare/methods.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double equatorial_radius_m = 6'378'137.0;

struct MeasuredRun {
    std::vector<ArcEpoch<3>> epochs;
    std::vector<std::optional<MeasuredVelocity>> velocities;
    std::vector<Eigen::Vector3d> true_m_s;

    auto filtered() const { return filter_enhanced_kalman(epochs, velocities); }
};

/// Distance (m) and speed (m/s) by time, along a bearing of 45 degrees; recorded velocities are
/// those of `lag_s` before.
template <class Distance, class Speed>
MeasuredRun simulated(double position_sigma_m, double lag_s, Distance distance_m, Speed speed_m_s) {
    MeasuredRun run;
    RandomGenerator random(7);
    const Eigen::Vector3d along = Eigen::Vector3d(1.0, 1.0, 0.0).normalized();
    for (int k = 0; k <= 450; ++k) {
        const double time_s = 0.1 * k;
        const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
        ArcEpoch<3>& epoch = run.epochs.emplace_back();
        epoch.time_s = time_s;
        epoch.measurement = {.position = along * distance_m(time_s) + position_sigma_m * noise,
                             .covariance = 1e-4 * Eigen::Matrix3d::Identity()};
        run.velocities.push_back(
            MeasuredVelocity{.velocity_m_s = along * speed_m_s(time_s - lag_s),
                             .covariance_m2_s2 = 0.01 * Eigen::Matrix3d::Identity()});
        run.true_m_s.emplace_back(along * speed_m_s(time_s));
    }
    return run;
}

MeasuredRun straight(double position_sigma_m = 0.0) {
    return simulated(
        position_sigma_m, 0.0, [](double t) { return 60.0 * t; }, [](double) { return 60.0; });
}

/// From 0 to 60 m/s at 2 m/s^2, and on at 60.
double accelerated_speed_m_s(double t) {
    return std::clamp(2.0 * t, 0.0, 60.0);
}
double accelerated_distance_m(double t) {
    return t < 30.0 ? t * t : 900.0 + 60.0 * (t - 30.0);
}

TEST(EnhancedKalman, AStraightRunWithExactVelocitiesIsExact) {
    const MeasuredRun run = straight();
    const auto states = run.filtered();
    ASSERT_FALSE(states[0]->velocity_m_s.has_value());
    for (std::size_t k = 1; k < states.size(); ++k)
        EXPECT_LT((states[k]->velocity_m_s.value() - run.true_m_s[k]).norm(), 1e-9) << k;
}

/// Radii of curvature (m) along the meridian and along the prime vertical.
Eigen::Vector2d radii_of_curvature_m(Angle latitude) {
    constexpr double flattening = 1.0 / 298.257223563;
    constexpr double eccentricity_squared = flattening * (2.0 - flattening);
    const double w_squared = 1.0 - eccentricity_squared * std::pow(std::sin(latitude.radians()), 2);
    const double prime_vertical_m = equatorial_radius_m / std::sqrt(w_squared);
    return {prime_vertical_m * (1.0 - eccentricity_squared) / w_squared, prime_vertical_m};
}

/// [EKF] (18), (19): latitude and longitude after a step, by radii for either.
Geodetic moved(const Geodetic& from, const Eigen::Vector2d& step_m, double north_radius_m,
               double east_radius_m) {
    return {.latitude = Angle::from_radians(from.latitude.radians() + step_m.y() / north_radius_m),
            .longitude = Angle::from_radians(from.longitude.radians() + step_m.x() / east_radius_m),
            .height_m = from.height_m};
}

// The equations in latitude and longitude, put right, are the linear ones of the local frame; as
// printed, with the equatorial radius and no cosine of the latitude, they are not.
TEST(EnhancedKalman, TheLocalFrameHasTheEquationsWithTheirSlipsPutRight) {
    struct Case {
        double latitude_deg, north_factor, east_factor;  // M / a, N cos(latitude) / a
    };
    // Computed apart, at height 0.
    for (const Case& one :
         {Case{35.0, 0.99659613, 0.82005558}, Case{60.0, 1.00083360, 0.50125994}}) {
        const Geodetic from{.latitude = Angle::from_degrees(one.latitude_deg),
                            .longitude = Angle::from_degrees(137.0),
                            .height_m = 100.0};
        const LocalFrame frame(from);
        const Eigen::Vector2d velocity_m_s(60.0, 60.0);
        const auto velocity_by = [&](double north_radius_m, double east_radius_m) {
            const Geodetic to = moved(from, velocity_m_s * 0.1, north_radius_m + from.height_m,
                                      east_radius_m + from.height_m);
            return Eigen::Vector2d(frame.enu_from_geodetic(to).m.head<2>() / 0.1);
        };
        const Eigen::Vector2d printed_m_s = velocity_by(equatorial_radius_m, equatorial_radius_m);
        EXPECT_NEAR(printed_m_s.y() / 60.0, one.north_factor, 1e-5);
        EXPECT_NEAR(printed_m_s.x() / 60.0, one.east_factor, 1e-5);
        EXPECT_GT(std::abs(printed_m_s.y() - 60.0), 0.04);
        EXPECT_GT(std::abs(printed_m_s.x() - 60.0), 10.0);
        const Eigen::Vector2d radii_m = radii_of_curvature_m(from.latitude);
        const double cosine = std::cos(from.latitude.radians());
        const Eigen::Vector2d right_m_s =
            velocity_by(radii_m.x(), (radii_m.y() + from.height_m) * cosine - from.height_m);
        EXPECT_LT((right_m_s - velocity_m_s).norm(), 1e-3);
    }
}

TEST(EnhancedKalman, VelocityIsTheDifferenceOfPositions) {
    const MeasuredRun run = straight(0.010);
    const auto states = run.filtered();
    double largest_innovation_m_s = 0.0;
    for (std::size_t k = 1; k < states.size(); ++k) {
        const double dt_s = run.epochs[k].time_s - run.epochs[k - 1].time_s;
        const Eigen::Vector3d velocity_m_s = states[k]->velocity_m_s.value();
        const Eigen::Vector3d step_m = states[k]->position_m - states[k - 1]->position_m;
        EXPECT_LT((velocity_m_s * dt_s - step_m).norm(), 1e-12) << k;
        largest_innovation_m_s =
            std::max(largest_innovation_m_s, (velocity_m_s - run.true_m_s[k]).norm());
    }
    // With noise the positions move by their corrections, and the velocity says so.
    EXPECT_GT(largest_innovation_m_s, 0.01);
}

TEST(EnhancedKalman, SteadyGainIsThatOfTheRiccatiEquation) {
    // With q = 0.1 m/s * 0.1 s = r = 10 mm, the filtered variance is r^2 (sqrt(5) - 1) / 2.
    const Eigen::Matrix3d covariance_m2 = straight().filtered().back()->covariance_m2;
    EXPECT_LT(
        (covariance_m2 - 1e-4 * (std::sqrt(5.0) - 1.0) / 2.0 * Eigen::Matrix3d::Identity()).norm(),
        1e-12);
}

TEST(EnhancedKalman, LaggedVelocitiesBreakNothing) {
    const MeasuredRun run = simulated(0.010, 0.22, accelerated_distance_m, accelerated_speed_m_s);
    const auto states = run.filtered();
    for (std::size_t k = 1; k < states.size(); ++k) {
        const Eigen::Vector3d velocity_m_s = states[k]->velocity_m_s.value();
        ASSERT_TRUE(velocity_m_s.allFinite());
        // The positions hold the filter to the run: less than lag times acceleration, 0.44 m/s,
        // and what noise of 10 mm adds to a difference over 0.1 s.
        EXPECT_NEAR(velocity_m_s.head<2>().norm(),
                    accelerated_speed_m_s(run.epochs[k].time_s - 0.05), 0.6)
            << k;
    }
}

TEST(EnhancedKalman, CarriesOnWithoutPositionsAndBeginsAnewWithoutVelocities) {
    MeasuredRun run = straight();
    for (std::size_t k = 100; k < 200; ++k)
        run.epochs[k].measurement.reset();
    for (std::size_t k = 300; k < 310; ++k)
        run.velocities[k].reset();
    const auto states = run.filtered();
    EXPECT_NEAR(states[199]->velocity_m_s->norm(), 60.0, 1e-9);
    EXPECT_GT(states[199]->covariance_m2(0, 0), 0.009);  // 100 steps of (10 mm)^2
    EXPECT_TRUE(states[300]->velocity_m_s.has_value());  // by the velocity before
    EXPECT_FALSE(states[301]->velocity_m_s.has_value());
    EXPECT_FALSE(states[309]->velocity_m_s.has_value());
    EXPECT_NEAR(states[310]->velocity_m_s->norm(), 60.0, 1e-9);
    run.epochs[0].measurement.reset();
    EXPECT_FALSE(run.filtered()[0].has_value());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
