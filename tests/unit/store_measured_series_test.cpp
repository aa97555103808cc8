#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "core/failure.h"
#include "store/measured_series.h"

namespace runcert::RUNCERT_FILE {
namespace {

const SeriesQuantities wheel_has{"speed"}, gates_have{"distance"},
    traps_have{"speed", "uncertainty", "length"};

MeasuredSeries read(const std::string& text, const SeriesQuantities& kind) {
    return read_series(text, "w.csv", parse_gps_iso("2022-12-11T01:02:03.000"), kind);
}

std::string refusal(const std::string& text, const SeriesQuantities& kind) {
    try {
        read(text, kind);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "read";
}

TEST(MeasuredSeries, OfAWheelIsTimeAndSpeed) {
    const MeasuredSeries series =
        read("# of the front left wheel\ntime_s,speed_km_h\n0.5,36\n1.5,72\n", wheel_has);
    ASSERT_EQ(series.samples.size(), 2U);
    EXPECT_NEAR(series.samples[1].value, 20.0, 1e-12);
    EXPECT_EQ(series.samples[1].time_s, 1.5);
    EXPECT_NEAR(read("speed_m_s,time_gps\n3,2022-12-11T01:02:04.25\n", wheel_has).samples[0].time_s,
                1.25, 1e-9);
}

TEST(MeasuredSeries, OfGatesIsTimeAndDistance) {
    const MeasuredSeries series = read(
        "time,distance_m\n2022-12-11T01:02:00Z,0\n2022-12-11T01:02:08.4315Z,500.002\n", gates_have);
    ASSERT_EQ(series.samples.size(), 2U);
    EXPECT_NEAR(series.samples[1].time_s - series.samples[0].time_s, 8.4315, 1e-9);
    EXPECT_EQ(series.samples[1].value, 500.002);
}

TEST(MeasuredSeries, OfASpeedTrapSaysWhatEachSpeedIsWorth) {
    const MeasuredSeries series =
        read("time_s,length_m,speed_km_h,expanded_uncertainty_km_h\n4,10,90,1.8\n5,0,72,3.6\n",
             traps_have);
    ASSERT_EQ(series.samples.size(), 2U);
    EXPECT_NEAR(series.samples[0].value, 25.0, 1e-12);
    EXPECT_NEAR(series.samples[0].expanded_uncertainty_m_s, 0.5, 1e-12);
    EXPECT_EQ(series.samples[0].length_m, 10.0);
    EXPECT_EQ(series.samples[1].length_m, 0.0);
}

TEST(MeasuredSeries, SaysWhatIsWrongAndWhere) {
    struct Refused {
        SeriesQuantities kind;
        std::string text, where, words;
    };
    for (const Refused& one :
         {Refused{wheel_has, "time_s,speed_m_s,direction_deg\n", "w.csv:1:18",
                  "\"direction_deg\" is not known"},
          {wheel_has, "time_s\n", "w.csv:1:1", "names no speed_m_s"},
          {wheel_has, "time_s,speed_m_s\n0,-3\n", "w.csv:2:3", "negative"},
          {wheel_has, "", "w.csv", "time,speed_m_s"},
          {gates_have, "time_s,speed_m_s\n", "w.csv:1:8", "\"speed_m_s\" is not known"},
          {gates_have, "time_s,distance_m\n1,0\n2,0\n", "w.csv:3:3",
           "not beyond that of the gate before"},
          {gates_have, "time_s,distance_m\n1,0\n", "w.csv", "only one gate"},
          {gates_have, "time_s,distance_m\n1,x\n", "w.csv:2:3", "is not a distance"},
          {traps_have, "time_s,speed_km_h\n", "w.csv:1:1",
           "names no expanded_uncertainty_m_s, expanded_uncertainty_kn or "
           "expanded_uncertainty_km_h"},
          {traps_have, "time_s,speed_km_h,expanded_uncertainty_km_h,length_m\n1,90,0,10\n",
           "w.csv:2:6", "the uncertainty \"0\" is below 0.005 m/s"},
          {traps_have, "time_s,speed_km_h,expanded_uncertainty_km_h,length_m\n1,90,1,-10\n",
           "w.csv:2:8", "the length \"-10\" is negative"}}) {
        const std::string said = refusal(one.text, one.kind);
        EXPECT_NE(said.find(one.where), std::string::npos) << said;
        EXPECT_NE(said.find(one.words), std::string::npos) << said;
    }
}

/// A wheel of 100 samples, some of whose lines are replaced.
std::string wheel_of_100(const std::map<int, std::string>& replaced) {
    std::string text = "time_s,speed_m_s\n";
    for (int k = 0; k < 100; ++k) {
        const auto line = replaced.find(k);
        text += (line == replaced.end() ? fmt::format("{}.5,20.0", k) : line->second) + "\n";
    }
    return text;
}

TEST(MeasuredSeries, IsNotLostForOneBadLine) {
    for (const char* const line : {"9000,20.0", "3.5,20.0", "50.5,", "50.5,nan", ",20.0", "50.5",
                                   "50.5,20.0,1", "x,20.0", "50.5,-3", "49.5,20.0", ""}) {
        SCOPED_TRACE(line);
        const MeasuredSeries series =
            read_series(wheel_of_100({{50, line}}), "w.csv", GpsTime{}, wheel_has);
        EXPECT_EQ(series.samples.size(), 99U);
        const bool empty = std::string_view(line).empty();  // passed over, as ever
        EXPECT_EQ(series.left_out.find("w.csv: 1 of 100 lines"),
                  empty ? std::string::npos : std::size_t{0})
            << series.left_out;
    }
}

TEST(MeasuredSeries, OfWhichMoreThanOneLineInTwentyIsBadIsRefused) {
    std::map<int, std::string> bad;
    for (int k = 10; k < 15; ++k)
        bad[k] = "?,20.0";
    EXPECT_EQ(read_series(wheel_of_100(bad), "w", GpsTime{}, wheel_has).samples.size(), 95U);
    bad[70] = "2.2,20.0";
    EXPECT_THROW(read_series(wheel_of_100(bad), "w", GpsTime{}, wheel_has), Failure);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
