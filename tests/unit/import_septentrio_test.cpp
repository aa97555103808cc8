#include <fmt/format.h>

#include <numbers>

#include "core/geodesy.h"
#include "import_test_support.h"

// Rows as sbf2asc writes them, by the conversions that its source states (Septentrio, sbf2asc,
// PVTGeodetic and PVTCartesian).

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

constexpr double no_value = -2e10;

struct Solution {
    double seconds = 1'400'000'000.0;  ///< of the GPS epoch: 2024-05-17T16:53:20
    Geodetic place{.latitude = Angle::from_degrees(45.25),
                   .longitude = Angle::from_degrees(9.125),
                   .height_m = 167.25};
    Eigen::Vector3d enu_m_s{-4.0, 3.0, 0.5};
    int satellites = 14, mode = 4, age = 150, error = 0;
};

std::string geodetic_row(const Solution& s, bool without_position = false) {
    const double lat = without_position ? no_value : s.place.latitude.radians();
    const double lon = without_position ? no_value : s.place.longitude.radians();
    return fmt::format(
        "{:<2} {:13.2f} {:14.11f} {:15.11f} {:14.5f} {:14.5f} {:10.5f} {:10.5f} {:10.5f} {:15.8e} "
        "{:13.6e} {:3} {:3} {:3} {:3} {:10.3f}\n",
        -1, s.seconds, lat, lon, s.place.height_m, 47.25, s.enu_m_s[1], s.enu_m_s[0], s.enu_m_s[2],
        1e-5, no_value, s.satellites, s.mode, s.age, s.error, 306.87);
}

std::string cartesian_row(const Solution& s) {
    const Eigen::Vector3d x = ecef_from_geodetic(s.place).m;
    const Eigen::Vector3d v =
        rotation_enu_from_ecef(s.place.latitude, s.place.longitude).transpose() * s.enu_m_s;
    return fmt::format(
        "{:<2} {:13.2f} {:14.3f} {:14.3f} {:14.3f} {:10.3f} {:10.3f} {:10.3f} {:15.8e} {:13.6e} "
        "{:3} {:3} {:3} {:3} {:10.3f}\n",
        0, s.seconds, x[0], x[1], x[2], v[0], v[1], v[2], no_value, no_value, s.satellites, s.mode,
        s.age, s.error, 306.87);
}

TEST(Septentrio, GeodeticRowsAreReadInTheirUnits) {
    Solution second;
    second.seconds += 0.1;
    second.mode = 1;
    second.age = 65535;
    const Observations read =
        import_text(pos_receiver(), geodetic_row({}) +
                                        "-2 1400000000.00          0.001          0.001          "
                                        "0.001          0.001 0 0 0 0 0 0 0 0\n" +
                                        cartesian_row({}) + geodetic_row(second));
    EXPECT_EQ(read.format, "septentrio");
    EXPECT_EQ(read.variant, "PVTGeodetic");
    EXPECT_EQ(read.time_scale, "gps");
    EXPECT_EQ(read.records.bad, 0);
    ASSERT_EQ(read.rows.size(), 2U);
    EXPECT_EQ(to_iso(*read.facts.first_epoch, 3), "2024-05-17T16:53:20.000");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 100'000'000);
    const Observation& row = read.rows[0];
    EXPECT_NEAR(*row.latitude_deg, 45.25, 5e-12 * 180 / std::numbers::pi);
    EXPECT_NEAR(*row.longitude_deg, 9.125, 5e-12 * 180 / std::numbers::pi);
    EXPECT_DOUBLE_EQ(*row.height_m, 167.25);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_east_m_s, -4.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_north_m_s, 3.0);
    EXPECT_DOUBLE_EQ(*row.recorded_velocity_up_m_s, 0.5);
    EXPECT_EQ(row.fix, FixType::fixed);
    EXPECT_EQ(*row.satellites, 14);
    EXPECT_DOUBLE_EQ(*row.age_s, 1.5);
    EXPECT_EQ(read.rows[1].fix, FixType::single);
    EXPECT_FALSE(read.rows[1].age_s);
    EXPECT_DOUBLE_EQ(*read.facts.time_resolution_s, 0.01);
    EXPECT_NEAR(*read.facts.position_resolution_m, 6.4e-5, 1e-6);
}

TEST(Septentrio, CartesianRowsAreTheSamePlacesAndVelocities) {
    Solution later;
    later.seconds += 0.1;
    const Observations read = import_text(pos_receiver(), cartesian_row({}) + cartesian_row(later));
    ASSERT_EQ(read.rows.size(), 2U);
    EXPECT_EQ(read.variant, "PVTCartesian");
    const Observation& row = read.rows[0];
    EXPECT_NEAR(*row.latitude_deg, 45.25, 1e-8);
    EXPECT_NEAR(*row.longitude_deg, 9.125, 1e-8);
    EXPECT_NEAR(*row.height_m, 167.25, 1e-3);
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, -4.0, 1e-3);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, 3.0, 1e-3);
    EXPECT_NEAR(*row.recorded_velocity_up_m_s, 0.5, 1e-3);
}

TEST(Septentrio, EpochsWithoutSolutionHaveNoPosition) {
    Solution failed, none, masked;
    failed.error = 5;
    failed.seconds += 0.1;
    none.mode = 0;
    none.seconds += 0.2;
    masked.seconds += 0.3;
    const Observations read =
        import_text(pos_receiver(), geodetic_row({}) + geodetic_row(failed, true) +
                                        geodetic_row(none, true) + geodetic_row(masked, true));
    ASSERT_EQ(read.rows.size(), 4U);
    EXPECT_EQ(read.records.bad, 0);
    for (std::size_t i = 1; i < 4; ++i) {
        EXPECT_EQ(read.rows[i].fix, FixType::none);
        EXPECT_FALSE(read.rows[i].latitude_deg);
    }
}

TEST(Septentrio, EveryModeIsAFixType) {
    const std::pair<int, FixType> modes[] = {
        {1, FixType::single}, {2, FixType::dgps},
        {4, FixType::fixed},  {5, FixType::float_ambiguities},
        {6, FixType::sbas},   {7, FixType::fixed},
        {10, FixType::ppp},   {128 + 4, FixType::fixed},  // two-dimensional
    };
    for (const auto& [mode, fix] : modes) {
        Solution solution;
        solution.mode = mode;
        EXPECT_EQ(import_text(pos_receiver(), geodetic_row(solution)).rows[0].fix, fix) << mode;
    }
}

TEST(Septentrio, RowsThatAreCutAreSaidWithTheirLine) {
    const std::string good = geodetic_row({});
    EXPECT_EQ(import_text(pos_receiver(), good + good + good.substr(0, 60)).records.bad, 1);
    Receiver receiver = pos_receiver();
    receiver.format = "septentrio";
    EXPECT_TRUE(has(failure_of(receiver, good.substr(0, 60) + "\n"), "f:1"));
    EXPECT_TRUE(has(failure_of(receiver, "-4 1400000000.00 1 2 3\n"), "sbf2asc -g"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
