#include <fmt/format.h>
#include <gtest/gtest.h>

#include "chain_support.h"

// The collections of small inputs that came out wrong, beside the recordings (RUNCERT_DATA/../cases
// and cases-4): what is right of each, as their EXPECT.md and expected.txt say it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Of an attempt what certify says, else what inspect says of a recording.
struct Case {
    const char* file;
    int exit_status;
    std::vector<const char*> said;
    std::vector<const char*> never_said = {};
};

void PrintTo(const Case& one, std::ostream* out) {
    *out << one.file;
}

class Cases : public testing::TestWithParam<Case> {};

/// Without line breaks, which terminals put anywhere.
std::string in_one_line(std::string text) {
    std::string joined;
    for (const char c : text)
        if (c != '\n' && c != ' ')
            joined += c;
        else if (!joined.ends_with(' '))
            joined += ' ';
    return joined;
}

TEST_P(Cases, ComeOutRight) {
    const Case& one = GetParam();
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const fs::path file = data->parent_path() / one.file;
    if (!fs::exists(file)) GTEST_SKIP() << file << " is not there";
    const TemporaryFolder folder;
    ProcessResult result;
    if (file.extension() == ".yaml") {
        for (const auto& entry : fs::directory_iterator(file.parent_path()))
            bring(entry.path(), folder.path());
        result = certify(folder.path() / file.filename(), folder.path() / "run", {"--no-render"});
        if (fs::exists(folder.path() / "run" / "1-observations.ecsv"))
            result.output +=
                read_file(folder.path() / "run" / "1-observations.ecsv").substr(0, 20000);
    } else {
        result = runcert({"inspect", file.string()});
    }
    const std::string all = in_one_line(result.output + result.errors);
    EXPECT_EQ(result.exit_status, one.exit_status) << all.substr(0, 4000);
    for (const char* words : one.said)
        EXPECT_NE(all.find(words), std::string::npos) << words << "\n" << all.substr(0, 4000);
    for (const char* words : one.never_said)
        EXPECT_EQ(all.find(words), std::string::npos) << words << "\n" << all.substr(0, 4000);
}

const Case fourth[] = {
    {"cases-4/dates-with-a-month-name/attempt.yaml", 0, {"108.92 km/h"}},
    {"cases-4/dates-with-a-month-name/harry.csv",
     0,
     {"UTC 2026-03-14T10:00:22.000Z"},
     {"No column holds a date"}},
    {"cases-4/dates-with-a-month-name/torque.csv", 0, {"UTC 2026-03-14T10:00:00.000Z", "109."}},
    {"cases-4/fit-without-courses/attempt.yaml", 0, {"108.9 km/h"}, {"course is north"}},
    {"cases-4/fit-without-courses/run.fit", 0, {"speed without a course"}, {"course is north"}},
    {"cases-4/geoid-separation-missing/attempt.yaml", 0, {"108.95 km/h"}},
    {"cases-4/geoid-separation-missing/attempt_tail.yaml", 0, {"108.95 km/h"}},
    {"cases-4/geoid-separation-missing/attempt_control.yaml", 0, {"108.95 km/h"}},
    {"cases-4/hemisphere-in-a-column-of-its-own/attempt.yaml",
     0,
     {"108.96 km/h", "Hemispheres are those of"}},
    {"cases-4/hemisphere-in-a-column-of-its-own/attempt_control.yaml", 0, {"108.96 km/h"}},
    {"cases-4/inertial-explorer-dms/traj.txt",
     0,
     {"latitude: Latitude", "By position 109.0 km/h", "degrees, minutes, seconds"}},
    {"cases-4/iso-offset-in-a-table/attempt.yaml", 0, {"108.9 km/h"}},
    {"cases-4/iso-offset-in-a-table/attempt_pandas.yaml", 0, {"108.9 km/h"}},
    {"cases-4/iso-offset-in-a-table/vakaros.csv",
     0,
     {"UTC 2026-03-14T10:00:00.000Z"},
     {"whether times are UTC"}},
    {"cases-4/mock-location-column/attempt.yaml", 0, {"108.952 km/h"}, {"says that it was simul"}},
    {"cases-4/newest-first/attempt.yaml", 0, {"109.0 km/h", "newest first"}},
    {"cases-4/newest-first/attempt_control.yaml", 0, {"109.0 km/h"}},
    {"cases-4/oxts-columns/oxts.csv",
     0,
     {"height: \"Position altitude (m)\"", "velocity_up: \"Velocity down (m/s)\"",
      "sigma_east: \"East position accuracy (m)\"", "fixed 240"},
     {"whether times are UTC", "No column holds heights"}},
    {"cases-4/qstarz-units-and-letters/attempt.yaml",
     0,
     {"108.9 km/h", "milliseconds of times are those of"}},
    {"cases-4/qstarz-units-and-letters/log.csv",
     0,
     {"\"N/S\"", "10.00 Hz", "speed: SPEED", "height: HEIGHT"},
     {"share one time stamp"}},
    {"cases-4/racecapture-log/attempt.yaml", 0, {"108.94 km/h"}},
    {"cases-4/racecapture-log/rc_1.log", 0, {"latitude: Latitude", "is in mph", "10.00 Hz"}},
    {"cases-4/radians-in-the-column-name/attempt.yaml",
     2,
     {"\"lat_rad\" is in rad", "coordinates in degrees"}},
    {"cases-4/rmc-faster-than-gga/attempt.yaml", 0, {"108.9 km/h"}},
    {"cases-4/rmc-faster-than-gga/attempt_control.yaml", 0, {"108.9 km/h"}},
    {"cases-4/rows-in-bursts/attempt.yaml", 2, {"bursts (3 within 0.002 s, then 0.298 s)"}},
    {"cases-4/rows-in-bursts/attempt_gpx.yaml", 2, {"come in bursts"}},
    {"cases-4/rows-in-bursts/log.csv",
     0,
     {"Time stamps come in bursts (3 within 0.002 s, then 0.298 s)"},
     {"1000.00 Hz"}},
    {"cases-4/single-precision-positions/attempt.yaml", 0, {"108.9 km/h", "single precision"}},
    {"cases-4/single-precision-positions/log.csv", 0, {"single precision", "steps of 1.4 m"}},
    {"cases-4/speed-column-not-found/attempt.yaml", 1, {"has no speeds", "GPS (2D speed) [m/s]"}},
    {"cases-4/speed-column-not-found/GX01-GPS5.csv", 0, {"speed: \"GPS (2D speed) [m/s]\""}},
    {"cases-4/speed-unit-in-the-name/attempt.yaml", 2, {"The header says km/h"}},
    {"cases-4/speed-unit-in-the-name/attempt_kmh.yaml", 0, {"108.92 km/h"}},
    {"cases-4/speed-unit-in-the-name/log.csv",
     0,
     {"speed_unit: km/h", "By recorded velocity 109.0"}},
    {"cases-4/speed-unit-in-the-name/kmh.csv",
     0,
     {"speed_unit: km/h", "By recorded velocity 109.0"}},
    {"cases-4/speed-unit-in-the-name/cm.csv", 0, {"is in cm/s", "By recorded velocity 108.9"}},
    {"cases-4/ubx-hpposllh-without-pvt/attempt.yaml", 0, {"108.951 km/h"}},
    {"cases-4/unicore-um980/bestpos.asc", 0, {"fixed 121", "By position 109.0 km/h"}},
    {"cases-4/unicore-um980/bestnav.asc", 0, {"fixed 121", "By recorded velocity 109.0 km/h"}},
    {"cases-4/velocity-spike-of-one-sample/attempt.yaml",
     1,
     {"its neighbours contradict"},
     {"Measured speed exceeds"}},
    {"cases-4/velocity-spike-of-one-sample/attempt_sacc.yaml", 1, {"its neighbours contradict"}},
    {"cases-4/velocity-spike-of-one-sample/attempt_control.yaml", 1, {"108.9 km/h"}}};

