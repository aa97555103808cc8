#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "import_vbo_test_support.h"
#include "stages/import/inspect.h"

// Dates, times of day and longitudes of VBO files, and the recorded runs.

namespace runcert::RUNCERT_FILE {
namespace {

using namespace vbo_test;

TEST(Vbo, TimesOfDay) {
    const struct {
        const char* written;
        const char* utc;
    } cases[] = {{"162235.40", "2006-07-31T16:22:35.400Z"},
                 {"61234.50", "2006-07-31T06:12:34.500Z"},
                 {"5.00", "2006-07-31T00:00:05.000Z"},
                 {"105", "2006-07-31T00:01:05.000Z"},
                 {"16:22:35.40", "2006-07-31T16:22:35.400Z"},
                 {"162235.123456789", "2006-07-31T16:22:35.123Z"}};
    for (const auto& time : cases) {
        Receiver receiver = pos_receiver();
        receiver.start_date = "2006-07-31";
        const Observations read =
            import_vbo(header + replaced(row, "162235.40", time.written), receiver);
        EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), time.utc);
    }
    const Observations read = import_vbo(header + replaced(row, "162235.40", "162235.123456789"));
    EXPECT_EQ(read.facts.first_epoch->nanoseconds() % 1'000'000'000, 123'456'789);
}

TEST(Vbo, MidnightInBothDirections) {
    Receiver receiver = pos_receiver();
    receiver.start_date = "2016-12-31";
    std::string text = header;
    for (const char* time :
         {"235959.00", "235960.00", "000000.00", "000001.00", "235959.50", "000002.00"})
        text += replaced(row, "162235.40", time);
    const Observations read = import_vbo(text, receiver);
    ASSERT_EQ(read.rows.size(), 6u);
    const double seconds[] = {0.0, 1.0, 2.0, 3.0, 0.5, 4.0};
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_EQ(read.rows[i].time.nanoseconds, static_cast<std::int64_t>(seconds[i] * 1e9)) << i;
}

TEST(Vbo, NoMoreThanAHundredYearsOfMidnights) {
    std::string text = header;
    for (int day = 0; day < 36'510; ++day)
        for (const char* time : {"000000", "080000", "160000"})
            text += replaced(row, "162235.40", time);
    const Observations read = import_vbo(text);
    EXPECT_GT(read.records.bad, 0);
    EXPECT_TRUE(has(read.records.bad_records[0].what, "hundred years"));
}

/// The header's local time against the first row's UTC.
struct DateCase {
    const char* name;
    std::string created;
    std::string time;
    double longitude_min;  ///< west positive
    std::string first;     ///< date of the first epoch
    std::string note;
};

class VboDate : public testing::TestWithParam<DateCase> {};

TEST_P(VboDate, OfTheFirstEpoch) {
    const DateCase& date = GetParam();
    const std::string text = replaced(header, "on 31/07/2006 at 17:55:20", date.created) +
                             replaced(replaced(row, "162235.40", date.time), "+00058.49277",
                                      fmt::format("{:.5f}", date.longitude_min));
    const Observations read = import_vbo(text);
    EXPECT_EQ(read.time_scale, "utc");
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch).substr(0, 10), date.first);
    EXPECT_TRUE(has_note(read, date.note));
}

INSTANTIATE_TEST_SUITE_P(
    All, VboDate,
    testing::Values(DateCase{"SameDay", "on 01/08/2025 @ 14:00:12", "190013.04", 5280.0,
                             "2025-08-01", "about 5 h behind UTC"},
                    DateCase{"EveningInAmerica", "on 01/08/2025 @ 21:30:00", "023001.00", 5280.0,
                             "2025-08-02", "about 5 h behind UTC"},
                    DateCase{"MorningInAustralia", "on 01/08/2025 at 08:00:00", "223000.00",
                             -8300.0, "2025-07-31", "about 9 h 30 min ahead of UTC"},
                    DateCase{"NewZealandInSummer", "on 02/01/2025 12:00:00", "230000.00", -10500.0,
                             "2025-01-01", "about 13 h ahead of UTC"},
                    DateCase{"UniversalTime", "on 02/01/2025 at 12:00", "120003.00", -10500.0,
                             "2025-01-02", "equal to UTC"},
                    DateCase{"NewYearsEve", "on 31/12/2024 at 18:00:00", "040000.00", 7000.0,
                             "2025-01-01", "about 10 h behind UTC"},
                    DateCase{"DateAlone", "on 31/12/2024", "040000.00", 7000.0, "2024-12-31",
                             "its date is that of its header"}),
    [](const auto& instance) { return std::string(instance.param.name); });

