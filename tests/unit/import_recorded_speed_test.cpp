#include <gtest/gtest.h>

#include <cmath>

#include "import_inspect_support.h"
#include "import_nmea_test_support.h"
#include "import_test_support.h"
#include "import_vbo_test_support.h"

// Recorded velocities that are a speed alone, and how accurate what is recorded is.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A table of geodetic positions that has these columns beside.
Receiver table_of(const std::vector<std::string>& columns) {
    Receiver receiver = pos_receiver();
    receiver.format = "csv";
    receiver.frame = StatedFrame{CoordinateFrame::geodetic};
    receiver.columns = {{"time", "1"}, {"latitude", "2"}, {"longitude", "3"}, {"height", "4"}};
    for (std::size_t i = 0; i < columns.size(); ++i)
        receiver.columns[columns[i]] = fmt::format("{}", 5 + i);
    return receiver;
}

constexpr const char* place = "35.0,137.0,40";

std::string noted_in(const Observations& read) {
    std::string all;
    for (const std::string& note : read.notes)
        all += note + "\n";
    return all;
}

TEST(RecordedSpeed, IsAVelocityOnlyWhereThereIsACourse) {
    const std::string text = fmt::format(
        "0,{0},10,30\n1,{0},10,\n2,{0},0,\n3,{0},10,-1\n4,{0},-1,30\n5,{0},,30\n6,{0},10,361\n",
        place);
    const Observations read = import_text(table_of({"speed", "course"}), text);
    ASSERT_EQ(read.rows.size(), 7U);
    EXPECT_NEAR(*read.rows[0].recorded_velocity_east_m_s, 5.0, 1e-12);
    EXPECT_NEAR(*read.rows[0].recorded_velocity_north_m_s, 10.0 * std::sqrt(0.75), 1e-12);
    EXPECT_FALSE(read.rows[0].recorded_speed_m_s);
    for (const std::size_t alone : {1U, 3U, 6U}) {
        EXPECT_EQ(read.rows[alone].recorded_speed_m_s, 10.0) << alone;
        EXPECT_FALSE(read.rows[alone].recorded_velocity_east_m_s ||
                     read.rows[alone].recorded_velocity_north_m_s)
            << alone;
    }
    // What stands has no course, and needs none.
    EXPECT_EQ(read.rows[2].recorded_velocity_east_m_s, 0.0);
    EXPECT_EQ(read.rows[2].recorded_velocity_north_m_s, 0.0);
    for (const std::size_t none : {4U, 5U})
        EXPECT_FALSE(read.rows[none].recorded_speed_m_s ||
                     read.rows[none].recorded_velocity_east_m_s)
            << none;
    EXPECT_NE(noted_in(read).find("3 of 5 recorded velocities come without a course"),
              std::string::npos);
}

struct Written {
    Receiver receiver;
    std::string text;
};

