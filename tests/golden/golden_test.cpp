#include <filesystem>
#include <set>

#include "golden_files.h"

// Every published version is read for ever: what today's reader finds in the files of 1.0.

namespace runcert {
namespace {

using golden::text_of;

TEST(Golden, WritingWhatWasReadGivesTheSameBytes) {
    std::set<std::string> names;
    for (const auto& file : golden::files) {
        SCOPED_TRACE(file.name);
        const std::string text = text_of(file.name);
        const std::string again = file.again(text, file.name);
        EXPECT_TRUE(again.empty() || again == text) << again;
        names.insert(file.name);
    }
    const std::string folder = std::string(RUNCERT_SOURCE_DIR) + "/tests/golden/v1.0";
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        EXPECT_TRUE(names.contains(entry.path().filename())) << entry.path() << " is not tested";
}

TEST(Golden, Observations) {
    const Observations table = read_observations(text_of("1-observations.ecsv"), "f");
    EXPECT_EQ(table.header.stage, "import");
    EXPECT_EQ(table.header.source_revision, "0123456789ab");
    ASSERT_EQ(table.header.inputs.size(), 2U);
    EXPECT_EQ(table.header.inputs[1].original, "rover.pos");
    EXPECT_EQ(table.header.parameters["format"], "auto");
    EXPECT_EQ(table.facts.receiver, "primary");
    EXPECT_EQ(to_iso(*table.facts.first_epoch), "2022-03-18T08:51:22.300");
    EXPECT_EQ(table.facts.nominal_interval_s, 0.1);
    EXPECT_EQ(table.format, "rtklib-pos");
    EXPECT_EQ(table.frame, "geodetic");
    EXPECT_EQ(table.time_scale, "gps");
    EXPECT_EQ(table.accuracy_source, "recording");
    EXPECT_EQ(table.notes.at(1), "Time is GPST: \"as written\".");
    ASSERT_EQ(table.rows.size(), 5U);
    const Observation& row = table.rows[1];
    EXPECT_EQ(row.epoch, 2);
    EXPECT_EQ(row.time.nanoseconds, 100'000'000);
    EXPECT_EQ(row.latitude_deg, 35.134728483);
    EXPECT_EQ(row.longitude_deg, 136.97757227512);
    EXPECT_EQ(row.height_m, 104.7291);
    EXPECT_EQ(row.correlation_north_up, 0.0625);
    EXPECT_EQ(row.sigma_recorded_velocity_up_mps, 0.1);
    EXPECT_EQ(row.fix, FixKind::fixed);
    EXPECT_EQ(row.satellites, 16);
    EXPECT_EQ(row.ratio, 999.9);
    EXPECT_EQ(row.source_byte, 1163);
    EXPECT_FALSE(row.plane_east_m);
    EXPECT_EQ(table.rows[2].fix, FixKind::float_ambiguities);
    EXPECT_EQ(table.rows[4].fix, FixKind::none);
    EXPECT_FALSE(table.rows[4].latitude_deg);
}

TEST(Golden, Enu) {
    const EnuTable table = read_enu(text_of("2-enu.ecsv"), "f");
    ASSERT_TRUE(table.origin);
    EXPECT_EQ(table.origin->position.latitude.degrees(), 35.134709483);
    EXPECT_EQ(table.origin->position.height_m, 104.728);
    EXPECT_EQ(table.origin->source, "attempt");
    EXPECT_EQ(table.rows.at(3).north_m, 6.324);
    EXPECT_FALSE(table.rows.at(3).correlation_north_up);
    EXPECT_FALSE(table.rows.at(4).east_m);
}

TEST(Golden, Screened) {
    const ScreenedTable table = read_screened(text_of("3-screened.ecsv"), "f");
    EXPECT_EQ(table.variance_factor, 1.2345);
    EXPECT_EQ(table.header.parameters["false_alarm_rate"], 1e-6);
    EXPECT_EQ(table.rows.at(0).break_before, ArcBreak::start);
    EXPECT_TRUE(table.rows.at(1).usable);
    EXPECT_EQ(table.rows.at(1).statistic, 2.0625);
    EXPECT_EQ(table.rows.at(1).threshold, 30.66485);
    EXPECT_EQ(table.rows.at(2).reason, Reason::float_ambiguities);
    EXPECT_EQ(table.rows.at(4).reason, Reason::no_position);
    EXPECT_FALSE(table.rows.at(4).arc);
}

TEST(Golden, Trajectory) {
    const TrajectoryTable table = read_trajectory(text_of("4-trajectory.ecsv"), "f");
    EXPECT_EQ(table.estimation.degrees_of_freedom, 15);
    EXPECT_EQ(table.estimation.variance_factor, 0.9876);
    EXPECT_EQ(table.estimation.largest_position_difference_m, 2.5e-11);
    EXPECT_EQ(table.rows.at(2).speed_mps, 21.158421);
    EXPECT_EQ(table.rows.at(2).speed_v2_mps, 21.17);
    EXPECT_FALSE(table.rows.at(3).speed_v1_mps);
    EXPECT_TRUE(table.rows.at(3).usable);
    EXPECT_FALSE(table.rows.at(4).speed_mps);
}

TEST(Golden, Windows) {
    const Windows windows = read_windows(text_of("5-windows.yaml"), "f");
    ASSERT_EQ(windows.profiles.size(), 2U);
    const ProfileWindows& nalsa = windows.profiles[0];
    EXPECT_EQ(nalsa.candidates, 271);
    ASSERT_TRUE(nalsa.best && nalsa.indicated);
    EXPECT_EQ(nalsa.best->span.start.nanoseconds, 10'000'000'000);
    EXPECT_EQ(nalsa.best->span.duration.nanoseconds, 3'000'000'000);
    EXPECT_EQ(to_iso(*nalsa.best->span.start_gps), "2022-03-18T08:51:32.300");
    EXPECT_EQ(nalsa.best->speed_mps, 56.375);
    EXPECT_EQ(nalsa.best->definitions.by_name("mean_n"), 56.385);
    EXPECT_EQ(nalsa.best->methods.kalman_mps, 56.4);
    EXPECT_EQ(nalsa.indicated->refusals.at(1), "A gap of 0.3 s lies inside.");
    EXPECT_FALSE(windows.profiles[1].best || windows.profiles[1].indicated);
}

TEST(Golden, VerdictFile) {
    const Verdict verdict = read_verdict(text_of("6-verdict.yaml"), "f");
    EXPECT_EQ(verdict.attempt, "urban-car");
    EXPECT_EQ(verdict.record->speed, 202.9);
    EXPECT_DOUBLE_EQ(verdict.record->speed_mps, 202.9 / 3.6);
    const ProfileVerdict& nalsa = verdict.profiles.at(0);
    EXPECT_EQ(nalsa.outcome, "not_beaten");
    EXPECT_EQ(nalsa.speed_mps, 56.375);
    EXPECT_EQ(nalsa.target_mps, 56.808151);
    EXPECT_EQ(nalsa.window->last_epoch, 131);
    EXPECT_EQ(nalsa.requirements.at(2).status, "attest");
    EXPECT_EQ(nalsa.indicated->speed_mps, 57.5);
    EXPECT_FALSE(verdict.profiles.at(1).speed_mps);
}

TEST(Golden, AttemptFile) {
    const Attempt attempt = read_attempt(text_of("attempt.yaml"), "f");
    EXPECT_EQ(attempt.id, "urban-car_2");
    EXPECT_EQ(attempt.place, "\xe5\x90\x8d\xe5\x8f\xa4\xe5\xb1\x8b (Nagoya)");
    EXPECT_EQ(attempt.date, "2022-03-18");
    EXPECT_EQ(attempt.receivers.at(0).utm_zone->zone, 53);
    EXPECT_TRUE(attempt.receivers.at(0).utm_zone->northern);
    EXPECT_EQ(attempt.receivers.at(0).columns.size(), 12U);
    EXPECT_EQ(attempt.receivers.at(0).columns.at("sigma_up"), "7");
    EXPECT_EQ(attempt.receivers.at(0).lever_arm->z(), -1.2);
    EXPECT_EQ(attempt.receivers.at(1).frame, CoordinateFrame::geodetic);
    EXPECT_EQ(attempt.profiles.at(1), "rules/my-rule.yaml");
    EXPECT_EQ(attempt.parameters.at("smooth").at("jerk_density"), 1.25);
    EXPECT_EQ(attempt.overrides.size(), 11U);
}

TEST(Golden, ProfileFile) {
    const Profile profile = read_profile(text_of("profile.yaml"), "f");
    EXPECT_EQ(profile.id, "my-rule");
    EXPECT_EQ(profile.margin, 0.1);
    EXPECT_EQ(profile.rounding->mode, "nearest");
    EXPECT_EQ(profile.clauses.size(), 6U);
}

TEST(Golden, SimulationFile) {
    const SimulationDocument simulation = read_simulation(text_of("simulation.yaml"), "f");
    EXPECT_EQ(simulation.spec.run.top_speed_mps, 60.0);
    EXPECT_EQ(simulation.spec.duration_ms, 45'000);
    EXPECT_EQ(simulation.spec.interval_ms, 100);
    EXPECT_EQ(simulation.attempt["id"], "simulated");
}

}  // namespace
}  // namespace runcert
