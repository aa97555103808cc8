#include <fmt/format.h>

#include "import_test_support.h"
#include "stages/import/novatel/log.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

std::string sealed(const std::string& body, char begin = '#') {
    return fmt::format("{}{}*{:08x}\r\n", begin, body, novatel::crc32(body));
}

std::string header(const std::string& name, double seconds,
                   const std::string& status = "FINESTEERING") {
    return fmt::format("{},COM1,0,85.0,{},2200,{:.3f},02000020,cdba,32768;", name, status, seconds);
}

std::string position(double seconds, const std::string& type = "NARROW_INT",
                     const std::string& name = "BESTPOSA") {
    return sealed(header(name, seconds) +
                  fmt::format("SOL_COMPUTED,{},45.2500{:.0f}0000,9.12500000000,100.0000,47.2500,"
                              "WGS84,0.0200,0.0100,0.0300,\"a,b\",1.500,0.000,20,18,18,0,00,00,"
                              "00,11",
                              type, seconds));
}

std::string velocity(double seconds) {
    return sealed(header("BESTVELA", seconds) +
                  "SOL_COMPUTED,DOPPLER_VELOCITY,0.150,0.000,10.0000,90.000000,-0.5000,0.0");
}

// By a script that divides bit by bit, which gives the checksums of the recorded sample, too.
TEST(NovatelChecksum, IsThatOfAnIndependentDivision) {
    EXPECT_EQ(novatel::crc32("123456789"), 0x2dfd2d88U);
}

TEST(Novatel, PositionsAndVelocitiesOfOneTimeAreOneEpoch) {
    const std::string text = "$GPGGA,120000,4530.1,N,00915.7,E,1,5,1.1,12.0,M,40.0,M,,\r\n" +
                             position(1) + velocity(1) + velocity(2) + position(2) + position(3) +
                             position(4, "SINGLE");
    const Observations read = import_text(pos_receiver(), text);
    EXPECT_EQ(read.format, "novatel");
    EXPECT_EQ(read.time_scale, "gps");
    ASSERT_EQ(read.rows.size(), 4U);
    EXPECT_EQ(read.records.bad, 0);
    const Observation& first = read.rows[0];
    EXPECT_DOUBLE_EQ(*first.latitude_deg, 45.25001);
    EXPECT_DOUBLE_EQ(*first.height_m, 147.25);
    EXPECT_DOUBLE_EQ(*first.sigma_north_m, 0.02);
    EXPECT_DOUBLE_EQ(*first.sigma_east_m, 0.01);
    EXPECT_DOUBLE_EQ(*first.sigma_up_m, 0.03);
    EXPECT_EQ(first.fix, FixType::fixed);
    EXPECT_EQ(*first.satellites, 18);
    EXPECT_DOUBLE_EQ(*first.age_s, 1.5);
    EXPECT_NEAR(*first.recorded_velocity_east_m_s, 10.0, 1e-12);
    EXPECT_NEAR(*first.recorded_velocity_north_m_s, 0.0, 1e-12);
    EXPECT_DOUBLE_EQ(*first.recorded_velocity_up_m_s, -0.5);
    EXPECT_TRUE(read.rows[1].recorded_velocity_east_m_s);
    EXPECT_FALSE(read.rows[2].recorded_velocity_east_m_s);
    EXPECT_EQ(read.rows[3].fix, FixType::single);
    EXPECT_EQ(read.facts.first_epoch->nanoseconds(),
              (std::int64_t{2200} * 604'800 + 1) * 1'000'000'000);
    EXPECT_TRUE(has_note(read, "up to 0.15 s older than their times"));
}

TEST(Novatel, InstrumentIsTheCardOfVersion) {
    const std::string version =
        sealed(header("VERSIONA", 0.0) +
               "2,FRONTPANEL,\"\",\"\",\"\",\"\",\"\",\"\",\"\",GPSCARD,\"L12RV\",\"DZZ06040017\","
               "\"OEMV3G-3.00-2T\",\"3.000A19\",\"3.000A9\",\"2006/Feb/ 9\",\"17:14:33\"");
    const Instrument expected{.model = "L12RV", .serial = "DZZ06040017", .firmware = "3.000A19"};
    EXPECT_EQ(import_text(pos_receiver(), version + position(1) + position(2)).instrument,
              expected);
    const Observations behind = import_text(pos_receiver(), position(1) + version + position(2));
    EXPECT_EQ(behind.instrument, expected);
    EXPECT_EQ(behind.rows.size(), 2U);
    EXPECT_FALSE(import_text(pos_receiver(), position(1)).instrument);
}

TEST(Novatel, InertialPositionsAreSaidToBeSo) {
    std::string text;
    for (int i = 0; i < 3; ++i)
        text += sealed(header("INSPVAXA", i) +
                       "INS_SOLUTION_GOOD,INS_RTKFIXED,45.25,9.125,100.0,47.25,3.0,4.0,0.5,0.1,0.2,"
                       "90.0,0.02,0.01,0.03,0.006,0.005,0.007,0.1,0.1,0.2,0,1");
    const Observations read = import_text(pos_receiver(), text);
    ASSERT_EQ(read.rows.size(), 3U);
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_velocity_north_m_s, 3.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_recorded_velocity_east_m_s, 0.005);
    EXPECT_TRUE(has_note(read, "An inertial unit takes part"));
    // Those of the satellites alone come first.
    EXPECT_EQ(import_text(pos_receiver(), text + position(1) + position(2)).rows.size(), 2U);
    std::string brief;
    for (int i = 0; i < 2; ++i)
        brief +=
            sealed(fmt::format("INSPVASA,2200,{}.0;2200,{}.0,45.25,9.125,147.25,3.0,4.0,0.5,0.1,"
                               "0.2,90.0,INS_SOLUTION_GOOD",
                               i, i),
                   '%');
    EXPECT_DOUBLE_EQ(*import_text(pos_receiver(), brief).rows[1].height_m, 147.25);
}

