#include <gtest/gtest.h>

#include <cmath>

#include "core/failure.h"
#include "stages/check/wind.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// 2022-12-11T01:02:03.5 UTC; 18 s of leap seconds.
const GpsTime first_epoch = parse_gps_iso("2022-12-11T01:02:21.500");

MeasuredSeries read(std::string_view text) {
    return read_series(text, "wind.csv", first_epoch, {"speed", "direction"});
}

MeasuredSeries samples(std::vector<SeriesSample> list) {
    return {.where = "wind.csv", .samples = std::move(list)};
}

TEST(Flow, UtcGpsTimeAndSecondsAreTheSameInstants) {
    const MeasuredSeries utc = read(
        "time,speed_m_s,direction_deg\n2022-12-11T01:02:03.5Z,7.5,270\n"
        "2022-12-11T01:03:00Z,8,0\n");
    const MeasuredSeries gps = read(
        "direction_deg, time_gps ,speed_m_s\r\n# by hand\r\n\r\n270,2022-12-11T01:02:21.5,7.5\r\n"
        "0,2022-12-11T01:03:18,8");
    const MeasuredSeries seconds =
        read_series("time_s,speed_m_s,direction_deg\n0,7.5,270\n56.5,8,0\n", "wind.csv", {},
                    {"speed", "direction"});
    for (const MeasuredSeries& series : {utc, gps, seconds}) {
        ASSERT_EQ(series.samples.size(), 2u);
        EXPECT_EQ(series.samples[0].time_s, 0.0);
        EXPECT_EQ(series.samples[1].time_s, 56.5);
        EXPECT_EQ(series.samples[0].value, 7.5);
        EXPECT_EQ(series.samples[0].direction_deg, 270.0);
        EXPECT_EQ(series.samples[1].value, 8.0);
    }
}

TEST(Flow, ALeapSecondIsAnInstant) {
    const MeasuredSeries series = read_series(
        "time,speed_m_s,direction_deg\n2016-12-31T23:59:59Z,1,0\n2016-12-31T23:59:60Z,1,0\n"
        "2017-01-01T00:00:00Z,1,0\n",
        "wind.csv", parse_gps_iso("2017-01-01T00:00:16"), {"speed", "direction"});
    ASSERT_EQ(series.samples.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(series.samples[i].time_s, static_cast<double>(i));
}

TEST(Flow, KnotsAndKilometresAnHour) {
    EXPECT_NEAR(read("time_s,speed_kn,direction_deg\n-5.5,10,0\n").samples[0].value,
                18520.0 / 3600.0, 1e-12);
    EXPECT_NEAR(read("time_s,speed_km_h,direction_deg\n0,36,360\n").samples[0].value, 10.0, 1e-12);
    EXPECT_EQ(read("\xEF\xBB\xBFtime_s,speed_kn,direction_deg\n-5.5,10,0\n").samples[0].time_s,
              -5.5);
}

struct Refused {
    const char* text;
    const char* where;
    const char* what;
};

TEST(Flow, WhatItDoesNotUnderstandIsRefusedWithItsPlace) {
    const char* const header = "time_s,speed_m_s,direction_deg\n";
    for (const Refused& one : {
             Refused{"", "wind.csv", "empty"},
             {"# nothing\n\n", "wind.csv", "empty"},
             {"time_s,speed_m_s,direction_deg\n", "wind.csv", "no sample"},
             {"time_s,speed_m_s,direction_deg,gust\n", "wind.csv:1:32", "\"gust\" is not known"},
             {"time_s;speed_m_s;direction_deg\n", "wind.csv:1:1", "is not known"},
             {"time_s,speed_ms,direction_deg\n", "wind.csv:1:8", "\"speed_ms\" is not known"},
             {"0,5,270\n", "wind.csv:1:1", "\"0\" is not known"},
             {"speed_m_s,direction_deg\n", "wind.csv:1:1", "names no time"},
             {"time_s,direction_deg\n", "wind.csv:1:1", "names no speed_m_s"},
             {"time_s,speed_m_s\n", "wind.csv:1:1", "names no direction_deg"},
             {"time_s,time,speed_m_s,direction_deg\n", "wind.csv:1:8", "second column"},
             {"time_s,speed_kn,speed_m_s,direction_deg\n", "wind.csv:1:17", "second column"},
             {"H0,5\n", "wind.csv:2:1", "has 2 fields"},
             {"H0,5,270,1\n", "wind.csv:2:1", "has 4 fields"},
             {"H0,5,270\n1,5,\n", "wind.csv:3:5", "\"\" is not a direction"},
             {"H#\n0,nan,270\n", "wind.csv:3:3", "\"nan\" is not a speed"},
             {"H0,5 m/s,270\n", "wind.csv:2:3", "is not a speed"},
             {"H0,  x,270\n", "wind.csv:2:5", "is not a speed"},
             {"H0,-0.1,270\n", "wind.csv:2:3", "negative"},
             {"H0,151,270\n", "wind.csv:2:3", "above 150 m/s"},
             {"H0,5,inf\n", "wind.csv:2:5", "is not a direction"},
             {"H0,5,-10\n", "wind.csv:2:5", "0 to 360"},
             {"H0,5,360.5\n", "wind.csv:2:5", "0 to 360"},
             {"Hnan,5,270\n", "wind.csv:2:1", "not a number of seconds"},
             {"H1,5,270\n0.5,5,270\n", "wind.csv:3:1", "not after"},
             {"H1,5,270\n1,5,270\n", "wind.csv:3:1", "not after"},
             {"time,speed_m_s,direction_deg\n2022-12-11T01:02:03,5,270\n", "wind.csv:2:1",
              "UTC ends in Z"},
             {"time,speed_m_s,direction_deg\n2022-13-11T01:02:03Z,5,270\n", "wind.csv:2:1",
              "is not a time"},
             {"time,speed_m_s,direction_deg\n2022-12-11T01:02:60Z,5,270\n", "wind.csv:2:1",
              "is not a time"},
             {"time,speed_m_s,direction_deg\n12.5,5,270\n", "wind.csv:2:1", "is not a time"},
             {"time_gps,speed_m_s,direction_deg\n2022-12-11T01:02:03Z,5,270\n", "wind.csv:2:1",
              "is not a time"},
         }) {
        const std::string text =
            one.text[0] == 'H' ? std::string(header) + (one.text + 1) : one.text;
        try {
            read(text);
            ADD_FAILURE() << "was read: " << text;
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.where(), one.where) << text;
            EXPECT_NE(failure.problem().find(one.what), std::string::npos) << failure.problem();
            EXPECT_FALSE(failure.remedy().empty());
        }
    }
}

