#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "import_test_support.h"

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

/// A frame being written: mode, room for the checksum, then fields in their order.
class Frame {
  public:
    explicit Frame(int mode) {
        put(mode, 2);
        put(0, 2);
    }
    Frame& put(std::int64_t value, int bytes) {
        for (int i = 0; i < bytes; ++i)
            text_ += static_cast<char>((value >> (8 * i)) & 0xFF);
        return *this;
    }
    /// Filled up with zeros to its length, with its checksum.
    std::string sealed(std::size_t length) const {
        std::string frame = text_;
        frame.resize(length, '\0');
        unsigned a = 0, b = 0;
        for (std::size_t i = 0; i < length; ++i) {
            if (i == 2 || i == 3) continue;
            a = (a + static_cast<unsigned char>(frame[i])) % 256;
            b = (b + a) % 256;
        }
        frame[2] = static_cast<char>(a);
        frame[3] = static_cast<char>(b);
        return frame;
    }

  private:
    std::string text_;
};

struct Fields {
    std::int64_t latitude = -337'654'321, longitude = 1'512'345'678, height_mm = -1234;
    std::int64_t speed_mmps = 17'750, course = 15'000'000;
    std::int64_t unix_ms = 1'634'714'864'300;  // 2021-10-20T07:27:44.3Z
    int fix = 3, satellites = 11;
    std::int64_t speed_sigma = 85, horizontal_sigma = 300, vertical_sigma = 400;
};

std::string epoch(const Fields& fields) {
    return Frame(fields.unix_ms % 1000 == 0 ? 0x0AD4 : 0x0AD5)
        .put(fields.latitude, 4)
        .put(fields.longitude, 4)
        .put(fields.height_mm, 4)
        .put(fields.speed_mmps, 4)
        .put(fields.course, 4)
        .put(fields.unix_ms, 8)
        .put(fields.fix, 1)
        .put(fields.satellites, 1)
        .put(fields.speed_sigma, 4)
        .put(fields.horizontal_sigma, 4)
        .put(fields.vertical_sigma, 4)
        .put(54'699, 4)
        .put(101, 2)
        .sealed(52);
}

std::string header() {
    return Frame(0x0AD0).put(987, 2).sealed(512);
}

/// A header and so many epochs, 0.1 s apart.
std::string log_of(int epochs) {
    std::string log = header();
    for (int i = 0; i < epochs; ++i)
        log += epoch({.unix_ms = Fields{}.unix_ms + 100 * i});
    return log;
}

TEST(Oao, EveryField) {
    const Observations read = import_text(pos_receiver(), header() + epoch({}));
    EXPECT_EQ(read.format, "oao");
    EXPECT_EQ(read.frame, "geodetic");
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(read.device, "logger 987");
    EXPECT_EQ(read.accuracy_source, "recording");
    EXPECT_EQ(read.facts.receiver, "primary");
    EXPECT_EQ(read.records.total, 2);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(to_iso(*read.facts.first_epoch), "2021-10-20T07:28:02.300");
    EXPECT_EQ(read.facts.time_resolution_s, 0.001);
    EXPECT_NEAR(*read.facts.position_resolution_m, 0.0111, 1e-4);
    EXPECT_TRUE(has_note(read, "above mean sea level"));
    ASSERT_EQ(read.rows.size(), 1u);
    const Observation& row = read.rows[0];
    EXPECT_DOUBLE_EQ(*row.latitude_deg, -33.7654321);
    EXPECT_DOUBLE_EQ(*row.longitude_deg, 151.2345678);
    EXPECT_DOUBLE_EQ(*row.height_m, -1.234);
    EXPECT_NEAR(*row.recorded_velocity_east_m_s, 17.75 * 0.5, 1e-12);
    EXPECT_NEAR(*row.recorded_velocity_north_m_s, -17.75 * std::sqrt(0.75), 1e-12);
    EXPECT_FALSE(row.recorded_velocity_up_m_s);
    EXPECT_DOUBLE_EQ(*row.sigma_east_m, 0.3 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*row.sigma_north_m, 0.3 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*row.sigma_up_m, 0.4);
    EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_east_m_s, 0.085 / std::sqrt(2.0));
    EXPECT_DOUBLE_EQ(*row.sigma_recorded_velocity_north_m_s, 0.085 / std::sqrt(2.0));
    EXPECT_EQ(row.fix, FixType::single);
    EXPECT_EQ(row.satellites, 11);
    EXPECT_EQ(row.source_byte, 512);
    EXPECT_FALSE(row.source_line);
}

