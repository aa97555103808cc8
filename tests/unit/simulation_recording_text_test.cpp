#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "core/failure.h"
#include "core/geodesy.h"
#include "simulation/recording_text.h"

namespace runcert::RUNCERT_FILE {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

/// A run of 50 s across a salt lake, with errors.
SimulationSpec place_spec() {
    SimulationSpec spec;
    spec.place = Geodetic{Angle::from_degrees(-31.6), Angle::from_degrees(136.0), 110.0};
    spec.start_gps = parse_gps_iso("2026-12-31T23:59:30.000");
    spec.run.bearing_deg = 160.0;
    spec.white_noise = {.horizontal_m = 0.003, .vertical_m = 0.006};
    return spec;
}

std::string pos_of(const SimulationSpec& spec) {
    return rtklib_pos_text(spec, simulate(spec));
}

struct PosRow {
    std::string date, time;
    double latitude_deg, longitude_deg, height_m;
    int quality;
};

std::vector<PosRow> rows_of(const std::string& pos) {
    std::vector<PosRow> rows;
    for (const std::string& line : lines_of(pos)) {
        if (line.starts_with('%')) continue;
        std::istringstream stream(line);
        PosRow row;
        stream >> row.date >> row.time >> row.latitude_deg >> row.longitude_deg >> row.height_m >>
            row.quality;
        EXPECT_TRUE(stream) << line;
        rows.push_back(row);
    }
    return rows;
}

TEST(RtklibPos, HoldsThePositionsToWithin20Micrometres) {
    for (const double latitude_deg : {-31.6, 0.0, 40.8, 89.0}) {
        SimulationSpec spec = place_spec();
        spec.place->latitude = Angle::from_degrees(latitude_deg);
        const auto epochs = simulate(spec);
        const auto rows = rows_of(rtklib_pos_text(spec, epochs));
        const LocalFrame frame(*spec.place);
        ASSERT_EQ(rows.size(), epochs.size());
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const Enu enu = frame.enu_from_geodetic({Angle::from_degrees(rows[i].latitude_deg),
                                                     Angle::from_degrees(rows[i].longitude_deg),
                                                     rows[i].height_m});
            EXPECT_LT((enu.m - epochs[i].measured_enu_m).norm(), 0.01e-3);
        }
    }
}

TEST(RtklibPos, HasGpsCalendarTimeThatGoesOnIntoTheNewYear) {
    const auto rows = rows_of(pos_of(place_spec()));
    EXPECT_EQ(rows[0].date + ' ' + rows[0].time, "2026/12/31 23:59:30.000");
    EXPECT_EQ(rows[299].date + ' ' + rows[299].time, "2026/12/31 23:59:59.900");
    EXPECT_EQ(rows[300].date + ' ' + rows[300].time, "2027/01/01 00:00:00.000");
}

TEST(RtklibPos, RoundsAsAsked) {
    SimulationSpec spec = place_spec();
    spec.recording.decimals_deg = 9;
    spec.recording.decimals_m = 4;
    spec.recording.accuracy = {.horizontal_m = 0.003, .vertical_m = 0.0061};
    spec.white_noise = {};
    EXPECT_EQ(lines_of(pos_of(spec)).at(3),
              "2026/12/31 23:59:30.000  -31.600000000  136.000000000   110.0000   1  20   0.0030   "
              "0.0030   0.0061   0.0000   0.0000   0.0000   0.00   50.0");
}

TEST(RtklibPos, LeavesGapsOutAndMarksFloatEpochs) {
    SimulationSpec spec = place_spec();
    spec.faults.gaps.push_back({.from_s = 5.0, .to_s = 5.3});
    spec.faults.float_fixes.push_back({.from_s = 20.0, .to_s = 20.2});
    const auto rows = rows_of(pos_of(spec));
    ASSERT_EQ(rows.size(), 448U);
    EXPECT_EQ(rows[49].time, "23:59:34.900");
    EXPECT_EQ(rows[50].time, "23:59:35.300");
    for (const PosRow& row : rows)
        EXPECT_EQ(row.quality, row.time == "23:59:50.000" || row.time == "23:59:50.100" ? 2 : 1);
}

TEST(RtklibPos, IsTheSameForTheSameSeedOnly) {
    SimulationSpec spec = place_spec();
    const std::string text = pos_of(spec);
    EXPECT_EQ(pos_of(spec), text);
    spec.seed = 2;
    EXPECT_NE(pos_of(spec), text);
}

TEST(RtklibPos, NeedsAPlaceAndATime) {
    SimulationSpec spec = place_spec();
    spec.start_gps.reset();
    EXPECT_THROW((void)pos_of(spec), Failure);
    spec = place_spec();
    spec.place.reset();
    EXPECT_THROW((void)pos_of(spec), Failure);
}

