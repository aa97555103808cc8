#include <gtest/gtest.h>

#include "core/failure.h"
#include "files/measured_series.h"

namespace runcert::RUNCERT_FILE {
namespace {

MeasuredSeries read(const std::string& text, SeriesKind kind) {
    return read_series(text, "w.csv", parse_gps_iso("2022-12-11T01:02:03.000"), kind);
}

std::string refusal(const std::string& text, SeriesKind kind) {
    try {
        read(text, kind);
    } catch (const Failure& failure) {
        return failure.what();
    }
    return "read";
}

TEST(MeasuredSeries, OfAWheelIsTimeAndSpeed) {
    const MeasuredSeries series =
        read("# of the front left wheel\ntime_s,speed_km_h\n0.5,36\n1.5,72\n", SeriesKind::wheel);
    ASSERT_EQ(series.samples.size(), 2U);
    EXPECT_NEAR(series.samples[1].value, 20.0, 1e-12);
    EXPECT_EQ(series.samples[1].time_s, 1.5);
    EXPECT_NEAR(
        read("speed_m_s,time_gps\n3,2022-12-11T01:02:04.25\n", SeriesKind::wheel).samples[0].time_s,
        1.25, 1e-9);
}

TEST(MeasuredSeries, OfGatesIsTimeAndDistance) {
    const MeasuredSeries series =
        read("time,distance_m\n2022-12-11T01:02:00Z,0\n2022-12-11T01:02:08.4315Z,500.002\n",
             SeriesKind::gates);
    ASSERT_EQ(series.samples.size(), 2U);
    EXPECT_NEAR(series.samples[1].time_s - series.samples[0].time_s, 8.4315, 1e-9);
    EXPECT_EQ(series.samples[1].value, 500.002);
}

TEST(MeasuredSeries, SaysWhatIsWrongAndWhere) {
    struct Refused {
        SeriesKind kind;
        std::string text, where, words;
    };
    for (const Refused& one :
         {Refused{SeriesKind::wheel, "time_s,speed_m_s,direction_deg\n", "w.csv:1:18",
                  "\"direction_deg\" is not known"},
          {SeriesKind::wheel, "time_s\n", "w.csv:1:1", "names no speed_m_s"},
          {SeriesKind::wheel, "time_s,speed_m_s\n0,-3\n", "w.csv:2:3", "negative"},
          {SeriesKind::wheel, "", "w.csv", "time,speed_m_s"},
          {SeriesKind::gates, "time_s,speed_m_s\n", "w.csv:1:8", "\"speed_m_s\" is not known"},
          {SeriesKind::gates, "time_s,distance_m\n1,0\n2,0\n", "w.csv:3:3",
           "not beyond that of the gate before"},
          {SeriesKind::gates, "time_s,distance_m\n1,0\n", "w.csv", "only one gate"},
          {SeriesKind::gates, "time_s,distance_m\n1,x\n", "w.csv:2:3", "is not a distance"}}) {
        const std::string said = refusal(one.text, one.kind);
        EXPECT_NE(said.find(one.where), std::string::npos) << said;
        EXPECT_NE(said.find(one.words), std::string::npos) << said;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
