#include "stages/enu/enu.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/failure.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// One observation with a full covariance and a velocity, `north_m` metres north of the origin.
Observations at(double latitude_deg, double longitude_deg, double height_m) {
    Observations observations;
    observations.facts.receiver = "primary";
    Observation& row = observations.rows.emplace_back();
    row.epoch = 1;
    row.fix = FixType::fixed;
    row.latitude_deg = latitude_deg;
    row.longitude_deg = longitude_deg;
    row.height_m = height_m;
    row.sigma_east_m = 0.01;
    row.sigma_north_m = 0.02;
    row.sigma_up_m = 0.05;
    row.correlation_east_north = 0.5;
    row.correlation_east_up = 0.0;
    row.correlation_north_up = -0.2;
    row.recorded_velocity_east_m_s = 10.0;
    row.recorded_velocity_north_m_s = 20.0;
    row.recorded_velocity_up_m_s = 0.0;
    return observations;
}

Geodetic origin_at(double latitude_deg, double longitude_deg, double height_m) {
    return {.latitude = Angle::from_degrees(latitude_deg),
            .longitude = Angle::from_degrees(longitude_deg),
            .height_m = height_m};
}

TEST(ToEnu, TheFirstFixedPositionIsTheOrigin) {
    Observations observations = at(35.0, 137.0, 100.0);
    Observation other = observations.rows[0];
    other.fix = FixType::single;
    other.latitude_deg = 35.001;
    observations.rows.insert(observations.rows.begin(), other);
    const EnuTable table = to_enu(observations, std::nullopt);
    EXPECT_EQ(table.origin->source, "first_epoch");
    EXPECT_NEAR(*table.rows[1].east_m, 0.0, 1e-9);
    EXPECT_NEAR(*table.rows[1].up_m, 0.0, 1e-9);
    EXPECT_NEAR(*table.rows[0].north_m, 110.94, 0.02);
}

TEST(ToEnu, AtTheOriginCovarianceAndVelocityStayAsTheyAre) {
    const EnuTable table = to_enu(at(35.0, 137.0, 100.0), origin_at(35.0, 137.0, 100.0));
    EXPECT_EQ(table.origin->source, "attempt");
    EXPECT_NEAR(*table.rows[0].sigma_east_m, 0.01, 1e-12);
    EXPECT_NEAR(*table.rows[0].correlation_east_north, 0.5, 1e-9);
    EXPECT_NEAR(*table.rows[0].correlation_north_up, -0.2, 1e-9);
    EXPECT_NEAR(*table.rows[0].recorded_velocity_north_m_s, 20.0, 1e-12);
}

TEST(ToEnu, AwayFromTheOriginTheyTurnWithTheMeridian) {
    // 20 km east at latitude 60 the meridians have converged by dlon sin(lat).
    const double dlon_deg = 20000.0 / (6378137.0 * 0.5) * 180.0 / std::numbers::pi;
    const EnuTable table = to_enu(at(60.0, 10.0 + dlon_deg, 0.0), origin_at(60.0, 10.0, 0.0));
    const double turn =
        dlon_deg * std::numbers::pi / 180.0 * std::sin(60.0 * std::numbers::pi / 180);
    const double expected_east = 10.0 * std::cos(turn) - 20.0 * std::sin(turn);
    EXPECT_NEAR(*table.rows[0].recorded_velocity_east_m_s, expected_east, 2e-4);
    // The determinant and the trace of a covariance do not turn.
    const Eigen::Matrix3d before = stated_covariance<3>(at(60.0, 10.0, 0.0).rows[0]);
    const Eigen::Matrix3d after = stated_covariance<3>(table.rows[0]);
    EXPECT_NEAR(after.trace(), before.trace(), 1e-15);
    EXPECT_NEAR(after.diagonal().prod() / before.diagonal().prod(), 1.0, 0.05);
    EXPECT_GT(std::abs(after(0, 0) - before(0, 0)), 1e-7);
}