const Case first[] = {
    {"cases/csv-did-you-mean/attempt.yaml", 2, {"Did you mean \"Alt(m)\""}},
    {"cases/csv-unix-milliseconds/attempt.yaml", 0, {"109.33 km/h"}},
    {"cases/csv-us-date-am-pm/attempt.yaml", 0, {"109.33 km/h"}},
    {"cases/date-mismatch-week-rollover/attempt.yaml", 1, {"rollover of the GPS week"}},
    {"cases/igc-date-before-midnight/run.igc",
     0,
     {"2025-12-31T23:59:24.000Z to 2026-01-01T00:00:34.000Z", "Gaps none"}},
    {"cases/no-speeds-wrong-reason/attempt.yaml", 1, {"the recording has no speeds"}},
    {"cases/racebox-vbo-lng/run.vbo", 0, {"By recorded velocity 109."}},
    {"cases/session-of-later-time-first/attempt.yaml", 0, {"109.33 km/h"}},
    {"cases/speed-channel-43s-late/attempt.yaml", 1, {"42.7 s behind the positions"}},
    {"cases/time-jump-few-epochs-pos/attempt.yaml", 0, {"109.33 km/h"}}};

std::string name_of(const testing::TestParamInfo<Case>& info) {
    std::string name;
    for (const char c : std::string(info.param.file))
        name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
    return name;
}

INSTANTIATE_TEST_SUITE_P(First, Cases, testing::ValuesIn(first), name_of);
INSTANTIATE_TEST_SUITE_P(Fourth, Cases, testing::ValuesIn(fourth), name_of);

// A case without an expectation here would pass unseen.
TEST(CasesAll, HaveAnExpectation) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    for (const char* collection : {"cases", "cases-4"}) {
        if (!fs::exists(data->parent_path() / collection)) continue;
        for (const auto& entry : fs::directory_iterator(data->parent_path() / collection)) {
            if (!entry.is_directory()) continue;
            const std::string begin =
                fmt::format("{}/{}/", collection, entry.path().filename().string());
            // Of rules, and not of reading.
            if (begin == "cases/skydive-performance-window/") continue;
            const auto is_of = [&](const Case& one) {
                return std::string_view(one.file).starts_with(begin);
            };
            EXPECT_TRUE(std::ranges::any_of(first, is_of) || std::ranges::any_of(fourth, is_of))
                << begin;
        }
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
