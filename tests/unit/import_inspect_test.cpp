#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "import_inspect_support.h"
#include "import_test_support.h"
#include "store/atomic_file.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

struct Real {
    const char* file;
    const char* first_gps;
    std::size_t epochs, fixed, float_, changes, gaps;
    double longest_gap_s, interval_s, best_kmh;
    bool velocity, velocity_sigma;
};

std::size_t count(const Inspection& it, FixType kind) {
    for (const auto& [candidate, number] : it.fixes)
        if (candidate == kind) return number;
    return 0;
}

class RealPos : public testing::TestWithParam<Real> {};

// Counts that were measured from the files apart from this code.
TEST_P(RealPos, Figures) {
    const Real& expected = GetParam();
    const auto bytes = recorded(expected.file);
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes, expected.file);
    const Inspection it = inspect(read);
    EXPECT_EQ(to_iso(*it.first), expected.first_gps);
    EXPECT_EQ(it.epochs, expected.epochs);
    EXPECT_EQ(count(it, FixType::fixed), expected.fixed);
    EXPECT_EQ(count(it, FixType::float_ambiguities), expected.float_);
    EXPECT_EQ(it.fix_changes, expected.changes);
    EXPECT_EQ(it.gaps, expected.gaps);
    EXPECT_NEAR(it.longest_gap_s, expected.longest_gap_s, 1e-9);
    EXPECT_NEAR(it.nominal_interval_s, expected.interval_s, 1e-9);
    EXPECT_EQ(it.repeated_times + it.backward_times + it.without_position, 0u);
    EXPECT_EQ(it.with_velocity, expected.velocity ? expected.epochs : 0);
    ASSERT_TRUE(it.best_by_position);
    EXPECT_NEAR(it.best_by_position->speed_m_s * 3.6, expected.best_kmh, 0.05);
    EXPECT_EQ(read.accuracy_source, "recording");
    for (const Observation& row : read.rows)
        ASSERT_EQ(row.sigma_recorded_velocity_east_m_s.has_value(), expected.velocity_sigma);
    const std::string text = inspection_text(read);
    EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 40) << text;
}

// Best 3 s: horizontal chord over windows of 3.0 s, by hand with the textbook formulas for the
// urban car (epochs 4681 to 4696). Along the path, jumps added up, that recording gives 79.3 km/h.
INSTANTIATE_TEST_SUITE_P(All, RealPos,
                         testing::Values(Real{"ppk_urban_car/rover.pos", "2023-07-11T06:04:30.000",
                                              5395, 1799, 3596, 282, 20, 46.994, 0.2, 50.88, false,
                                              false},
                                         Real{"rtk_imu_drive/rover.pos", "2025-07-08T19:34:18.499",
                                              2197, 2189, 8, 2, 0, 0.0, 0.25, 58.5, true, true},
                                         Real{"ppk_tokyo_ecef/rover.pos", "2018-12-19T03:56:15.000",
                                              1059, 455, 604, 64, 42, 50.0, 1.0, 60.0, true, false},
                                         Real{"ubx_walk/rover.pos", "2025-08-28T17:30:39.749", 536,
                                              349, 187, 3, 0, 0.0, 0.25, 5.1, true, true}),
                         [](const auto& instance) {
                             const std::string name = instance.param.file;
                             return name.substr(0, name.find('/'));
                         });

TEST(RealCsv, TheReferenceOfTheUrbanCar) {
    const auto bytes = recorded("ppk_urban_car/reference.csv");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    Receiver receiver = csv_receiver();
    receiver.time_format = "seconds_of_week";
    receiver.columns = {{"time", "GPS TOW (s)"},
                        {"week", "GPS Week"},
                        {"latitude", "Latitude (deg)"},
                        {"longitude", "Longitude (deg)"},
                        {"height", "Ellipsoid Height (m)"},
                        {"velocity_east", "East Velocity (m/s)"},
                        {"velocity_north", "North Velocity (m/s)"},
                        {"velocity_up", "Up Velocity (m/s)"}};
    const Inspection it = inspect(import_text(receiver, *bytes));
    EXPECT_EQ(it.epochs, 6151u);
    EXPECT_EQ(it.with_velocity, 6151u);
    EXPECT_EQ(to_iso(*it.first), "2023-07-11T06:04:30.000");
    EXPECT_NEAR(it.best_by_position->speed_m_s * 3.6, 50.88, 0.02);
    EXPECT_NEAR(it.best_by_velocity->speed_m_s * 3.6, 50.8, 0.1);
}