TEST(PlaneCsv, HasTheColumnsThatTheSpecAsksFor) {
    SimulationSpec spec;
    spec.run.start = {1000.0, 1000.0, 2.0};
    spec.recording.decimals_m = 3;
    auto lines = lines_of(plane_csv_text(spec, simulate(spec)));
    EXPECT_EQ(lines.size(), 453U);
    EXPECT_EQ(lines[0], "# runcert simulate (no receiver: this recording is simulated)");
    EXPECT_EQ(lines[1], "epoch,time_s,east_m,north_m,up_m");
    EXPECT_EQ(lines[2], "1,0.000,1000.000,1000.000,2.000");
    EXPECT_EQ(lines[452], "451,45.000,2272.780,2272.780,2.000");

    spec.recording.with_up = false;
    spec.faults.gaps.push_back({.from_s = 0.1, .to_s = 0.3});
    spec.faults.float_fixes.push_back({.from_s = 0.3, .to_s = 0.4});
    lines = lines_of(plane_csv_text(spec, simulate(spec)));
    EXPECT_EQ(lines[1], "epoch,time_s,east_m,north_m,fix");
    EXPECT_EQ(lines[2], "1,0.000,1000.000,1000.000,fixed");
    EXPECT_EQ(lines[3], "4,0.300,1000.002,1000.002,float");
    EXPECT_EQ(lines[4], "5,0.400,1000.003,1000.003,fixed");
}

TEST(TruthCsv, HasEveryEpochOfTheTrueRun) {
    SimulationSpec spec;
    spec.run.start = {1000.0, 1000.0, 0.0};
    spec.white_noise = {.horizontal_m = 0.010, .vertical_m = 0.020};
    spec.faults.gaps.push_back({.from_s = 14.0, .to_s = 16.0});
    const auto lines = lines_of(truth_csv_text(simulate(spec)));
    ASSERT_EQ(lines.size(), 453U);
    EXPECT_EQ(lines[0], "# runcert simulate (no receiver: this recording is simulated)");
    EXPECT_EQ(lines[1], "time_s,east_m,north_m,up_m,speed_m_s,acceleration_m_s2");
    // [DHD22], table 2, epoch 151.
    EXPECT_EQ(lines[152], "15.000,1050.694614,1050.694614,0.000000,30.000000,8.699348");
}

TEST(TruthCsv, HasTheReferencePointBesideTheAntenna) {
    SimulationSpec spec = place_spec();
    spec.run.bearing_deg = 90.0;
    spec.craft = {.antenna = {2.0, 0.5, -10.0}};
    const auto lines = lines_of(truth_csv_text(simulate(spec)));
    ASSERT_EQ(lines.size(), 453U);
    EXPECT_EQ(
        lines[1],
        "time_s,east_m,north_m,up_m,speed_m_s,acceleration_m_s2,reference_east_m,"
        "reference_north_m,reference_up_m,reference_speed_m_s,roll_deg,pitch_deg,heading_deg");
    // [DHD22], table 2, epoch 151: 50.694614 times the root of 2 from the start, towards the east.
    double values[13] = {};
    std::istringstream row(lines[152]);
    for (double& value : values) {
        row >> value;
        row.ignore();
    }
    const double way_m = 50.694614 * std::sqrt(2.0);
    const double expected[13] = {15.0, way_m + 2.0, -0.5, 10.0, 30.0, 8.699348, way_m,
                                 0.0,  0.0,         30.0, 0.0,  0.0,  90.0};
    for (int i = 0; i < 13; ++i)
        EXPECT_NEAR(values[i], expected[i], 2e-5) << lines[1] << i;
}

TEST(ImuCsv, HasMeansOverTheIntervalInSecondsOfTheWeek) {
    const ImuSample sample{.time_s = 0.005,
                           .interval_s = 0.005,
                           .angle_rad = {0.0005, -0.001, 0.0},
                           .velocity_m_s = {0.01, 0.0, -0.0490}};
    const GpsTime start = parse_gps_iso("2026-03-14T03:20:18.000");
    const auto lines = lines_of(imu_csv_text(std::vector{sample}, start));
    ASSERT_EQ(lines.size(), 3U);
    EXPECT_EQ(lines[1], "time_s,gx,gy,gz,ax,ay,az");
    EXPECT_EQ(lines[2],
              "530418.0050,0.100000000,-0.200000000,0.000000000,2.00000000,0.00000000,-9.80000000");
}

TEST(WheelCsv, IsInGpsTimeOrFromTheFirstEpochThatIsRecorded) {
    SimulationSpec spec = place_spec();
    spec.faults.gaps.push_back({.from_s = 0.0, .to_s = 0.2});
    const auto epochs = simulate(spec);
    const std::vector<double> speeds(epochs.size(), 12.34567);
    auto lines = lines_of(wheel_csv_text(speeds, epochs, spec.start_gps));
    EXPECT_EQ(lines[1], "time_gps,speed_m_s");
    EXPECT_EQ(lines[2], "2026-12-31T23:59:30.000,12.3457");
    lines = lines_of(wheel_csv_text(speeds, epochs, std::nullopt));
    EXPECT_EQ(lines[1], "time_s,speed_m_s");
    EXPECT_EQ(lines[2], "-0.200,12.3457");
    EXPECT_EQ(lines[4], "0.000,12.3457");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
