#include <gtest/gtest.h>

#include "core/failure.h"
#include "draft/arrange.h"

namespace runcert::RUNCERT_FILE {
namespace {

/// Recorded from so many minutes on, for ten; `north_km` away.
HandedIn recorded(const std::string& path, double from_min, double north_km = 0.0,
                  const std::string& format = "nmea") {
    HandedIn file{.path = path};
    const GpsTime start = parse_gps_iso("2026-03-14T10:00:00");
    file.is.format = format;
    file.is.first = start.plus_nanoseconds(static_cast<std::int64_t>(from_min * 60e9));
    file.is.last = file.is.first->plus_nanoseconds(std::int64_t{600'000'000'000});
    file.is.latitude_deg = 52.0 + north_km / 111.2;
    file.is.longitude_deg = 5.0;
    return file;
}

HandedIn raw(const std::string& path, RecordingKind kind) {
    HandedIn file{.path = path};
    file.is.kind = kind;
    file.is.format = "rinex";
    return file;
}

std::string problem_of(const std::vector<HandedIn>& files) {
    try {
        arrange(files);
    } catch (const Failure& failure) {
        EXPECT_FALSE(failure.remedy().empty());
        return failure.problem();
    }
    return "none";
}

TEST(Arrange, OneFileIsThePrimaryReceiver) {
    const Arrangement one = arrange({recorded("a.nmea", 0)});
    ASSERT_EQ(one.receivers.size(), 1U);
    EXPECT_EQ(one.receivers[0].id, "primary");
    EXPECT_TRUE(one.said.empty());
}

TEST(Arrange, FilesThatFollowEachOtherAreOneRecordingInTheOrderOfTime) {
    const Arrangement one =
        arrange({recorded("c.nmea", 22), recorded("a.nmea", 0), recorded("b.nmea", 11)});
    ASSERT_EQ(one.receivers.size(), 1U);
    EXPECT_EQ(one.receivers[0].recordings, (std::vector<std::size_t>{1, 2, 0}));
    EXPECT_EQ(one.said, (std::vector<std::string>{"b.nmea follows a.nmea: they are one recording.",
                                                  "c.nmea follows b.nmea: they are one "
                                                  "recording."}));
}

TEST(Arrange, WhatWasRecordedAtTheSameTimeAndPlaceIsASecondReceiver) {
    // The one that is named first is judged, though the other began earlier; each in two files.
    const Arrangement two = arrange({recorded("a1", 1, 0, "ubx"), recorded("b1", 0, 0.3, "sbp"),
                                     recorded("a2", 12, 0, "ubx"), recorded("b2", 12, 0.3, "sbp")});
    ASSERT_EQ(two.receivers.size(), 2U);
    EXPECT_EQ(two.receivers[0].id, "primary");
    EXPECT_EQ(two.receivers[0].recordings, (std::vector<std::size_t>{0, 2}));
    EXPECT_EQ(two.receivers[1].id, "secondary");
    EXPECT_EQ(two.receivers[1].recordings, (std::vector<std::size_t>{1, 3}));
    const Arrangement three = arrange({recorded("a", 0), recorded("b", 1), recorded("c", 2)});
    EXPECT_EQ(three.receivers.size(), 2U);
    EXPECT_NE(three.said.back().find("c is left out"), std::string::npos) << three.said.back();
}

TEST(Arrange, AnImusFileIsThePrimaryReceivers) {
    const Arrangement one = arrange({raw("imu.csv", RecordingKind::imu), recorded("a.nmea", 0),
                                     raw("other.csv", RecordingKind::imu)});
    ASSERT_EQ(one.receivers.size(), 1U);
    EXPECT_EQ(one.receivers[0].recordings, (std::vector<std::size_t>{1}));
    EXPECT_EQ(one.receivers[0].imu, 0U);
    ASSERT_EQ(one.said.size(), 2U);
    EXPECT_NE(one.said[0].find("imu.csv holds the samples of an IMU"), std::string::npos);
    EXPECT_EQ(one.said[1], "other.csv is left out: one IMU is used.");
    EXPECT_EQ(problem_of({raw("imu.csv", RecordingKind::imu)}),
              "the file holds the samples of an IMU, and no recording");
}

TEST(Arrange, ASurfaceIsThePrimaryReceiversWithItsTriangles) {
    const auto ground = [](const char* path, std::int64_t triangles) {
        HandedIn file = raw(path, RecordingKind::surface);
        file.is.triangles = triangles;
        return file;
    };
    const HandedIn table = raw("t.csv", RecordingKind::triangles);
    const Arrangement whole =
        arrange({ground("course.xml", 9), recorded("a.nmea", 0), table, ground("other.xml", 9)});
    ASSERT_EQ(whole.receivers.size(), 1U);
    EXPECT_EQ(whole.receivers[0].surface, 0U);
    EXPECT_FALSE(whole.receivers[0].triangles);
    EXPECT_EQ(whole.said,
              (std::vector<std::string>{
                  "other.xml is left out: one surface is used.",
                  "course.xml holds the surface of a course. It is taken for the one that the "
                  "craft of the primary receiver ran on.",
                  "t.csv is left out: the surface has triangles already."}));
    const Arrangement pair = arrange({recorded("a.nmea", 0), table, ground("v.csv", 0)});
    EXPECT_EQ(pair.receivers[0].surface, 2U);
    EXPECT_EQ(pair.receivers[0].triangles, 1U);
    EXPECT_NE(problem_of({recorded("a", 0), ground("v.csv", 0)}).find("without its triangles"),
              std::string::npos);
    EXPECT_NE(problem_of({recorded("a", 0), table}).find("without its vertices"),
              std::string::npos);
    EXPECT_EQ(problem_of({ground("course.xml", 9)}),
              "the file holds the surface of a course, and no recording");
}

TEST(Arrange, RefusesFilesOfSeveralAttempts) {
    EXPECT_NE(problem_of({recorded("a", 0), recorded("b", 1, 12.0)}).find("12.0 km away"),
              std::string::npos);
    EXPECT_NE(problem_of({recorded("a", 0), recorded("b", 3 * 1440)}).find("another time"),
              std::string::npos);
    HandedIn relative = recorded("b", 0);
    relative.is.first.reset();
    EXPECT_NE(problem_of({recorded("a", 0), relative}).find("no times of its own"),
              std::string::npos);
    EXPECT_NE(problem_of({raw("a.nav", RecordingKind::orbits)}).find("orbits"), std::string::npos);
}

TEST(Arrange, SeriesAreWhatTheirColumnsOrNamesSay) {
    const auto series = [](const std::string& path, std::vector<std::string> keys) {
        HandedIn file = raw(path, RecordingKind::series);
        file.is.series = std::move(keys);
        return file;
    };
    const Arrangement all = arrange({recorded("a", 0), series("rear.csv", {"wheel"}),
                                     series("Current-1.csv", {"wind", "current"}),
                                     series("mast.csv", {"wind", "current"})});
    EXPECT_EQ(all.series,
              (std::map<std::string, std::size_t>{{"wheel", 1}, {"current", 2}, {"wind", 3}}));
    EXPECT_NE(all.said.back().find("might be another of wind and current"), std::string::npos)
        << all.said.back();
    EXPECT_NE(problem_of({series("a.csv", {"wheel"})}).find("no recording"), std::string::npos);
    EXPECT_NE(problem_of({recorded("a", 0), series("a.csv", {"wheel"}), series("b.csv", {"wheel"})})
                  .find("second series"),
              std::string::npos);
}

TEST(Arrange, RawSignalsAreARoverAndABaseOrBearWitness) {
    const auto obs = RecordingKind::signals;
    const Arrangement rinex = arrange(
        {raw("master.obs", obs), raw("rover.obs", obs), raw("rover.nav", RecordingKind::orbits)});
    ASSERT_EQ(rinex.receivers.size(), 1U);
    EXPECT_EQ(rinex.receivers[0].recordings, std::vector<std::size_t>{1});
    EXPECT_EQ(rinex.receivers[0].base, 0U);
    EXPECT_EQ(rinex.receivers[0].navigation, std::vector<std::size_t>{2});
    HandedIn log = recorded("rover.ubx", 0, 0, "ubx");
    log.is.raw_signals = true;
    const Arrangement behind = arrange({recorded("rover.pos", 0, 0, "rtklib-pos"), log});
    ASSERT_EQ(behind.receivers.size(), 1U);
    EXPECT_EQ(behind.receivers[0].phase, 1U);
    const Arrangement itself = arrange({log});
    EXPECT_EQ(itself.receivers[0].phase, 0U);
    const Arrangement beside = arrange({recorded("a.pos", 0, 0, "rtklib-pos"), raw("a.obs", obs),
                                        raw("a.nav", RecordingKind::orbits)});
    EXPECT_EQ(beside.receivers[0].phase, 1U);
    EXPECT_EQ(beside.receivers[0].navigation, std::vector<std::size_t>{2});
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