TEST(VboDate, TheAttemptDecides) {
    Receiver receiver = pos_receiver();
    const std::string text = replaced(header, "31/07/2006 at 17:55:20", "02/01/2025 at 12:00:00") +
                             replaced(row, "162235.40", "230000.00");
    EXPECT_EQ(to_utc_iso(*import_vbo(text).facts.first_epoch, 0), "2025-01-02T23:00:00Z");
    receiver.utc_offset_h = 13.0;
    EXPECT_EQ(to_utc_iso(*import_vbo(text, receiver).facts.first_epoch, 0), "2025-01-01T23:00:00Z");
    receiver.start_date = "2024-02-29";
    const Observations dated = import_vbo(text, receiver);
    EXPECT_EQ(to_utc_iso(*dated.facts.first_epoch, 0), "2024-02-29T23:00:00Z");
    EXPECT_TRUE(has_note(dated, "start_date"));
}

TEST(VboDate, NoneAtAllIsRelative) {
    for (const char* created : {"", "on 2006-07-31 at 17:55:20", "on 32/07/2006 at 17:55:20",
                                "on 31/07/0006", "on yesterday"}) {
        const std::string text =
            replaced(header, "on 31/07/2006 at 17:55:20", created) + row + next_row;
        const Observations read = import_vbo(text);
        EXPECT_EQ(read.time_scale, "relative");
        EXPECT_FALSE(read.facts.first_epoch);
        EXPECT_EQ(read.rows[1].time.nanoseconds, 100'000'000);
        EXPECT_TRUE(has_note(read, "start_date"));
        Receiver receiver = pos_receiver();
        receiver.start_gps =
            GpsTime::from_calendar({.year = 2021, .month = 1, .day = 2, .hour = 0, .minute = 30});
        const Observations dated = import_vbo(text, receiver);
        EXPECT_EQ(to_utc_iso(*dated.facts.first_epoch, 0), "2021-01-01T16:22:35Z");
        EXPECT_FALSE(has_note(dated, "start_gps is not used"));
    }
}

/// 100 rows of 2.5 m towards north-east, longitudes counting in either sense.
std::string towards_north_east(bool east_positive, const char* heading = "045.00") {
    std::string text = header;
    for (int i = 0; i < 100; ++i)
        text += fmt::format("009 1622{:05.2f} {:+.6f} {:+.6f} 090.0 {} 10.0 0.0\r\n", 0.1 * i,
                            3119.0 + 0.00095 * i, (east_positive ? 1 : -1) * (100.0 + 0.0015 * i),
                            heading);
    return text;
}

TEST(VboLongitude, TheHeadingsTellWhichWayItCounts) {
    const Observations east = import_vbo(towards_north_east(true));
    EXPECT_NEAR(*east.rows[0].longitude_deg, 100.0 / 60.0, 1e-9);
    EXPECT_TRUE(has_note(east, "positive to the east, as the headings show"));
    EXPECT_TRUE(has_note(east, "51.98333 N, 1.66667 E"));
    const Observations west = import_vbo(towards_north_east(false));
    EXPECT_NEAR(*west.rows[0].longitude_deg, 100.0 / 60.0, 1e-9);
    EXPECT_TRUE(has_note(west, "positive to the west, as the headings confirm"));
}

