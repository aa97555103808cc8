#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/random.h"
#include "reports/compare/enhanced_kalman.h"

namespace runcert::RUNCERT_FILE {
namespace {

constexpr double equatorial_radius_m = 6'378'137.0;

/// A straight run in the local frame of a place: speed along a bearing of 45 degrees.
struct StraightRun {
    LocalFrame frame;
    std::vector<EnhancedKalmanEpoch> epochs;
    std::vector<Eigen::Vector3d> true_enu_m_s;  ///< in the axes of the place
};

Geodetic place_at(double latitude_deg) {
    return {.latitude = Angle::from_degrees(latitude_deg),
            .longitude = Angle::from_degrees(179.99),  // the run crosses the date line
            .height_m = 100.0};
}

/// Distance (m) and speed (m/s) by time; recorded velocities are those of `lag_s` before.
template <class Distance, class Speed>
StraightRun simulated(double latitude_deg, double position_sigma_m, double lag_s,
                      Distance distance_m, Speed speed_m_s) {
    StraightRun run{LocalFrame(place_at(latitude_deg)), {}, {}};
    RandomGenerator random(7);
    const Eigen::Vector3d along(std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0, 0.0);
    for (int k = 0; k <= 450; ++k) {
        const double time_s = 0.1 * k;
        const Geodetic truth = run.frame.geodetic_from_enu({along * distance_m(time_s)});
        const Eigen::Matrix3d to_place =
            run.frame.rotation_from_local(truth.latitude, truth.longitude).transpose();
        const Eigen::Vector3d noise(random.normal(), random.normal(), random.normal());
        run.epochs.push_back(
            {.time_s = time_s,
             .position = MeasuredGeodetic{.position = moved_by(truth, position_sigma_m * noise),
                                          .covariance_enu_m2 = 1e-4 * Eigen::Matrix3d::Identity()},
             .velocity = MeasuredVelocity{.enu_m_s = to_place * along * speed_m_s(time_s - lag_s),
                                          .covariance_m2_s2 = 0.01 * Eigen::Matrix3d::Identity()}});
        run.true_enu_m_s.emplace_back(to_place * along * speed_m_s(time_s));
    }
    return run;
}

StraightRun straight(double latitude_deg, double position_sigma_m = 0.0) {
    return simulated(
        latitude_deg, position_sigma_m, 0.0, [](double t) { return 60.0 * t; },
        [](double) { return 60.0; });
}

/// From 0 to 60 m/s at 2 m/s^2, and on at 60.
double accelerated_speed_m_s(double t) {
    return std::clamp(2.0 * t, 0.0, 60.0);
}
double accelerated_distance_m(double t) {
    return t < 30.0 ? t * t : 900.0 + 60.0 * (t - 30.0);
}

TEST(RadiiOfCurvature, PublishedValues) {
    // Of WGS 84, to the millimetre: b^2/a and a at the equator, a^2/b at the pole.
    const RadiiOfCurvature equator = radii_of_curvature(Angle::from_degrees(0.0));
    EXPECT_NEAR(equator.meridian_m, 6'335'439.327, 1e-3);
    EXPECT_NEAR(equator.prime_vertical_m, 6'378'137.0, 1e-9);
    const RadiiOfCurvature pole = radii_of_curvature(Angle::from_degrees(90.0));
    EXPECT_NEAR(pole.meridian_m, 6'399'593.626, 1e-3);
    EXPECT_NEAR(pole.prime_vertical_m, 6'399'593.626, 1e-3);
    const RadiiOfCurvature middle = radii_of_curvature(Angle::from_degrees(45.0));
    EXPECT_NEAR(middle.meridian_m, 6'367'381.816, 1e-3);
    EXPECT_NEAR(middle.prime_vertical_m, 6'388'838.290, 1e-3);
}

TEST(LocalStep, AgreesWithTheLocalFrameAndInverts) {
    for (const double latitude_deg : {-60.0, 0.0, 35.0, 60.0}) {
        const Geodetic from = place_at(latitude_deg);
        const LocalFrame frame(from);
        for (const Eigen::Vector3d& enu_m :
             {Eigen::Vector3d(6.0, 0.0, 0.0), Eigen::Vector3d(0.0, 6.0, 0.0),
              Eigen::Vector3d(-40.0, 43.0, 2.0)}) {
            const Geodetic to = moved_by(from, enu_m);
            // Along a parallel and the curved surface, which leave the plane's straight line by
            // distance^2 / 2R times at most 1 / cos(latitude).
            EXPECT_LT((frame.enu_from_geodetic(to).m - enu_m).norm(),
                      enu_m.squaredNorm() * 2.05 / 6.3e6 / 2.0 + 2e-9);
            EXPECT_LT((step_between(from, to) - enu_m).norm(), 5e-9);
        }
    }
}

TEST(EnhancedKalman, AStraightRunWithExactVelocitiesIsExact) {
    for (const double latitude_deg : {35.0, 60.0}) {
        const StraightRun run = straight(latitude_deg);
        const auto states = filter_enhanced_kalman(run.epochs);
        ASSERT_FALSE(states[0]->velocity_enu_m_s.has_value());
        for (std::size_t k = 1; k < states.size(); ++k) {
            const Eigen::Vector3d velocity = states[k]->velocity_enu_m_s.value();
            EXPECT_LT((velocity - run.true_enu_m_s[k]).head<2>().norm(), 1e-3) << k;
            EXPECT_NEAR(velocity.head<2>().norm(), 60.0, 1e-3) << k;
        }
    }
}

/// [EKF] (18), (19) as printed: the equatorial radius, and no cosine of the latitude.
Geodetic moved_as_printed(const Geodetic& from, const Eigen::Vector3d& enu_m) {
    const double radius_m = equatorial_radius_m + from.height_m;
    return {.latitude = Angle::from_radians(from.latitude.radians() + enu_m.y() / radius_m),
            .longitude = Angle::from_radians(from.longitude.radians() + enu_m.x() / radius_m),
            .height_m = from.height_m + enu_m.z()};
}

TEST(EnhancedKalman, TheSlipsAsPrintedWouldBeOff) {
    struct Case {
        double latitude_deg, north_factor, east_factor;  // M / a, N cos(latitude) / a
    };
    // Computed apart, at height 0.
    for (const Case& one :
         {Case{35.0, 0.99659613, 0.82005558}, Case{60.0, 1.00083360, 0.50125994}}) {
        Geodetic from = place_at(one.latitude_deg);
        from.longitude = Angle::from_degrees(137.0);
        const LocalFrame frame(from);
        const Eigen::Vector3d velocity_m_s(60.0, 60.0, 0.0);
        const auto speed_of = [&](const Geodetic& to) -> Eigen::Vector3d {
            return frame.enu_from_geodetic(to).m / 0.1;
        };
        const Eigen::Vector3d printed_m_s = speed_of(moved_as_printed(from, velocity_m_s * 0.1));
        EXPECT_NEAR(printed_m_s.y() / 60.0, one.north_factor, 1e-5);
        EXPECT_NEAR(printed_m_s.x() / 60.0, one.east_factor, 1e-5);
        // At 60 m/s that is far more than the millimetre per second that the filter keeps to.
        EXPECT_GT(std::abs(printed_m_s.y() - 60.0), 0.04);
        EXPECT_GT(std::abs(printed_m_s.x() - 60.0), 10.0);
        const Eigen::Vector3d right_m_s = speed_of(moved_by(from, velocity_m_s * 0.1));
        EXPECT_LT((right_m_s - velocity_m_s).head<2>().norm(), 1e-3);
    }
}

TEST(EnhancedKalman, VelocityIsTheDifferenceOfPositions) {
    const StraightRun run = straight(35.0, 0.010);
    const auto states = filter_enhanced_kalman(run.epochs);
    double largest_innovation_m_s = 0.0;
    for (std::size_t k = 1; k < states.size(); ++k) {
        const double dt_s = run.epochs[k].time_s - run.epochs[k - 1].time_s;
        const Eigen::Vector3d velocity = states[k]->velocity_enu_m_s.value();
        const Geodetic reached = moved_by(states[k - 1]->position, velocity * dt_s);
        EXPECT_LT(step_between(reached, states[k]->position).norm(), 5e-9) << k;
        largest_innovation_m_s =
            std::max(largest_innovation_m_s, (velocity - run.true_enu_m_s[k]).norm());
    }
    // With noise the positions move by their corrections, and the velocity says so.
    EXPECT_GT(largest_innovation_m_s, 0.01);
}

TEST(EnhancedKalman, SteadyGainIsThatOfTheRiccatiEquation) {
    // With q = 0.1 m/s * 0.1 s = r = 10 mm, the filtered variance is r^2 (sqrt(5) - 1) / 2.
    const auto states = filter_enhanced_kalman(straight(35.0).epochs);
    const Eigen::Matrix3d covariance = states.back()->covariance_enu_m2;
    EXPECT_LT(
        (covariance - 1e-4 * (std::sqrt(5.0) - 1.0) / 2.0 * Eigen::Matrix3d::Identity()).norm(),
        1e-12);
}

TEST(EnhancedKalman, LaggedVelocitiesBreakNothing) {
    const StraightRun run =
        simulated(35.0, 0.010, 0.22, accelerated_distance_m, accelerated_speed_m_s);
    const auto states = filter_enhanced_kalman(run.epochs);
    for (std::size_t k = 1; k < states.size(); ++k) {
        const Eigen::Vector3d velocity = states[k]->velocity_enu_m_s.value();
        ASSERT_TRUE(velocity.allFinite());
        // The positions hold the filter to the run: less than lag times acceleration, 0.44 m/s,
        // and what noise of 10 mm adds to a difference over 0.1 s.
        EXPECT_NEAR(velocity.head<2>().norm(), accelerated_speed_m_s(run.epochs[k].time_s - 0.05),
                    0.6)
            << k;
    }
}

TEST(EnhancedKalman, CarriesOnWithoutPositionsAndBeginsAnewWithoutVelocities) {
    StraightRun run = straight(35.0);
    for (std::size_t k = 100; k < 200; ++k)
        run.epochs[k].position.reset();
    for (std::size_t k = 300; k < 310; ++k)
        run.epochs[k].velocity.reset();
    const auto states = filter_enhanced_kalman(run.epochs);
    EXPECT_NEAR(states[199]->velocity_enu_m_s->head<2>().norm(), 60.0, 1e-3);
    EXPECT_GT(states[199]->covariance_enu_m2(0, 0), 0.009);  // 100 steps of (10 mm)^2
    EXPECT_TRUE(states[300]->velocity_enu_m_s.has_value());  // by the velocity before
    EXPECT_FALSE(states[301]->velocity_enu_m_s.has_value());
    EXPECT_FALSE(states[309]->velocity_enu_m_s.has_value());
    EXPECT_NEAR(states[310]->velocity_enu_m_s->head<2>().norm(), 60.0, 1e-3);
    run.epochs[0].position.reset();
    EXPECT_FALSE(filter_enhanced_kalman(run.epochs)[0].has_value());
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
