#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "files/sha256.h"
#include "golden_files.h"

// What today's reader finds in the files of 1.0; of attempts and rules, in those of the later
// revisions too: golden_1_1_test.cpp to golden_signatures_test.cpp.

namespace runcert {
namespace {

namespace fs = std::filesystem;

using golden::text_of;

TEST(Golden, WritingWhatWasReadFromTheNewestRevisionGivesTheSameBytes) {
    for (const golden::GoldenFile& file : golden::all_files()) {
        SCOPED_TRACE(file.path);
        const std::string text = text_of(file.path);
        const std::string again = file.kind.again(text, file.path);
        if (again.empty()) continue;
        EXPECT_TRUE(again == text || !file.newest) << again;
        // What is written is of the newest revision, and stays as it is.
        EXPECT_EQ(file.kind.again(again, file.path), again);
    }
}

TEST(Golden, EveryFileIsTested) {
    std::set<std::string> paths;
    for (const golden::GoldenFile& file : golden::all_files())
        paths.insert(file.path);
    const fs::path folder = std::string(RUNCERT_SOURCE_DIR) + "/tests/golden";
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        if (entry.is_directory() || entry.path().parent_path() == folder) continue;
        ++count;
        EXPECT_TRUE(paths.contains(fs::relative(entry.path(), folder))) << entry.path();
    }
    EXPECT_EQ(count, paths.size());
}

// What was published is never edited: whoever holds such a file must be able to read it.
TEST(Golden, PublishedFilesStayAsTheyWere) {
    const fs::path folder = std::string(RUNCERT_SOURCE_DIR) + "/tests/golden";
    std::map<std::string, std::string> listed;
    std::istringstream list(text_of("SHA256SUMS"));
    for (std::string hash, file; list >> hash >> file;)
        listed[file] = hash;
    for (const golden::GoldenFile& file : golden::all_files()) {
        EXPECT_EQ(listed[file.path], sha256_hex(text_of(file.path)))
            << file.path
            << ": a golden file changed, or is not listed. Take the published one back from the "
               "history, and put what a new revision adds into a folder of that revision. Only of "
               "a file that no release holds may the line in tests/golden/SHA256SUMS be made anew "
               "(sha256sum).";
        listed.erase(file.path);
    }
    for (const auto& [file, hash] : listed)
        ADD_FAILURE() << file
                      << " is listed in tests/golden/SHA256SUMS and not there: take it back "
                      << "from the history.";
}

/// Every member of `before` is in `after` with the same value; lists have the same length.
void expect_kept(const nlohmann::ordered_json& before, const nlohmann::ordered_json& after,
                 const std::string& path) {
    if (path == "/schema/version") return;
    SCOPED_TRACE(path);
    if (before.is_array()) {
        ASSERT_EQ(before.size(), after.size());
        for (std::size_t i = 0; i < before.size(); ++i)
            expect_kept(before[i], after[i], path + "/" + std::to_string(i));
    } else if (before.is_object()) {
        for (const auto& [key, value] : before.items()) {
            ASSERT_TRUE(after.contains(key)) << key;
            expect_kept(value, after[key], path + "/" + key);
        }
    } else {
        EXPECT_EQ(before, after);
    }
}

/// The cells of the columns of `before` are the same in `after`.
void expect_cells_kept(EcsvReader before, EcsvReader after) {
    const auto cell = [](const EcsvReader& table, std::size_t column) {
        return table.is_missing(column) ? std::string() : table.text(column);
    };
    while (before.next_row()) {
        ASSERT_TRUE(after.next_row());
        for (std::size_t i = 0; i < before.columns().size(); ++i) {
            const std::string& name = before.columns()[i].name;
            const auto same = std::ranges::find(after.columns(), name, &EcsvColumn::name);
            ASSERT_NE(same, after.columns().end()) << name;
            const auto column = static_cast<std::size_t>(same - after.columns().begin());
            EXPECT_EQ(cell(before, i), cell(after, column)) << name;
        }
    }
    EXPECT_FALSE(after.next_row());
}

TEST(Golden, WritingWhatWasReadFromAnEarlierRevisionKeepsEveryFigure) {
    int count = 0;
    for (const golden::GoldenFile& file : golden::all_files()) {
        const std::string text = text_of(file.path);
        const std::string again = file.kind.again(text, file.path);
        if (file.newest || again.empty()) continue;
        SCOPED_TRACE(file.path);
        ++count;
        const auto json = [&](const std::string& of) {
            return json_from_yaml(
                {file.is_table ? EcsvReader(of, "f").meta() : parse_yaml(of, "f"), "f"});
        };
        expect_kept(json(text), json(again), "");
        if (file.is_table) expect_cells_kept(EcsvReader(text, "f"), EcsvReader(again, "f"));
    }
    EXPECT_EQ(count, 1);
}

TEST(Golden, Observations) {
    const Observations table = read_observations(text_of("v1.0/1-observations.ecsv"), "f");
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
    const EnuTable table = read_enu(text_of("v1.0/2-enu.ecsv"), "f");
    ASSERT_TRUE(table.origin);
    EXPECT_EQ(table.origin->position.latitude.degrees(), 35.134709483);
    EXPECT_EQ(table.origin->position.height_m, 104.728);
    EXPECT_EQ(table.origin->source, "attempt");
    EXPECT_EQ(table.rows.at(3).north_m, 6.324);
    EXPECT_FALSE(table.rows.at(3).correlation_north_up);
    EXPECT_FALSE(table.rows.at(4).east_m);
}

TEST(Golden, Screened) {
    const ScreenedTable table = read_screened(text_of("v1.0/3-screened.ecsv"), "f");
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
    const TrajectoryTable table = read_trajectory(text_of("v1.0/4-trajectory.ecsv"), "f");
    EXPECT_EQ(table.estimation.degrees_of_freedom, 15);
    EXPECT_EQ(table.estimation.variance_factor, 0.9876);
    EXPECT_EQ(table.estimation.largest_position_difference_m, 2.5e-11);
    EXPECT_EQ(table.rows.at(2).speed_mps, 21.158421);
    EXPECT_EQ(table.rows.at(2).speed_v2_mps, 21.17);
    EXPECT_FALSE(table.rows.at(3).speed_v1_mps);
    EXPECT_TRUE(table.rows.at(3).usable);
    EXPECT_FALSE(table.rows.at(4).speed_mps);
    EXPECT_EQ(table.rows.at(2).arc, 1);
}

TEST(Golden, Windows) {
    const Windows windows = read_windows(text_of("v1.0/5-windows.yaml"), "f");
    ASSERT_EQ(windows.profiles.size(), 5U);
    const ProfileWindows& nalsa = windows.profiles[0];
    EXPECT_EQ(nalsa.candidates, 271);
    ASSERT_TRUE(nalsa.best && nalsa.indicated);
    EXPECT_EQ(nalsa.best->span.start.nanoseconds, 10'000'000'000);
    EXPECT_EQ(nalsa.best->span.duration.nanoseconds, 3'000'000'000);
    EXPECT_EQ(to_iso(*nalsa.best->span.start_gps), "2022-03-18T08:51:32.300");
    EXPECT_EQ(nalsa.best->speed_mps, 56.375);
    EXPECT_EQ(speed_by(nalsa.best->definitions, "mean_n"), 56.385);
    EXPECT_EQ(nalsa.best->methods.kalman_mps, 56.4);
    EXPECT_EQ(nalsa.indicated->refusals.at(1), "A gap of 0.3 s lies inside.");
    EXPECT_FALSE(windows.profiles[1].best || windows.profiles[1].indicated);
}

TEST(Golden, VerdictFile) {
    const Verdict verdict = read_verdict(text_of("v1.0/6-verdict.yaml"), "f");
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
    const Attempt attempt = read_attempt(text_of("v1.0/attempt.yaml"), "f");
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
    EXPECT_FALSE(attempt.receivers.at(0).rotation_bound_deg);
    EXPECT_EQ(attempt.parameters.at("smooth").at("noise"), "fitted");
    EXPECT_EQ(attempt.parameters.at("window").at("seed"), 1);
    EXPECT_EQ(attempt.parameters.at("screen").at("steps"), "end_arc");
}

TEST(Golden, ProfileFile) {
    const Profile profile = read_profile(text_of("v1.0/profile.yaml"), "f");
    EXPECT_EQ(profile.id, "my-rule");
    EXPECT_EQ(profile.margin, 0.1);
    EXPECT_EQ(profile.rounding->mode, "nearest");
    EXPECT_EQ(profile.clauses.size(), 6U);
    EXPECT_EQ(profile.uncertainty.tau_max_s, 10.0);
    EXPECT_EQ(profile.uncertainty.error_floor_m.at("fixed"), 0.02);
    EXPECT_FALSE(profile.repaired_steps);
}

TEST(Golden, SimulationFile) {
    const SimulationDocument simulation = read_simulation(text_of("v1.0/simulation.yaml"), "f");
    EXPECT_EQ(simulation.spec.run.top_speed_mps, 60.0);
    EXPECT_EQ(simulation.spec.duration_ms, 45'000);
    EXPECT_EQ(simulation.spec.interval_ms, 100);
    EXPECT_EQ(simulation.attempt["id"], "simulated");
}

}  // namespace
}  // namespace runcert