TEST(Oao, WithoutAFixThereIsNoPosition) {
    const Observations read =
        import_text(pos_receiver(), header() + epoch({.fix = 0, .satellites = 0}));
    EXPECT_EQ(read.rows[0].fix, FixType::none);
    EXPECT_FALSE(read.rows[0].latitude_deg || read.rows[0].height_m || read.rows[0].sigma_east_m ||
                 read.rows[0].sigma_up_m || read.rows[0].recorded_velocity_east_m_s);
}

TEST(Oao, KindsOfFix) {
    const FixType kinds[] = {FixType::none,   FixType::dead_reckoning, FixType::single,
                             FixType::single, FixType::dead_reckoning, FixType::none};
    for (int fix = 0; fix < 6; ++fix)
        EXPECT_EQ(import_text(pos_receiver(), epoch({.fix = fix})).rows[0].fix, kinds[fix]);
}

TEST(Oao, ZeroAndSaturatedAccuraciesAreUnknown) {
    for (const std::int64_t unknown : {std::int64_t{0}, std::int64_t{0xFFFFFFFF}}) {
        const Observations read = import_text(pos_receiver(), epoch({.speed_sigma = unknown,
                                                                     .horizontal_sigma = unknown,
                                                                     .vertical_sigma = unknown}));
        EXPECT_EQ(read.accuracy_source, "none");
        EXPECT_FALSE(read.rows[0].sigma_east_m || read.rows[0].sigma_up_m ||
                     read.rows[0].sigma_recorded_velocity_east_m_s);
        EXPECT_TRUE(read.rows[0].recorded_velocity_east_m_s);
    }
}

