#include <fmt/format.h>

#include <cstdio>
#include <sstream>

#include "import_test_support.h"
#include "stages/import/fit/decode.h"
#include "store/process.h"

// FIT files made here by the protocol, and real ones, against a decoder of its own in Python.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace import_test;

template <class Integer>
std::string number(Integer value, bool big = false) {
    std::string bytes;
    for (std::size_t i = 0; i < sizeof(Integer); ++i) {
        const auto shift = 8 * (big ? sizeof(Integer) - 1 - i : i);
        bytes += static_cast<char>((static_cast<std::uint64_t>(value) >> shift) & 0xff);
    }
    return bytes;
}

std::string file_of(const std::string& records) {
    const std::string bytes = std::string("\x0e\x10", 2) + number<std::uint16_t>(2134) +
                              number(static_cast<std::uint32_t>(records.size())) + ".FIT" +
                              number<std::uint16_t>(0) + records;
    return bytes + number(fit::crc16(bytes));
}

struct Field {
    int name, size;
};

std::string definition(int local, std::uint16_t message, const std::vector<Field>& fields,
                       bool big = false, const std::vector<Field>& of_developers = {}) {
    std::string bytes{static_cast<char>(0x40 | local | (of_developers.empty() ? 0 : 0x20)), '\0',
                      static_cast<char>(big ? 1 : 0)};
    bytes += number(message, big) + static_cast<char>(fields.size());
    const auto append = [&](const Field& field) {
        bytes += {static_cast<char>(field.name), static_cast<char>(field.size), '\0'};
    };
    for (const Field& field : fields)
        append(field);
    if (!of_developers.empty()) bytes += static_cast<char>(of_developers.size());
    for (const Field& field : of_developers)
        append(field);
    return bytes;
}

constexpr std::uint32_t start = 1'020'545'188;  // 2022-05-03T20:46:28 UTC
constexpr std::int32_t latitude = 549'060'544, longitude = -1'419'059'712;

const std::string stamped_definition =
    definition(0, 20, {{253, 4}, {0, 4}, {1, 4}, {2, 2}, {6, 2}});

std::string stamped(std::uint32_t time, int step, bool big = false) {
    return std::string(1, '\0') + number(time, big) + number(latitude + 400 * step, big) +
           number(longitude, big) + number<std::uint16_t>(5 * 620, big) +
           number<std::uint16_t>(10'000, big);
}

/// Of local type 1, after its definition: a compressed time stamp's low five bits.
const std::string compressed_definition = definition(1, 20, {{0, 4}, {1, 4}});

std::string compressed(std::uint32_t time, int step) {
    return std::string(1, static_cast<char>(0x80 | 1 << 5 | (time & 31))) +
           number(latitude + 400 * step) + number(longitude);
}

std::string by_python(const std::filesystem::path& file) {
    const std::string command = fmt::format("python3 '{}/tests/unit/fit_positions.py' '{}'",
                                            RUNCERT_SOURCE_DIR, file.string());
    std::FILE* pipe = popen(command.c_str(), "r");
    EXPECT_NE(pipe, nullptr);
    std::string text;
    char buffer[4096];
    while (const std::size_t size = std::fread(buffer, 1, sizeof buffer, pipe))
        text.append(buffer, size);
    EXPECT_EQ(pclose(pipe), 0);
    return text;
}

/// Every row of the file as the Python decoder has it, to the bit.
void expect_as_by_python(const std::string& bytes, std::size_t rows) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "a.fit", std::ios::binary) << bytes;
    std::istringstream expected(by_python(folder.path() / "a.fit"));
    const Observations read = import_text(pos_receiver(), bytes);
    ASSERT_EQ(read.format, "fit");
    ASSERT_EQ(read.rows.size(), rows);
    // Of the FIT epoch in GPS time by the calendar: 1989-12-31T00:00:00 UTC, then 5 s behind.
    const GpsTime epoch = gps_from_utc({.year = 1989, .month = 12, .day = 31});
    std::int64_t seconds = 0, lat = 0, lon = 0;
    for (const Observation& row : read.rows) {
        ASSERT_TRUE(expected >> seconds >> lat >> lon);
        const GpsTime instant = read.facts.first_epoch->plus_nanoseconds(row.time.nanoseconds);
        // Of 2017 and later: 18 leap seconds, of which 5 were before the FIT epoch.
        const std::int64_t leap_s = instant.nanoseconds_since(epoch) / 1'000'000'000 - seconds;
        ASSERT_EQ(leap_s, 18 - 5);
        ASSERT_DOUBLE_EQ(*row.latitude_deg, static_cast<double>(lat) * 180.0 / 2147483648.0);
        ASSERT_DOUBLE_EQ(*row.longitude_deg, static_cast<double>(lon) * 180.0 / 2147483648.0);
    }
    EXPECT_FALSE(expected >> seconds);
}

