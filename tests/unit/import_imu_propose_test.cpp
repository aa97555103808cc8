#include <gtest/gtest.h>

#include <numbers>

#include "import_imu_support.h"
#include "import_inspect_support.h"
#include "stages/import/imu/propose.h"

// What a file is that may be an IMU's, before an attempt names it.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

std::optional<imu::Proposal> proposed(std::string_view text) {
    return imu::propose({.name = "folder/imu.csv", .bytes = text});
}

std::string value_of(const imu::Proposal& proposal, const std::string& key) {
    for (const ProposedKey& one : proposal.is.proposed)
        if (one.key == "imu." + key) return one.value;
    return "none";
}

/// The same readings under another header, changed.
std::string with_header(const std::string& header,
                        const std::function<void(std::size_t, SampleText&)>& change = {}) {
    const std::string text = imu_table(400, change);
    return header + text.substr(text.find('\n'));
}

TEST(ImuProposal, NamesSayColumnsAndUnits) {
    constexpr double degree = std::numbers::pi / 180.0;
    const struct {
        const char* header;
        std::function<void(std::size_t, SampleText&)> change;
        const char *gyro_unit, *accelerometer_unit, *time_unit;
    } cases[] = {
        {"host_time_s,gx_rad_s,gy_rad_s,gz_rad_s,ax_mps2,ay_mps2,az_mps2",
         {},
         "rad/s",
         "m/s2",
         "s"},
        {"timestamp,Gyro X (deg/s),Gyro Y (deg/s),Gyro Z (deg/s),Acc X (g),Acc Y (g),Acc Z (g)",
         [](std::size_t, SampleText& sample) {
             for (std::size_t k = 1; k < 4; ++k)
                 sample[k] /= degree;
             for (std::size_t k = 4; k < 7; ++k)
                 sample[k] /= 9.80665;
         },
         "deg/s", "g", "s"},
        {"time_ms,gyroscope_x,gyroscope_y,gyroscope_z,accelerometerX,accelerometerY,accelerometerZ",
         [](std::size_t, SampleText& sample) { sample[0] *= 1000.0; }, "rad/s", "m/s2", "ms"},
        {"t,wx,wy,wz,fx,fy,fz", [](std::size_t, SampleText& sample) { sample[0] *= 1e9; }, "rad/s",
         "m/s2", "ns"}};
    for (const auto& one : cases) {
        SCOPED_TRACE(one.header);
        const auto proposal = proposed(with_header(one.header, one.change));
        ASSERT_TRUE(proposal);
        EXPECT_EQ(proposal->is.problem, "");
        EXPECT_EQ(value_of(*proposal, "gyro_unit"), one.gyro_unit);
        EXPECT_EQ(value_of(*proposal, "accelerometer_unit"), one.accelerometer_unit);
        EXPECT_EQ(value_of(*proposal, "time_unit"), one.time_unit);
        EXPECT_EQ(value_of(*proposal, "axes.z"), "down");
        EXPECT_EQ(value_of(*proposal, "rate_hz"), "none");
        // What is proposed reads the file.
        Receiver receiver = imu_receiver();
        receiver.imu = proposal->receiver.imu;
        EXPECT_EQ(read_imu_text(receiver, with_header(one.header, one.change)).rows.size(), 400U);
    }
}