TEST(Flow, InstantsNeedARecordingWithInstants) {
    for (const char* column : {"time", "time_gps"}) {
        const std::string text = std::string(column) + ",speed_m_s,direction_deg\n";
        try {
            read_series(text, "wind.csv", std::nullopt, {"speed", "direction"});
            ADD_FAILURE();
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.where(), "wind.csv:1:1");
            EXPECT_NE(failure.remedy().find("start_gps"), std::string::npos);
        }
    }
}

TEST(FlowInWindow, SteadyWindAgainstEachHeading) {
    // 10 m/s from the west (270): it blows towards 90.
    const MeasuredSeries series = samples({{0.0, 10.0, 270.0}, {30.0, 10.0, 270.0}});
    struct Case {
        double heading_deg, along_m_s, across_m_s;
    };
    for (const Case& one : {Case{90.0, 10.0, 0.0},
                            {270.0, -10.0, 0.0},
                            {0.0, 0.0, 10.0},
                            {180.0, 0.0, -10.0},
                            {30.0, 5.0, 5.0 * std::sqrt(3.0)}}) {
        const FlowInWindow wind =
            flow_in_window(series, FlowKind::wind, 10.0, 13.0, one.heading_deg);
        EXPECT_EQ(wind.missing, "");
        EXPECT_NEAR(wind.along_m_s, one.along_m_s, 1e-12);
        EXPECT_NEAR(wind.across_m_s, one.across_m_s, 1e-12);
        EXPECT_NEAR(wind.mean_m_s, 10.0, 1e-12);
        EXPECT_NEAR(wind.gust_m_s, 10.0, 1e-12);
        EXPECT_NEAR(wind.direction_deg, 270.0, 1e-12);
        EXPECT_EQ(wind.samples, 0);
        // A current that sets to 270 moves the other way.
        const FlowInWindow current =
            flow_in_window(series, FlowKind::current, 10.0, 13.0, one.heading_deg);
        EXPECT_NEAR(current.along_m_s, -one.along_m_s, 1e-12);
        EXPECT_NEAR(current.across_m_s, -one.across_m_s, 1e-12);
        EXPECT_NEAR(current.direction_deg, 270.0, 1e-12);
    }
}