TEST(ToEnu, ASpeedWithoutACourseIsCarriedOver) {
    Observations observations = at(35.0, 137.0, 100.0);
    static_cast<RecordedVelocity&>(observations.rows[0]) = {};
    observations.rows[0].recorded_speed_m_s = 22.5;
    observations.rows[0].sigma_recorded_speed_m_s = 0.25;
    const EnuTable table = to_enu(observations, origin_at(35.01, 137.0, 100.0));
    EXPECT_EQ(table.rows[0].recorded_speed_m_s, 22.5);
    EXPECT_EQ(table.rows[0].sigma_recorded_speed_m_s, 0.25);
    EXPECT_FALSE(table.rows[0].recorded_velocity_east_m_s);
}

TEST(ToEnu, LocalPlaneCoordinatesPassThrough) {
    Observations observations;
    observations.facts.georeferenced = false;
    observations.facts.vertical_measured = false;
    Observation& row = observations.rows.emplace_back();
    row.plane_east_m = 1000.001;
    row.plane_north_m = 999.999;
    row.sigma_east_m = 0.01;
    const EnuTable table = to_enu(observations, std::nullopt);
    EXPECT_FALSE(table.origin.has_value());
    EXPECT_FALSE(table.facts.georeferenced);
    EXPECT_EQ(*table.rows[0].east_m, 1000.001);
    EXPECT_FALSE(table.rows[0].up_m.has_value());
    EXPECT_THROW(to_enu(observations, origin_at(0, 0, 0)), Failure);
}

TEST(ToEnu, WithoutMeasuredHeightsUpIsEmpty) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.facts.vertical_measured = false;
    observations.rows[0].sigma_up_m.reset();
    const EnuTable table = to_enu(observations, std::nullopt);
    EXPECT_FALSE(table.rows[0].up_m.has_value());
    EXPECT_FALSE(table.rows[0].sigma_up_m.has_value());
    EXPECT_NEAR(*table.rows[0].sigma_north_m, 0.02, 1e-9);
}

TEST(ToEnu, AnOriginFarAwayIsRefused) {
    EXPECT_THROW(to_enu(at(35.0, 137.0, 100.0), origin_at(-35.0, 137.0, 100.0)), Failure);
}

TEST(ToEnu, AFirstPositionFarFromAllOthersIsNotTheOrigin) {
    Observations observations = at(35.0, 137.0, 100.0);
    for (int i = 1; i < 5; ++i) {
        observations.rows.push_back(observations.rows[0]);
        *observations.rows.back().latitude_deg += 1e-5 * i;
    }
    observations.rows.insert(observations.rows.begin(), 2, observations.rows[0]);
    for (std::size_t i = 0; i < 2; ++i) {
        observations.rows[i].latitude_deg = 0.0;
        observations.rows[i].longitude_deg = 0.0;
    }
    const EnuTable table = to_enu(observations, std::nullopt);
    EXPECT_NEAR(table.origin->position.latitude.degrees(), 35.0, 1e-4);
    EXPECT_GT(std::hypot(*table.rows[0].east_m, *table.rows[0].north_m), 1e6);
    EXPECT_LT(std::hypot(*table.rows[6].east_m, *table.rows[6].north_m), 10.0);
}

/// So many positions, a second apart from `from_s` on, around a place.
void stay(Observations& observations, double from_s, double longitude_deg, int positions) {
    const Observation first = at(35.0, longitude_deg, 100.0).rows[0];
    for (int i = 0; i < positions; ++i) {
        Observation row = first;
        row.epoch = static_cast<std::int64_t>(observations.rows.size()) + 1;
        row.time = {std::llround((from_s + i) * 1e9)};
        *row.latitude_deg += 1e-4 * i;
        observations.rows.push_back(row);
    }
}