TEST(RecordedSpeed, OfNoCraftIsRefusedByNameInEveryFormat) {
    const auto csv = [](const std::vector<std::string>& columns, const std::string& values) {
        return Written{table_of(columns),
                       fmt::format("0,{0},1,2,3\n1,{0},{1}\n2,{0},1,2,3\n", place, values)};
    };
    const auto expect = [](const Written& one, const std::string& failure) {
        const std::string found = failure_of(one.receiver, one.text);
        EXPECT_TRUE(has(found, failure)) << found << "\n" << failure;
    };
    const std::vector<std::string> speed{"speed", "course"},
        velocity{"velocity_east", "velocity_north", "velocity_up"};
    expect(csv(speed, "-5,30,"), "f:2: the recorded speed is -5 m/s, which no craft has");
    expect(csv(speed, "299792458,30,"), "f:2: the recorded speed is 299792458 m/s");
    expect(csv(speed, "299792457,30,"), "read");
    expect(csv(speed, "-1,30,"), "read");  // telephones write so that they know none
    expect(csv(velocity, "3e8,0,0"), "f:2: the recorded speed is 300000000 m/s");
    expect(csv(velocity, "0,0,-4e8"), "f:2: the recorded speed is 400000000 m/s");
    expect(csv(velocity, "-2e8,-2e8,0"), "read");
    const auto gpx = [](const std::string& written) {
        Receiver receiver = pos_receiver();
        receiver.format = "gpx";
        return Written{
            receiver,
            fmt::format(
                "<gpx version=\"1.1\"><trk><trkseg>\n<trkpt lat=\"45\" lon=\"9\"><ele>1</ele>"
                "<time>2019-04-12T00:39:56Z</time><speed>{}</speed></trkpt>\n"
                "<trkpt lat=\"45\" lon=\"9\"><ele>1</ele><time>2019-04-12T00:39:57Z</time>"
                "</trkpt>\n</trkseg></trk></gpx>",
                written)};
    };
    expect(gpx("-7.5"), "f:2: the recorded speed is -7.5 m/s, which no craft has");
    expect(gpx("-1"), "read");
    expect(gpx("1e10"), "f:2: the recorded speed is 1e+10 m/s");
    const auto nmea = [](const std::string& knots) {
        return Written{pos_receiver(),
                       nmea_test::gga("101112.00") +
                           nmea_test::sentence("GPRMC,101112.00,A,4530.0,N,00915.0,E," + knots +
                                               ",090.0,050321,,,A")};
    };
    // Of NMEA such a sentence is a record that cannot be read, as any with a field out of range.
    for (const char* knots : {"900000000", "-19.4"}) {
        const Written one = nmea(knots);
        const std::string complaint = complaint_of(one.receiver, one.text);
        EXPECT_TRUE(has(complaint, "f:2:") && has(complaint, "speed")) << complaint;
    }
    const auto vbo = [](const std::string& kmh) {
        return Written{pos_receiver(), vbo_test::header + vbo_test::row +
                                           replaced(vbo_test::next_row, "072.000", kmh) +
                                           vbo_test::row};
    };
    expect(vbo("2e9"), "the recorded speed is 555555556 m/s");
    std::string pos = fixture("degrees_velocity_floats.pos");
    expect({pos_receiver(), replaced(pos, "-2.50000", "-3.5e8")},
           "f:6: the recorded speed is 350000000 m/s");
}

TEST(RecordedSpeed, ItsAccuracyMayBeRecorded) {
    const Observations speeds =
        import_text(table_of({"speed", "sigma_speed"}),
                    fmt::format("0,{0},10,0.2\n1,{0},10,\n2,{0},10,0\n", place));
    EXPECT_EQ(speeds.rows[0].sigma_recorded_speed_m_s, 0.2);
    EXPECT_FALSE(speeds.rows[1].sigma_recorded_speed_m_s ||
                 speeds.rows[2].sigma_recorded_speed_m_s);
    const Observations velocities =
        import_text(table_of({"velocity_east", "velocity_north", "velocity_up", "sigma_speed"}),
                    fmt::format("0,{0},10,5,1,0.2\n", place));
    EXPECT_EQ(velocities.rows[0].sigma_recorded_velocity_east_m_s, 0.2);
    EXPECT_EQ(velocities.rows[0].sigma_recorded_velocity_north_m_s, 0.2);
    EXPECT_EQ(velocities.rows[0].sigma_recorded_velocity_up_m_s, 0.2);
    EXPECT_FALSE(velocities.rows[0].sigma_recorded_speed_m_s);
}