TEST(Oao, LeapSecondsOfTheDate) {
    // 2016-12-31T23:59:59.9Z and 0.1 s of the count later, past the leap second.
    const Observations read =
        import_text(pos_receiver(),
                    epoch({.unix_ms = 1'483'228'799'900}) + epoch({.unix_ms = 1'483'228'800'000}));
    EXPECT_EQ(to_iso(*read.facts.first_epoch), "2017-01-01T00:00:16.900");
    EXPECT_EQ(read.rows[1].time.nanoseconds, 1'100'000'000);
}

TEST(Oao, ADamagedRecordIsCountedAndTheNextIsRead) {
    std::string log = log_of(5);
    log[512 + 2 * 52 + 20] ^= 1;
    const Observations read = import_text(pos_receiver(), log);
    EXPECT_EQ(read.rows.size(), 4u);
    EXPECT_EQ(read.records.total, 6);
    ASSERT_EQ(read.records.bad, 1);
    EXPECT_EQ(read.records.bad_records[0].byte, 512 + 2 * 52);
    EXPECT_EQ(read.records.bad_records[0].epoch, 2);
    EXPECT_TRUE(has(read.records.bad_records[0].what, "checksum"))
        << read.records.bad_records[0].what;
}

TEST(Oao, DamageIsCountedByItsLength) {
    std::string log = log_of(20);
    for (std::size_t i = 512 + 3 * 52; i < 512 + 7 * 52; ++i)
        log[i] = '\x55';
    const Observations read = import_text(pos_receiver(), log);
    EXPECT_EQ(read.rows.size(), 16u);
    EXPECT_EQ(read.records.bad, 4);
    EXPECT_TRUE(has(read.records.bad_records[0].what, "belong to no record"))
        << read.records.bad_records[0].what;
    EXPECT_EQ(read.records.bad_records[3].byte, 512 + 6 * 52);
}

TEST(Oao, FindsTheNextRecordWhereBytesAreMissing) {
    std::string log = log_of(5);
    log.erase(512 + 52 + 7, 9);
    const Observations read = import_text(pos_receiver(), log);
    EXPECT_EQ(read.rows.size(), 4u);
    EXPECT_EQ(read.records.bad, 1);
    EXPECT_EQ(read.rows[1].source_byte, 512 + 2 * 52 - 9);
}

TEST(Oao, CutOffAnywhere) {
    const std::string log = log_of(4);
    for (std::size_t size = 1; size < log.size(); ++size) {
        const std::string cut = log.substr(0, size);
        if (size < 512 + 52) {
            EXPECT_NE(failure_of(pos_receiver(), cut), "read") << size;
            continue;
        }
        const Observations read = import_text(pos_receiver(), cut);
        EXPECT_EQ(read.rows.size(), (size - 512) / 52) << size;
        EXPECT_EQ(read.records.bad, (size - 512) % 52 == 0 ? 0 : 1) << size;
    }
    const Observations read = import_text(pos_receiver(), log.substr(0, log.size() - 12));
    EXPECT_TRUE(read.records.bad_records[0].what.starts_with(
        "the record ends behind the end of the recording: 40 bytes of 52 are there"));
}

TEST(Oao, RecordsOfOtherKindsAreLeftOut) {
    const Observations read = import_text(
        pos_receiver(), header() + epoch({}) + Frame(0x0AD3).put(7, 4).sealed(34) +
                            Frame(0x0AD1).sealed(12) + Frame(0x0AD2).sealed(34) +
                            Frame(0x0AD6).sealed(32) + epoch({.unix_ms = 1'634'714'864'400}));
    EXPECT_EQ(read.rows.size(), 2u);
    EXPECT_EQ(read.records.total, 7);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_TRUE(has_note(read, "4 records are of other kinds"));
}

TEST(Oao, HeaderNamesTheLogger) {
    std::string named = Frame(0x0AD0).put(12, 2).put('J', 1).put('\xe9', 1).sealed(512);
    EXPECT_EQ(import_text(pos_receiver(), named + epoch({})).device, "logger 12 \"J\\xe9\"");
    Frame full(0x0AD0);
    full.put(12, 2);
    for (int i = 6; i < 424; ++i)
        full.put(0, 1);
    full.put(3031, 2);
    for (int i = 426; i < 448; ++i)
        full.put(0, 1);
    const Observations read = import_text(pos_receiver(), full.put(1, 1).sealed(512) + epoch({}));
    EXPECT_EQ(read.device, "logger 12, firmware 3031");
    EXPECT_EQ(read.instrument, (Instrument{.firmware = "3031"}));
    EXPECT_FALSE(import_text(pos_receiver(), named + epoch({})).instrument);
    EXPECT_TRUE(has_note(read, "signature"));
}

TEST(Oao, RecognisedWithoutOrWithADamagedHeader) {
    EXPECT_EQ(import_text(pos_receiver(), epoch({})).format, "oao");
    std::string log = log_of(2);
    log[100] = 'x';
    const Observations read = import_text(pos_receiver(), log);
    EXPECT_EQ(read.format, "oao");
    EXPECT_EQ(read.records.bad, 1);
}

TEST(OaoRefused, SaysWhere) {
    Receiver receiver = pos_receiver();
    receiver.format = "oao";
    const struct {
        std::string log, where, what;
    } cases[] = {
        {header(), "f:1:1", "no epochs"},
        {std::string(5000, '\xd0'), "f:byte 0", "belong to no record"},
        {header() + epoch({.fix = 6}) + epoch({.fix = 6}), "f:byte 512", "kind of fix is 6"},
        {epoch({.latitude = 910'000'000}), "f:byte 0", "latitude of 91 degrees"},
        {epoch({.longitude = -1'900'000'000}), "f:byte 0", "longitude of -190 degrees"},
        {epoch({.height_mm = 200'000'000}), "f:byte 0", "height of 200000 m"},
        {epoch({.course = 36'000'001}), "f:byte 0", "course of 360.00001"},
        {epoch({.unix_ms = 1000}), "f:byte 0", "not between 1980 and 2200"},
        {epoch({.unix_ms = -1}), "f:byte 0", "not between 1980 and 2200"},
    };
    for (const auto& bad : cases) {
        const std::string message = failure_of(receiver, bad.log);
        EXPECT_EQ(message.rfind(bad.where + ": ", 0), 0u) << message;
        EXPECT_TRUE(has(message, bad.what)) << message;
    }
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