TEST(Fit, RecordsAreReadInTheirUnits) {
    const Observations read = import_text(
        pos_receiver(), file_of(stamped_definition + stamped(start, 0) + stamped(start + 1, 1)));
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(utc_from_gps(*read.facts.first_epoch).time.hour, 20);
    EXPECT_NEAR(*read.rows[0].latitude_deg, 46.0217, 1e-4);
    EXPECT_DOUBLE_EQ(*read.rows[0].height_m, 120.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_speed_m_s, 10.0);
    EXPECT_EQ(*read.rows[1].source_byte,
              14 + static_cast<std::int64_t>(stamped_definition.size()) + 17);
    EXPECT_TRUE(has_note(read, "whole seconds"));
}

TEST(Fit, InstrumentIsThatOfFileIdAndCreator) {
    const std::string text("Forerunner 955\0", 15);
    const std::string file_id = definition(2, 0, {{3, 4}, {4, 4}, {1, 2}, {2, 2}, {0, 1}}) + '\2' +
                                number<std::uint32_t>(3456789012U) + number(start) +
                                number<std::uint16_t>(1) + number<std::uint16_t>(4024) + '\4';
    const std::string info = definition(3, 23, {{3, 4}, {2, 2}, {4, 2}, {5, 2}, {0, 1}});
    const auto device = [&](int index, std::uint32_t serial, std::uint16_t software) {
        return '\3' + number(serial) + number<std::uint16_t>(1) + number<std::uint16_t>(4024) +
               number(software) + static_cast<char>(index);
    };
    const std::string rows = stamped_definition + stamped(start, 0) + stamped(start + 1, 1);
    const auto of = [&](const std::string& records) {
        return import_text(pos_receiver(), file_of(records)).instrument;
    };
    // A heart rate strap (index 1) is not what recorded.
    EXPECT_EQ(of(file_id + info + device(1, 77, 300) + device(0, 3456789012U, 1929) + rows),
              (Instrument{.make = "Garmin",
                          .model = "product 4024 by FIT's numbers",
                          .serial = "3456789012",
                          .firmware = "19.29"}));
    EXPECT_EQ(of(definition(2, 0, {{8, 15}, {1, 2}, {3, 4}}) + '\2' + text +
                 number<std::uint16_t>(999) + number<std::uint32_t>(0) + rows),
              (Instrument{.make = "manufacturer 999 by FIT's numbers", .model = "Forerunner 955"}));
    EXPECT_FALSE(of(rows));
}

TEST(Fit, CompressedRepeatedAndBackwardStampsAreThoseOfAnIndependentDecoder) {
    std::string records = stamped_definition + compressed_definition + stamped(start, 0);
    std::uint32_t time = start;
    int step = 1;
    // Over several turns of the five bits, repeated ones among them.
    for (const std::uint32_t ahead : {1U, 1U, 0U, 7U, 31U, 30U, 0U, 12U, 1U, 25U, 31U, 3U})
        records += compressed(time += ahead, step++);
    records += stamped(time - 20, step++);  // set back
    records += compressed(time - 19, step++);
    records += stamped(time - 19, step++);
    expect_as_by_python(file_of(records), 16);
}

TEST(Fit, BigEndianDevelopersFieldsAndChainedFilesAreRead) {
    const std::string big =
        file_of(definition(0, 20, {{253, 4}, {0, 4}, {1, 4}, {2, 2}, {6, 2}}, true) +
                stamped(start, 0, true) + stamped(start + 1, 1, true));
    const std::string with_developers =
        file_of(definition(0, 20, {{253, 4}, {0, 4}, {1, 4}, {2, 2}, {6, 2}}, false, {{9, 3}}) +
                stamped(start + 2, 2) + "abc" + stamped(start + 3, 3) + "abc");
    expect_as_by_python(big, 2);
    expect_as_by_python(with_developers, 2);
    expect_as_by_python(big + with_developers, 4);
    EXPECT_TRUE(has_note(import_text(pos_receiver(), big + with_developers), "holds 2 FIT files"));
}