TEST(RecordedSpeed, TheAttemptStatesTheAccuracyThatTheRecordingDoesNot) {
    Receiver receiver = table_of({"speed", "course", "sigma_speed"});
    receiver.accuracy = AttemptAccuracy{.velocity_m_s = 0.1};
    const std::string text =
        fmt::format("0,{0},10,30,0.2\n1,{0},10,30,\n2,{0},10,,\n3,{0},,,\n", place);
    const Observations read = import_text(receiver, text);
    EXPECT_EQ(read.rows[0].sigma_recorded_velocity_east_m_s, 0.2);
    EXPECT_EQ(read.rows[1].sigma_recorded_velocity_east_m_s, 0.1);
    EXPECT_EQ(read.rows[1].sigma_recorded_velocity_north_m_s, 0.1);
    EXPECT_FALSE(read.rows[1].sigma_recorded_velocity_up_m_s);
    EXPECT_EQ(read.rows[2].sigma_recorded_speed_m_s, 0.1);
    EXPECT_FALSE(read.rows[3].sigma_recorded_speed_m_s ||
                 read.rows[3].sigma_recorded_velocity_east_m_s);
    // Nothing is thereby stated of positions.
    EXPECT_EQ(read.accuracy_source, "none");
    EXPECT_FALSE(read.rows[0].sigma_east_m);
    EXPECT_NE(noted_in(read).find("2 of 3 recorded velocities state no accuracy; the attempt's is "
                                  "used: 0.1 m/s."),
              std::string::npos);
}

TEST(RecordedSpeed, AnAccuracyOfVelocitiesThatIsNotNeededIsSaid) {
    Receiver receiver = table_of({"speed", "course", "sigma_speed"});
    receiver.accuracy = AttemptAccuracy{.velocity_m_s = 0.1};
    EXPECT_NE(noted_in(import_text(receiver, fmt::format("0,{},10,30,0.2\n", place)))
                  .find("attempt's accuracy of velocities is not."),
              std::string::npos);
    EXPECT_NE(noted_in(import_text(receiver, fmt::format("0,{},,,\n", place)))
                  .find("no velocities are recorded"),
              std::string::npos);
}

TEST(RecordedSpeed, OfColumnsOnlyThoseThatFitTogetherAreTaken) {
    const auto why = [](const std::vector<std::string>& columns) -> std::string {
        try {
            import_text(table_of(columns), fmt::format("0,{},1,2,3\n", place));
        } catch (const Failure& failure) {
            return failure.problem();
        }
        return {};
    };
    EXPECT_EQ(why({"velocity_east", "velocity_north", "speed"}),
              "both velocity_east and speed are named");
    EXPECT_EQ(why({"course"}), "no column is named for \"speed\", which course needs");
    EXPECT_EQ(why({"sigma_speed"}), "no column is named for \"speed\", which sigma_speed needs");
}

/// A minute at 10 m/s towards a bearing, with speed and course as given for each second.
template <class Written>
std::string drive(double bearing_deg, Written written) {
    std::string text;
    for (int second = 0; second < 60; ++second) {
        const double way_deg = 10.0 * second / 111e3,
                     bearing = bearing_deg * 3.14159265358979 / 180.0;
        text += fmt::format("{},{:.8f},{:.8f},40,{}\n", second, 35.0 + way_deg * std::cos(bearing),
                            137.0 + way_deg * std::sin(bearing) / 0.819, written(second));
    }
    return text;
}

TEST(RecordedSpeed, VelocitiesThatWereNeverFilledInAreNotEvidence) {
    const auto zero = [](int) { return "0,0"; };
    const Observations read = import_text(table_of({"speed", "course"}), drive(60.0, zero));
    for (const Observation& row : read.rows)
        EXPECT_FALSE(row.recorded_velocity_east_m_s || row.recorded_speed_m_s);
    EXPECT_NE(noted_in(read).find("Every recorded velocity is zero"), std::string::npos);
    // One that is filled shows that the others were measured.
    const auto one = [](int second) { return second == 30 ? "10,60" : "0,0"; };
    EXPECT_EQ(import_text(table_of({"speed", "course"}), drive(60.0, one))
                  .rows[0]
                  .recorded_velocity_east_m_s,
              0.0);
}

TEST(RecordedSpeed, CoursesThatWereNeverFilledInLeaveTheSpeed) {
    const auto north = [](int second) { return second == 0 ? "0,0" : "10,0"; };
    const Observations astray = import_text(table_of({"speed", "course"}), drive(60.0, north));
    EXPECT_EQ(astray.rows[0].recorded_velocity_north_m_s, 0.0);
    EXPECT_EQ(astray.rows[1].recorded_speed_m_s, 10.0);
    EXPECT_FALSE(astray.rows[1].recorded_velocity_north_m_s);
    EXPECT_NE(noted_in(astray).find("Every recorded course is north"), std::string::npos);
    const Observations due = import_text(table_of({"speed", "course"}), drive(0.5, north));
    EXPECT_EQ(due.rows[1].recorded_velocity_north_m_s, 10.0);
}

