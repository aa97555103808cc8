#include <gtest/gtest.h>

#include <cmath>

#include "import_test_support.h"

// Recorded velocities that are a speed alone, and how accurate what is recorded is.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A table of geodetic positions that has these columns beside.
Receiver table_of(const std::vector<std::string>& columns) {
    Receiver receiver = pos_receiver();
    receiver.format = "csv";
    receiver.frame = CoordinateFrame::geodetic;
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

}  // namespace
}  // namespace runcert::RUNCERT_FILE