TEST(RealCsv, TheSimulatedRunOfDeakin2022) {
    const std::string bytes =
        read_file(RUNCERT_SOURCE_DIR "/examples/land_yacht/appendix_a_simulated_ppk.csv");
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::local_plane};
    receiver.columns = {{"time", "time_s"}, {"east", "east_m"}, {"north", "north_m"}};
    const Observations read = import_text(receiver, bytes);
    EXPECT_EQ(read.rows.size(), 451u);
    EXPECT_EQ(read.rows[0].plane_east_m, 999.979);
    EXPECT_EQ(read.rows[0].plane_north_m, 999.992);
    EXPECT_DOUBLE_EQ(read.facts.nominal_interval_s, 0.1);
    EXPECT_FALSE(read.facts.georeferenced || read.facts.vertical_measured);
}

/// A straight run at 20 m/s east for 10 s, at 10 Hz, on a plane.
std::string straight_run() {
    std::string text = "time,east,north\n";
    for (int i = 0; i <= 100; ++i)
        text += std::to_string(i / 10) + "." + std::to_string(i % 10) + "," +
                std::to_string(2 * i) + ",5\n";
    return text;
}

Receiver plane_receiver() {
    Receiver receiver = csv_receiver();
    receiver.frame = StatedFrame{CoordinateFrame::local_plane};
    receiver.columns = {{"time", "time"}, {"east", "east"}, {"north", "north"}};
    return receiver;
}

TEST(Inspect, AKnownRun) {
    const Inspection it = inspect(import_text(plane_receiver(), straight_run()));
    EXPECT_EQ(it.gaps, 0u);
    ASSERT_TRUE(it.best_by_position);
    EXPECT_NEAR(it.best_by_position->speed_m_s, 20.0, 1e-12);
    EXPECT_NEAR(it.best_by_position->duration_s, 3.0, 1e-12);
    EXPECT_FALSE(it.best_by_velocity);
    EXPECT_NEAR(it.span_s, 10.0, 1e-12);
}

TEST(Inspect, ASpikeRepeatedTimesAndAGapAreSeen) {
    std::string text = replaced(straight_run(), "4.0,80,5\n", "4.0,80,305\n4.0,80,5\n");
    text = replaced(text, "6.0,120,5\n6.1,122,5\n6.2,124,5\n", "");
    const Observations read = import_text(plane_receiver(), text);
    const Inspection it = inspect(read);
    EXPECT_GT(it.best_by_position->speed_m_s, 100.0);
    EXPECT_EQ(it.repeated_times, 1u);
    EXPECT_EQ(it.gaps, 1u);
    EXPECT_NEAR(it.longest_gap_s, 0.4, 1e-9);
    const std::string words = inspection_text(read);
    for (const char* piece : {"Format     csv; engineering CRS, relative time", "10.00 Hz",
                              "1, the longest 0.4 s; 1 repeated and 0 backward times",
                              "Times repeat", "time is relative", "No accuracy is stated"})
        EXPECT_NE(words.find(piece), std::string::npos) << piece << "\n" << words;
}

TEST(Inspect, PositionsMisreadAreToldByTheRecordedSpeeds) {
    // 20 m/s east at 40 degrees north: 2 m are so many degrees of longitude.
    const double step_deg =
        2.0 / (6'386'976.0 * std::cos(40.0 / 180.0 * std::numbers::pi)) * 180.0 / std::numbers::pi;
    const auto text = [&](double unit, bool exchanged) {
        std::string rows = "time,latitude,longitude,height,speed (m/s)\n";
        for (int i = 0; i <= 100; ++i) {
            const double latitude = 40.0 * unit, longitude = (20.0 + i * step_deg) * unit;
            rows += fmt::format("{}.{},{:.10f},{:.10f},0,20\n", i / 10, i % 10,
                                exchanged ? longitude : latitude, exchanged ? latitude : longitude);
        }
        return rows;
    };
    const auto misread = [&](double unit, bool exchanged) {
        Receiver receiver = csv_receiver();
        receiver.frame = StatedFrame{CoordinateFrame::geodetic};
        receiver.columns = {{"time", "time"},
                            {"latitude", "latitude"},
                            {"longitude", "longitude"},
                            {"height", "height"},
                            {"speed", "speed (m/s)"}};
        const Observations read = import_text(receiver, text(unit, exchanged));
        const Inspection it = inspect(read);
        EXPECT_EQ(inspection_text(read).find("look at what the columns") == std::string::npos,
                  it.misread_positions.empty());
        return it.misread_positions;
    };
    EXPECT_EQ(misread(1.0, false), "");
    EXPECT_EQ(misread(1.0, true), "latitude and longitude are exchanged");
    EXPECT_EQ(misread(std::numbers::pi / 180.0, false), "they are in radians, not degrees");
}

TEST(Inspect, OneEpochHasNoSpeed) {
    const Observations read = import_text(plane_receiver(), "time,east,north\n0,1,2\n");
    const Inspection it = inspect(read);
    EXPECT_FALSE(it.best_by_position || it.best_by_velocity);
    EXPECT_NE(inspection_text(read).find("no stretch of 3 s"), std::string::npos);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