TEST(RecordedSpeed, ACourseThatStandsStillAtLowSpeedLeavesTheSpeed) {
    std::string points;
    const double speeds[] = {9.0, 8.0, 1.4, 1.2, 1.3, 3.0};
    const double courses[] = {30.0, 30.0, 30.0, 30.0, 31.0, 31.0};
    for (int i = 0; i < 6; ++i)
        points += fmt::format(
            "<trkpt lat=\"1\" lon=\"2\"><ele>3</ele><time>2019-04-12T00:39:{:02}Z</time>"
            "<course>{}</course><speed>{}</speed></trkpt>\n",
            i, courses[i], speeds[i]);
    const Observations read = import_text(
        pos_receiver(), "<?xml version=\"1.0\"?>\n<gpx version=\"1.0\"><trk><trkseg>\n" + points +
                            "</trkseg></trk></gpx>\n");
    ASSERT_EQ(read.rows.size(), 6U);
    for (const std::size_t alone : {2U, 3U}) {
        EXPECT_NEAR(*read.rows[alone].recorded_speed_m_s, speeds[alone], 1e-12);
        EXPECT_FALSE(read.rows[alone].recorded_velocity_east_m_s);
    }
    for (const std::size_t whole : {0U, 1U, 4U, 5U})
        EXPECT_TRUE(read.rows[whole].recorded_velocity_east_m_s) << whole;
    EXPECT_NE(noted_in(read).find("2 recorded courses stand still"), std::string::npos);
}

TEST(RecordedSpeed, InspectSaysWhatWasFoundAndWhatToWrite) {
    const auto speed = [](int second) { return fmt::format("{}", 10.0 + 0.5 * (second % 7)); };
    const std::string text = drive(60.0, speed);
    const std::string said = inspection_text(import_text(table_of({"speed"}), text));
    EXPECT_NE(said.find("Velocity   speed without a course in 60 epochs"), std::string::npos)
        << said;
    EXPECT_NE(said.find("accuracy.velocity_mps: The recorded speeds state no accuracy"),
              std::string::npos)
        << said;
    EXPECT_NE(said.find("By recorded velocity  4"), std::string::npos) << said;
    Receiver stated = table_of({"speed"});
    stated.accuracy = AttemptAccuracy{.velocity_m_s = 0.25};
    const std::string then = text_of(recognition_of(import_text(stated, text), stated));
    EXPECT_EQ(then.find("velocity_mps"), std::string::npos) << then;
    EXPECT_NE(then.find("stated 0.25 m/s (median)"), std::string::npos) << then;
}

/// Which recordings have velocities that were computed from their positions.
TEST(VelocityOriginRecorded, OfEveryRecordingThatHasVelocities) {
    const struct {
        const char* file;
        VelocityOrigin origin;
    } recordings[] = {
        {"race_car_vbo/run_a.vbo", VelocityOrigin::independent},
        {"race_car_vbo/run_b.vbo", VelocityOrigin::independent},
        {"windsurf_loggers/boom_left.oao", VelocityOrigin::independent},
        // Positions as smooth as their rounding: a difference is as good as a speed.
        {"windsurf_loggers/head_left.oao", VelocityOrigin::unclear},
        {"windsurf_loggers/head_right.oao", VelocityOrigin::independent},
        {"ubx_walk/rover.ubx", VelocityOrigin::independent},
        {"speed_skydive/flysight1_good.csv", VelocityOrigin::independent},
        {"speed_skydive/flysight2_track.csv", VelocityOrigin::independent},
    };
    for (const auto& [file, origin] : recordings) {
        const auto text = recorded(file);
        if (!text) GTEST_SKIP();
        EXPECT_EQ(inspect(import_text(pos_receiver(), *text, file)).velocity_origin, origin)
            << file;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