TEST(FlowInWindow, MeanIsOfTheInterpolatedVectorOverTime) {
    // Current towards north: 0 m/s at 0 s, 4 at 4 s, 2 at 6 s. Over 2 s to 5 s it is 2, 4, 3 m/s:
    // (2 * 3 + 1 * 3.5) / 3.
    const MeasuredSeries series = samples({{0.0, 0.0, 0.0}, {4.0, 4.0, 0.0}, {6.0, 2.0, 0.0}});
    const FlowInWindow flow = flow_in_window(series, FlowKind::current, 2.0, 5.0, 0.0);
    EXPECT_NEAR(flow.mean_m_s, 9.5 / 3.0, 1e-12);
    EXPECT_NEAR(flow.along_m_s, 9.5 / 3.0, 1e-12);
    EXPECT_NEAR(flow.gust_m_s, 4.0, 1e-12);
    EXPECT_EQ(flow.samples, 1);
    // The largest at an end, between samples.
    EXPECT_NEAR(flow_in_window(series, FlowKind::current, 1.0, 3.0, 0.0).gust_m_s, 3.0, 1e-12);
    // Ends on samples.
    const FlowInWindow whole = flow_in_window(series, FlowKind::current, 0.0, 6.0, 0.0);
    EXPECT_NEAR(whole.mean_m_s, (8.0 + 6.0) / 6.0, 1e-12);
    EXPECT_EQ(whole.samples, 3);
    // One instant.
    EXPECT_NEAR(flow_in_window(series, FlowKind::current, 4.0, 4.0, 0.0).mean_m_s, 4.0, 1e-12);
    EXPECT_NEAR(flow_in_window(series, FlowKind::current, 5.0, 5.0, 0.0).mean_m_s, 3.0, 1e-12);
}

TEST(FlowInWindow, DirectionsAreNotAveragedAsNumbers) {
    // From 350 and from 10 degrees: from north in the mean, 10 cos 10 = 9.848 m/s.
    const MeasuredSeries series = samples({{0.0, 10.0, 350.0}, {10.0, 10.0, 10.0}});
    const FlowInWindow wind = flow_in_window(series, FlowKind::wind, 0.0, 10.0, 180.0);
    EXPECT_NEAR(std::remainder(wind.direction_deg, 360.0), 0.0, 1e-9);
    EXPECT_GE(wind.direction_deg, 0.0);
    EXPECT_LT(wind.direction_deg, 360.0);
    EXPECT_NEAR(wind.mean_m_s, 9.8480775, 1e-7);
    EXPECT_NEAR(wind.along_m_s, 9.8480775, 1e-7);
    EXPECT_NEAR(wind.gust_m_s, 10.0, 1e-12);
    // 5 m/s from 0 and from 90 degrees: from 45.
    const MeasuredSeries quarter = samples({{0.0, 5.0, 0.0}, {10.0, 5.0, 90.0}});
    EXPECT_NEAR(flow_in_window(quarter, FlowKind::wind, 0.0, 10.0, 0.0).direction_deg, 45.0, 1e-9);
    const MeasuredSeries calm = samples({{0.0, 0.0, 77.0}, {10.0, 0.0, 77.0}});
    EXPECT_EQ(flow_in_window(calm, FlowKind::wind, 0.0, 10.0, 0.0).direction_deg, 0.0);
}

TEST(FlowInWindow, SaysWhyItSaysNothing) {
    const MeasuredSeries series =
        samples({{0.0, 5.0, 0.0}, {60.0, 5.0, 0.0}, {180.0, 5.0, 0.0}, {250.0, 5.0, 0.0}});
    const auto missing = [&](double start_s, double end_s) {
        return flow_in_window(series, FlowKind::wind, start_s, end_s, 0.0).missing;
    };
    EXPECT_EQ(missing(10.0, 13.0), "");
    EXPECT_EQ(missing(0.0, 60.0), "");
    EXPECT_EQ(missing(117.5, 120.0),
              "wind.csv has no sample between 60.0 s and 180.0 s; the "
              "window is 117.5 s to 120.0 s, and every instant of it needs "
              "one at most 60 s before and after");
    EXPECT_EQ(missing(120.0, 120.0), "");  // exactly 60 s from either
    EXPECT_NE(missing(50.0, 63.0), "");    // 60 s and more to the next
    EXPECT_NE(missing(120.0, 183.0), "");
    EXPECT_EQ(missing(191.0, 194.0), "");
    EXPECT_NE(missing(189.0, 192.0), "");
    EXPECT_EQ(missing(-1.0, 2.0),
              "wind.csv covers 0.0 s to 250.0 s from the recording's first epoch; the window is "
              "-1.0 s to 2.0 s");
    EXPECT_NE(missing(248.0, 251.0), "");
    EXPECT_NE(missing(300.0, 303.0), "");
    EXPECT_EQ(flow_in_window(samples({}), FlowKind::wind, 0.0, 3.0, 0.0).missing,
              "wind.csv has no sample");
    EXPECT_EQ(flow_in_window(series, FlowKind::wind, 117.5, 120.0, 0.0, 70.0).missing, "");
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