TEST(VboLongitude, WithoutEvidenceTheRuleOfTheFormatHolds) {
    const std::string parked = replaced(header + row, "072.000", "000.000");
    for (const std::string& text : {parked + parked.substr(header.size()), header + row,
                                    towards_north_east(true, "000.00")}) {
        const Observations read = import_vbo(text);
        EXPECT_LT(*read.rows[0].longitude_deg, 0.0);
        EXPECT_TRUE(has_note(read, "on the right side of the world"));
    }
}

/// The best mean speed of the epochs of 3 s, one of its ends counted: 75 at 25 Hz. (Both ends
/// counted, as inspect does, give 0.1 km/h less here.)
double best_three_seconds_kmh(const std::vector<Observation>& rows) {
    constexpr std::size_t samples = 75;
    constexpr std::int64_t three_seconds_ns = 3'000'000'000;
    double best_m_s = 0.0;
    std::vector<const Observation*> once;  // without the repeated time stamp
    for (const Observation& row : rows)
        if (once.empty() || row.time > once.back()->time) once.push_back(&row);
    for (std::size_t first = 0; first + samples < once.size(); ++first) {
        if (once[first + samples]->time.nanoseconds - once[first]->time.nanoseconds !=
            three_seconds_ns)
            continue;
        double sum_m_s = 0.0;
        for (std::size_t i = first; i < first + samples; ++i)
            sum_m_s += std::hypot(*once[i]->recorded_velocity_east_m_s,
                                  *once[i]->recorded_velocity_north_m_s);
        best_m_s = std::max(best_m_s, sum_m_s / samples);
    }
    return best_m_s * 3.6;
}

struct Track {
    const char* name;
    std::size_t epochs;
    double by_position_kmh, by_velocity_kmh;
    std::size_t gaps, repeated;
    const char* first;
};

class VboRecorded : public testing::TestWithParam<Track> {};

TEST_P(VboRecorded, AsTheDataSay) {
    const Track& run = GetParam();
    const auto text = recorded(std::string("race_car_vbo/") + run.name + ".vbo");
    if (!text) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Observations read = import_vbo(*text);
    EXPECT_EQ(read.rows.size(), run.epochs);
    EXPECT_EQ(read.records.bad, 0);
    EXPECT_EQ(to_utc_iso(*read.facts.first_epoch), run.first);
    EXPECT_EQ(read.device,
              "VBVDHD2-V12 2cam HDMI 25Hz, serial number 013449, firmware 01.05.05.03 23/10/2023 "
              "17:17:51");
    EXPECT_TRUE(has_note(read, "local time being about 5 h behind UTC"));
    EXPECT_TRUE(has_note(read, "positive to the west, as the headings confirm"));
    EXPECT_NEAR(*read.rows[0].latitude_deg, 43.7967, 1e-4);
    EXPECT_NEAR(*read.rows[0].longitude_deg, -87.9898, 1e-4);
    const Inspection inspection = inspect(read);
    EXPECT_NEAR(inspection.nominal_interval_s, 0.04, 1e-9);
    EXPECT_EQ(inspection.gaps, run.gaps);
    EXPECT_EQ(inspection.repeated_times, run.repeated);
    EXPECT_NEAR(inspection.best_by_position->speed_m_s * 3.6, run.by_position_kmh, 0.05);
    EXPECT_NEAR(inspection.best_by_velocity->speed_m_s * 3.6, run.by_velocity_kmh, 0.15);
    EXPECT_NEAR(best_three_seconds_kmh(read.rows), run.by_velocity_kmh, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    All, VboRecorded,
    testing::Values(Track{"run_a", 5675, 246.5, 246.2, 1, 1, "2025-08-01T19:00:13.040Z"},
                    Track{"run_b", 5586, 261.7, 261.2, 0, 0, "2025-08-01T19:52:20.880Z"}),
    [](const auto& instance) { return std::string(instance.param.name); });

}  // namespace
}  // namespace runcert::RUNCERT_FILE
