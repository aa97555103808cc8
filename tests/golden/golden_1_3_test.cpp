#include "golden_files.h"

// What observations/1.2, enu/1.2, screened/1.3 and attempt/1.3 added: recordings in several files,
// with records that cannot be read.

namespace runcert {
namespace {

using golden::text_of;

TEST(Golden13, RecordsThatCouldNotBeRead) {
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(table.variant, "with velocities");
    EXPECT_EQ(table.device, "logger, firmware 1.2");
    EXPECT_EQ(table.records.total, 7);
    EXPECT_EQ(table.records.bad, 2);
    ASSERT_EQ(table.records.bad_records.size(), 2U);
    const BadRecord& line = table.records.bad_records[0];
    EXPECT_EQ(line.line, std::optional<std::int64_t>(27));
    EXPECT_EQ(line.column, std::optional<std::int64_t>(14));
    EXPECT_EQ(line.byte, 1812);
    EXPECT_EQ(line.epoch, 2);
    EXPECT_EQ(line.what, "the height \"n/a\" is not a number");
    EXPECT_FALSE(table.records.bad_records[1].line);
    EXPECT_EQ(table.records.bad_records[1].file, std::optional<std::int32_t>(2));
}

TEST(Golden13, TheFileOfEachRow) {
    const Observations observations = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
    EXPECT_EQ(*observations.rows.at(1).source_file, 1);
    EXPECT_EQ(*observations.rows.at(2).source_file, 2);
    EXPECT_EQ(*read_enu(text_of("v1.0/2-enu.ecsv"), "f").rows.at(2).source_file, 2);
    const ScreenedTable screened = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
    EXPECT_FALSE(screened.rows.at(0).source_file);
    EXPECT_EQ(*screened.rows.at(5).source_file, 2);
}

TEST(Golden13, Attempt) {
    const Attempt attempt = read_attempt(text_of("v1.3/attempt.yaml"), "f");
    EXPECT_EQ(attempt.receivers.at(0).utc_offset_h, 9.0);
    EXPECT_EQ(attempt.receivers.at(0).start_date, "2022-03-18");
    EXPECT_EQ(attempt.receivers.at(0).gpsbabel_type, "garmin_fit");
    const Receiver& raw = attempt.receivers.at(1);
    EXPECT_EQ(raw.recordings, (std::vector<std::string>{"raw/rover.obs", "raw/rover2.obs"}));
    EXPECT_EQ(raw.base, "raw/base.obs");
    EXPECT_EQ(raw.navigation, (std::vector<std::string>{"raw/gps.nav", "raw/glonass.nav"}));
    EXPECT_EQ(raw.base_position->latitude.degrees(), 35.25);
    EXPECT_EQ(raw.solution_pass, "backward");
}

}  // namespace
}  // namespace runcert