TEST(ImuProposal, NumbersAloneShowWhichAreAccelerometersAndWhichIsTheTime) {
    const std::string text = imu_table(400);
    const auto first = proposed(text.substr(text.find('\n') + 1));
    ASSERT_TRUE(first);
    EXPECT_EQ(value_of(*first, "columns.time"), "1");
    EXPECT_EQ(value_of(*first, "columns.gyro_x"), "2");
    EXPECT_EQ(value_of(*first, "columns.accelerometer_x"), "5");
    // The time last, accelerometers first.
    std::string turned;
    for (int i = 0; i < 400; ++i)
        turned += fmt::format("{:.3f},0.02,1.01,0.5,{:.3f},0.1,{}\n", 0.01 * (i % 3),
                              0.02 * (i % 5), 261'906 + 10 * i);
    const auto last = proposed(turned);
    ASSERT_TRUE(last);
    EXPECT_EQ(value_of(*last, "columns.time"), "7");
    EXPECT_EQ(value_of(*last, "columns.accelerometer_z"), "3");
    EXPECT_EQ(value_of(*last, "columns.gyro_z"), "6");
    EXPECT_EQ(value_of(*last, "accelerometer_unit"), "g");
    EXPECT_EQ(value_of(*last, "time_unit"), "ms");
    EXPECT_EQ(value_of(*last, "axes.z"), "-down");
    EXPECT_EQ(value_of(*last, "axes.y"), "-right");
}

// Whatever axis is down, the proposed ones are right-handed and read the file.
TEST(ImuProposal, AxesHaveTheOneDownThatGravityIsOn) {
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double sign : {-1.0, 1.0}) {
            const auto change = [&](std::size_t i, SampleText& sample) {
                for (std::size_t k = 4; k < 7; ++k)
                    sample[k] = 0.001 * static_cast<double>(i % 7);
                sample[4 + axis] = sign * 9.8;
            };
            const std::string text = with_header("t,gx,gy,gz,ax,ay,az", change);
            const auto proposal = proposed(text);
            ASSERT_TRUE(proposal);
            EXPECT_EQ(value_of(*proposal, fmt::format("axes.{}", "xyz"[axis])),
                      sign < 0.0 ? "down" : "-down");
            EXPECT_NO_THROW((void)read_attempt(
                fmt::format(
                    "schema: attempt/1.0\nid: a\ncraft: {{name: x, class: car}}\n"
                    "receivers: [{{id: p, recording: r, imu: {{file: i, antenna_m: "
                    "{{forward: 0, right: 0, down: 0}}, axes: {{x: {}, y: {}, z: {}}}}}}}]\n"
                    "profiles: [nalsa]\n",
                    value_of(*proposal, "axes.x"), value_of(*proposal, "axes.y"),
                    value_of(*proposal, "axes.z")),
                "attempt.yaml"));
            Receiver receiver = imu_receiver();
            receiver.imu = proposal->receiver.imu;
            EXPECT_EQ(imu_failure(receiver, text), "read");
        }
}

TEST(ImuProposal, IsOfNoOtherTable) {
    EXPECT_FALSE(proposed("time,lat,lon,speed\n0,52.1,5.1,3\n1,52.1,5.1,3\n"));
    EXPECT_FALSE(
        proposed("time,gx,gy,gz,ax,ay,az,latitude,longitude\n"
                 "0,0,0,0,0,0,9.8,52.1,5.1\n1,0,0,0,0,0,9.8,52.1,5.1\n"));
    EXPECT_FALSE(proposed("0 1 2 3 4 5 6\n1 2 3 4 5 6 7\n"));
    EXPECT_FALSE(proposed("nothing\n"));
}

TEST(ImuProposal, SaysWhatTheFileIs) {
    const auto proposal = proposed(imu_table(400, [](std::size_t i, SampleText& sample) {
        if (i >= 200) sample[0] += 0.5;
    }));
    ASSERT_TRUE(proposal);
    const Recognition is = imu::recognition_of(*proposal);
    std::string said = receiver_lines(is, "imu.csv");
    for (const DescribedFact& fact : is.said.at(0).facts)
        said += fmt::format("{}: {}\n", fact.name, fact.value);
    for (const char* part :
         {"Samples: 400\n", "Times: 0.010 s to 4.500 s of a count without a date\n",
          "Rate: 100.00 Hz; stamps jitter by 0.00 ms\n",
          "Gravity: 9.793 m/s2 in the quietest second; the z axis points down, 1.3 degrees off\n",
          "Gaps: 1, the longest of 0.500 s\n", "At the end of the range: none\n",
          "  file: imu.csv\n", "columns: {time: t, gyro_x: gx,", "antenna_m: {forward: ..."})
        EXPECT_TRUE(has(said, part)) << part << "in\n" << said;
    EXPECT_EQ(is.kind, RecordingKind::imu);
    EXPECT_EQ(is.epochs, 400);
    EXPECT_NEAR(*is.count_s, 0.01, 1e-9);
    EXPECT_NEAR(is.span_s, 4.49, 1e-9);
    EXPECT_EQ(is.proposed.front().key, "imu.columns.time");
}

TEST(ImuProposal, OfRecordedFilesIsWhatIsKnownOfThem) {
    const struct {
        const char *file, *rate, *gyro_unit, *down;
        double rate_hz;
    } cases[] = {{"rtk_imu_drive/imu.csv", "100", "deg/s", "-down", 100.0},
                 {"ubx_walk/imu.csv", "100.5", "deg/s", "-down", 100.5},
                 {"freeway_pose/imu.csv", "none", "rad/s", "down", 104.26}};
    for (const auto& one : cases) {
        SCOPED_TRACE(one.file);
        const auto text = recorded(one.file);
        if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
        const auto proposal = proposed(*text);
        ASSERT_TRUE(proposal);
        EXPECT_EQ(proposal->is.problem, "");
        EXPECT_EQ(value_of(*proposal, "rate_hz"), one.rate);
        EXPECT_EQ(value_of(*proposal, "gyro_unit"), one.gyro_unit);
        EXPECT_EQ(value_of(*proposal, "axes.z"), one.down);
        EXPECT_NEAR(proposal->sampling->clock.rate_hz, one.rate_hz, 0.1);
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