TEST(Fit, MillisecondsAndVelocitiesOfMetadataAreUsed) {
    std::string records =
        definition(0, 160, {{253, 4}, {0, 2}, {1, 4}, {2, 4}, {3, 4}, {4, 4}, {5, 2}, {7, 6}});
    for (int i = 0; i < 3; ++i)
        records +=
            std::string(1, '\0') + number(start) + number(static_cast<std::uint16_t>(100 * i)) +
            number(latitude + i) + number(longitude) + number<std::uint32_t>(5 * 620) +
            number<std::uint32_t>(5000) + number<std::uint16_t>(9000) + number<std::int16_t>(300) +
            number<std::int16_t>(-400) + number<std::int16_t>(10);
    const Observations read = import_text(pos_receiver(), file_of(records));
    ASSERT_EQ(read.rows.size(), 3U);
    EXPECT_EQ(read.rows[2].time.nanoseconds, 200'000'000);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_velocity_east_m_s, 3.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_velocity_north_m_s, -4.0);
    EXPECT_DOUBLE_EQ(*read.rows[0].recorded_velocity_up_m_s, 0.1);
    EXPECT_DOUBLE_EQ(read.facts.time_resolution_s.value_or(0.0), 0.001);
}

TEST(Fit, WhatHoldsNoValueIsLeftOut) {
    std::string without = stamped(start + 1, 0);
    without.replace(5, 4, number<std::int32_t>(0x7fffffff));
    std::string speedless = stamped(start + 2, 1);
    speedless.replace(13, 4, "\xff\xff\xff\xff");
    Receiver receiver = pos_receiver();
    const Observations read = import_text(
        receiver, file_of(stamped_definition + stamped(start, 0) + without + speedless));
    ASSERT_EQ(read.rows.size(), 2U);
    EXPECT_FALSE(read.rows[1].recorded_speed_m_s);
    EXPECT_FALSE(read.rows[1].height_m);
    EXPECT_TRUE(has_note(read, "1 records have no position"));
}

TEST(Fit, DamageIsSaidWithItsByte) {
    const std::string good =
        file_of(stamped_definition + stamped(start, 0) + stamped(start + 1, 1));
    std::string changed = good;
    changed[50] ^= 1;
    const std::pair<std::string, std::string> cases[] = {
        {changed, "some of its bytes have changed"},
        {good.substr(0, good.size() - 3), "f:byte 0: the file is cut off"},
        {good + "more of it, a tail", "there is no FIT header where a file should begin"},
        {file_of(stamped(start, 0)), "f:byte 14: FIT data of the local type 0 come before"},
        {file_of(stamped_definition + stamped(start, 0).substr(0, 9)), "goes on beyond the end"},
        {file_of(stamped_definition + stamped(77, 0)), "from when the device was switched on"},
    };
    for (const auto& [bytes, what] : cases)
        EXPECT_TRUE(has(failure_of(pos_receiver(), bytes), what))
            << failure_of(pos_receiver(), bytes);
    // A file that its device did not close.
    std::string open = good.substr(0, good.size() - 5);
    open.replace(4, 4, 4, '\0');
    const Observations read = import_text(pos_receiver(), open);
    EXPECT_EQ(read.rows.size(), 1U);
    EXPECT_TRUE(has_note(read, "did not close the file"));
    for (std::size_t size = 0; size < good.size(); ++size)
        EXPECT_NE(failure_of(pos_receiver(), good.substr(0, size)), "read");
}

TEST(FitRecorded, CompressedStampsAreThoseOfAnIndependentDecoder) {
    const auto bytes = recorded("other_programs/compressed_stamps.fit");
    if (!bytes) GTEST_SKIP() << "RUNCERT_DATA is not set";
    expect_as_by_python(*bytes, 2618);
    const Observations read = import_text(pos_receiver(), *bytes);
    for (std::size_t i = 1; i < read.rows.size(); ++i)
        ASSERT_GT(read.rows[i].time.nanoseconds, read.rows[i - 1].time.nanoseconds);
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