TEST(ToEnu, APlaceFarAwayWhereTheCraftStayedHasAnOriginOfItsOwn) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.rows.clear();
    stay(observations, 0.0, 137.0, 600);
    stay(observations, 8000.0, 138.5, 300);
    const EnuTable table = to_enu(observations, std::nullopt);
    EXPECT_EQ(table.origin->position.longitude.degrees(), 137.0);
    ASSERT_EQ(table.origin->places.size(), 1U);
    const FramePlace place = table.origin->places.front();
    EXPECT_EQ(place.from.nanoseconds, 8'000'000'000'000);
    EXPECT_EQ(place.position.longitude.degrees(), 138.5);
    // It lies where it is seen from the first, and a degree of the meridian is as long there.
    EXPECT_NEAR(place.east_m, 136'800.0, 200.0);
    EXPECT_NEAR(*table.rows[600].east_m, place.east_m, 1e-6);
    EXPECT_NEAR(*table.rows[600].up_m, 0.0, 1e-6);
    const auto way_m = [&](std::size_t from) {
        return std::hypot(*table.rows[from + 200].east_m - *table.rows[from].east_m,
                          *table.rows[from + 200].north_m - *table.rows[from].north_m);
    };
    EXPECT_NEAR(way_m(600), way_m(0), 1e-6);
    EXPECT_NEAR(*table.rows[600].recorded_velocity_north_m_s, 20.0, 1e-9);
    // And back: where it came from the positions are what they were.
    const PlaceFrames frames(*table.origin);
    const EnuEpoch& row = table.rows[700];
    EXPECT_NEAR(
        frames.geodetic(row.time, {*row.east_m, *row.north_m, *row.up_m}).latitude.degrees(),
        *observations.rows[700].latitude_deg, 1e-10);
}

TEST(ToEnu, APlaceIsWhereItStayedAndNotWhereFewPositionsAre) {
    for (const int far : {1, 29}) {
        Observations observations = at(35.0, 137.0, 100.0);
        observations.rows.clear();
        stay(observations, 0.0, 137.0, 300);
        stay(observations, 300.0, 139.0, far);
        stay(observations, 300.0 + far, 137.0, 300);
        EXPECT_TRUE(to_enu(observations, std::nullopt).origin->places.empty()) << far;
    }
}

TEST(ToEnu, BackAtTheFirstPlaceItIsTheFirstPlace) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.rows.clear();
    stay(observations, 0.0, 137.0, 300);
    stay(observations, 4000.0, 137.3, 100);  // 27 km, over an hour that was not recorded
    stay(observations, 9000.0, 137.0, 100);
    const EnuTable table = to_enu(observations, std::nullopt);
    ASSERT_EQ(table.origin->places.size(), 2U);
    EXPECT_EQ(table.origin->places[1].position.longitude.degrees(), 137.0);
    EXPECT_EQ(table.origin->places[1].east_m, 0.0);
    EXPECT_NEAR(*table.rows[400].north_m, *table.rows[0].north_m, 1e-9);
}

TEST(ToEnu, AStatedOriginFarFromAllIsRefusedHoweverLongItWasStayed) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.rows.clear();
    stay(observations, 0.0, 137.0, 600);
    EXPECT_THROW(to_enu(observations, origin_at(-35.0, 137.0, 100.0)), Failure);
    // Where some was recorded there, the rest is another place.
    stay(observations, 8000.0, 139.0, 100);
    EXPECT_EQ(to_enu(observations, origin_at(35.0, 139.0, 100.0)).origin->places.size(), 2U);
}

TEST(ToEnu, ARecordingWithoutPositionsIsRefused) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.rows[0].latitude_deg.reset();
    EXPECT_THROW(to_enu(observations, std::nullopt), Failure);
}

TEST(ToEnu, ARecordingWithoutHeightsSaysThatTheyAreMissing) {
    Observations observations = at(35.0, 137.0, 100.0);
    observations.rows[0].height_m.reset();
    observations.facts.vertical_measured = false;
    try {
        to_enu(observations, std::nullopt);
        FAIL() << "no heights";
    } catch (const Failure& failure) {
        EXPECT_NE(failure.problem().find("has no heights"), std::string::npos);
        EXPECT_NE(failure.remedy().find("height_m"), std::string::npos);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