TEST(Novatel, WhatIsDamagedIsSaidWithItsPlace) {
    const std::string good = position(1) + position(2) + position(3);
    std::string damaged = position(4);
    damaged[60] = damaged[60] == '1' ? '2' : '1';
    const struct {
        std::string line, what;
    } cases[] = {
        {damaged, "the checksum is"},
        {position(4).substr(0, 120) + "\n", "cut off before its checksum"},
        {position(4, "ELEPHANT"), "the kind of position \"ELEPHANT\" is not known"},
        {sealed(header("BESTPOSA", 4) + "SOL_COMPUTED,SINGLE,45"), "the log has 3 fields, not 21"},
    };
    for (const auto& bad : cases)
        EXPECT_EQ(complaint_of(pos_receiver(), good + bad.line).rfind("f:4:", 0), 0U)
            << complaint_of(pos_receiver(), good + bad.line);
    for (const auto& bad : cases)
        EXPECT_TRUE(has(complaint_of(pos_receiver(), good + bad.line), bad.what));
    const Observations start =
        import_text(pos_receiver(), sealed(header("BESTPOSA", 0, "UNKNOWN") + "x") + good);
    EXPECT_EQ(start.rows.size(), 3U);
    EXPECT_TRUE(has_note(start, "1 logs of a receiver that did not know its time"));
    Receiver receiver = pos_receiver();
    receiver.format = "novatel";
    EXPECT_TRUE(has(failure_of(receiver, velocity(1)), "Record BESTPOSA and BESTVELA"));
}

// Figures as the file has them; undulation -16.9 m.
TEST(NovatelRecorded, ALogOfADocumentedSample) {
    const auto bytes = recorded("other_programs/novatel_bestpos.asc");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_text(pos_receiver(), *bytes);
    EXPECT_EQ(read.records.bad, 0);
    ASSERT_FALSE(read.rows.empty());
    EXPECT_DOUBLE_EQ(*read.rows[0].latitude_deg, 51.11637049360);
    EXPECT_NEAR(*read.rows[0].height_m, 1059.7447 - 16.9, 1e-9);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_east_m, 1.5644);
    EXPECT_EQ(read.rows[0].fix, FixType::single);
}

TEST(Novatel, CutAtAnyByteItReadsOrRefuses) {
    const std::string text = position(1) + velocity(1) + position(2) + position(3);
    for (std::size_t size = 0; size < text.size(); ++size)
        try {
            EXPECT_LE(import_text(pos_receiver(), text.substr(0, size)).rows.size(), 3U);
        } catch (const Failure& failure) {
            EXPECT_EQ(failure.where().rfind("f:", 0), 0U);
        }
}

TEST(EmlidLlh, IsReadAsRtklibsSolutionInGpsTime) {
    const std::string row =
        "2024/04/10 10:20:30.{}00   45.250000000    9.125000000   147.2500   1  18   0.0100   "
        "0.0200   0.0300   0.0010  -0.0020   0.0030   0.60    9.9\n";
    std::string text;
    for (int i = 0; i < 3; ++i)
        text += fmt::format(fmt::runtime(row), i);
    const Observations read = import_text(pos_receiver(), text, "rover.LLH");
    ASSERT_EQ(read.rows.size(), 3U);
    EXPECT_EQ(read.time_scale, "gps");
    EXPECT_EQ(read.rows[0].fix, FixType::fixed);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_north_m, 0.01);
    EXPECT_DOUBLE_EQ(*read.rows[0].sigma_east_m, 0.02);
    EXPECT_EQ(read.facts.first_epoch->calendar().hour, 10);
    // Of another name nothing says in which time its rows are.
    EXPECT_TRUE(has(failure_of(pos_receiver(), text), "no header line that names the columns"));
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
