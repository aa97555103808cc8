#include <fmt/ranges.h>

#include <sstream>

#include "core/text.h"
#include "rules_support.h"
#include "schemas/screened/screened.h"

// What the rules say of real recordings whose speeds a logger or a published score tells.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr double kmh = 1.0 / 3.6;

ScreenedTable screened_of(const Rules& rules) {
    return read_screened(read_file(rules.run() / "3-screened.ecsv"), "3-screened");
}

// Three loggers of one rider, with their own results.

/// The fastest 2 s and 10 s and the mean of the five fastest 10 s of a logger's results, km/h.
struct DeviceResults {
    double two_s = 0.0, ten_s = 0.0, five_of_ten_s = 0.0;
};

DeviceResults device_results(const fs::path& file) {
    std::istringstream lines(read_file(file));
    DeviceResults results;
    std::vector<double> means;
    for (std::string line; std::getline(lines, line);) {
        const double value = parse_double(line.substr(0, line.find(' '))).value_or(0.0);
        if (contains(line, "avg 5_best_runs")) means.push_back(value);
        if (contains(line, " S2") && results.two_s == 0.0) results.two_s = value;
        if (contains(line, " S10") && results.ten_s == 0.0) results.ten_s = value;
    }
    results.five_of_ten_s = means.at(1);  // after that of the 2 s
    return results;
}

struct LoggerSpeed {
    double speed_m_s = 0.0, standard_uncertainty_m_s = 0.0;
};

const std::vector<std::string> logger_profiles{"gps-speed-sailing-2s", "gps-speed-sailing-10s",
                                               "gps-speed-sailing-5x10s"};

/// Judges a logger's recording against its own results, and gives the measured speeds.
std::vector<LoggerSpeed> judged_logger(const fs::path& data, const std::string& logger,
                                       std::size_t epochs, std::int64_t usable) {
    SCOPED_TRACE(logger);
    const Rules rules;
    rules.bring_in(data / (logger + ".oao"));
    // The speeds are of recorded velocities: the noise of positions has no part in them.
    const Verdict verdict = rules.judge(
        fmt::format("schema: attempt/1.0\nid: loggers\ncraft: {{name: board, class: board}}\n"
                    "receivers: [{{id: primary, recording: {}.oao}}]\nprofiles: [{}]\n"
                    "parameters: {{smooth: {{noise: stated}}}}\n",
                    logger, fmt::join(logger_profiles, ", ")));
    const ScreenedTable screened = screened_of(rules);
    EXPECT_EQ(screened.rows.size(), epochs);
    EXPECT_NEAR(static_cast<double>(summarise(screened.rows).usable), static_cast<double>(usable),
                0.002 * static_cast<double>(epochs));
    const DeviceResults own = device_results(data / (logger + "_device_results.txt"));
    const std::vector<ProfileWindows> windows = rules.windows().profiles;
    // The windows that show most by what they state of themselves: hardly slower than the fastest.
    const double indicated[] = {windows.at(0).indicated->speed_m_s * 3.6,
                                windows.at(1).indicated->speed_m_s * 3.6,
                                *windows.at(2).indicated->mean_m_s * 3.6};
    const double of_logger[] = {own.two_s, own.ten_s, own.five_of_ten_s};
    for (const std::size_t i : {0U, 1U, 2U}) {
        EXPECT_LE(indicated[i], of_logger[i] + 0.005) << i;
        EXPECT_GE(indicated[i], of_logger[i] - 0.06) << i;
    }
    const double of_device[] = {own.two_s, own.ten_s, own.five_of_ten_s};
    std::vector<LoggerSpeed> speeds;
    for (std::size_t i = 0; i < 3; ++i) {
        const ProfileVerdict& profile = verdict.profiles.at(i);
        EXPECT_EQ(profile.outcome, Outcome::not_proven) << profile.reason;  // no record is named
        // To the last digit that the logger prints.
        EXPECT_EQ(profile.own_arithmetic.shown, fmt::format("{:.3f} km/h", of_device[i]));
        EXPECT_NEAR(*profile.speed_m_s, of_device[i] * kmh, 0.25 * kmh);
        EXPECT_NEAR(*profile.speed_m_s, of_device[i] * kmh, *profile.expanded_uncertainty_m_s);
        EXPECT_LT(*profile.expanded_uncertainty_m_s, 1.2 * kmh);
        speeds.push_back({*profile.speed_m_s, 0.5 * *profile.expanded_uncertainty_m_s});
    }
    return speeds;
}

TEST(WindsurfLoggers, AgreeWithTheirOwnResultsAndWithOneAnother) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const fs::path folder = *data / "windsurf_loggers";
    const std::vector<std::vector<LoggerSpeed>> all{
        judged_logger(folder, "head_left", 56055, 56017),
        judged_logger(folder, "head_right", 55937, 55913),
        judged_logger(folder, "boom_left", 55779, 52136)};
    for (std::size_t rule = 0; rule < logger_profiles.size(); ++rule)
        for (std::size_t i = 0; i < all.size(); ++i)
            for (std::size_t j = 0; j < i; ++j)
                EXPECT_LE(std::abs(all[i][rule].speed_m_s - all[j][rule].speed_m_s),
                          2.0 * std::hypot(all[i][rule].standard_uncertainty_m_s,
                                           all[j][rule].standard_uncertainty_m_s))
                    << logger_profiles[rule] << ' ' << i << ' ' << j;
}

// Speed skydives.

/// By the rule of before 2026, whose runs it still judges.
ProfileVerdict judged_skydive(const Rules& rules, const fs::path& recording,
                              const std::string& date) {
    rules.bring_in(recording);
    return rules.judge_one(
        fmt::format("schema: attempt/1.0\nid: skydive\ncraft: {{name: diver, class: skydiver}}\n"
                    "date: \"{}\"\n"
                    "receivers: [{{id: primary, recording: {}}}]\nprofiles: [fai-speed-skydiving]\n"
                    "record: {{speed: 400, unit: km/h, source: none, expanded_uncertainty: 4}}\n",
                    date, recording.filename().string()));
}

TEST(SpeedSkydive, OfAGoodRecordingScores) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Rules rules;
    const ProfileVerdict verdict =
        judged_skydive(rules, *data / "speed_skydive" / "flysight1_good.csv", "2023-08-20");
    // 444.61 km/h by the heights at both ends, 443.47 as the mean of the recorded velocities.
    EXPECT_NEAR(rules.windows().profiles.at(0).indicated->speed_m_s * 3.6, 443.6, 0.1);
    // What the choice of the window added is told by the velocities.
    EXPECT_NEAR(*verdict.speed_m_s * 3.6, 443.6, 0.1);
    EXPECT_NEAR(*verdict.speed_m_s * 3.6, 444.61, *verdict.expanded_uncertainty_m_s * 3.6);
    EXPECT_NEAR(rules.windows().profiles.at(0).best->witnesses.at(0).speed_m_s * 3.6, 443.6, 0.1);
    EXPECT_LE(*verdict.expanded_uncertainty_m_s * 3.6, 3.0);
    EXPECT_EQ(verdict.window->duration.seconds(), 3.0);
    for (const char* clause : {"average-over-3-s", "sampling-rate", "sample-accuracy",
                               "positions-on-the-earth", "fastest-certifiable"})
        EXPECT_EQ(requirement_of(verdict, clause).status, RequirementStatus::met)
            << requirement_of(verdict, clause).evidence;
    // Over the record that the attempt names: 404 km/h and 2 %.
    EXPECT_EQ(requirement_of(verdict, "margin").status, RequirementStatus::attest);
    EXPECT_NEAR(*verdict.required_speed_m_s * 3.6, 412.08, 1e-5);
    EXPECT_EQ(verdict.outcome, Outcome::beaten) << verdict.reason;
}

TEST(SpeedSkydive, WithBadAccuracyAndGapsIsRefused) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Rules rules;
    const ProfileVerdict verdict = judged_skydive(
        rules, *data / "speed_skydive" / "flysight1_bad_accuracy_gaps.csv", "2024-10-08");
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_EQ(requirement_of(verdict, "fastest-certifiable").status, RequirementStatus::not_met);
    for (const char* part :
         {"the recording's velocities show 309", "absurd stated standard deviation",
          "what the score would be is not known"})
        EXPECT_TRUE(contains(verdict.reason, part)) << verdict.reason;
}

// A race car.

/// Mean velocity of the recording over a window, its delay behind the positions taken off (m/s).
double recorded_speed_over(const ScreenedTable& screened, const WindowSpan& span) {
    const double delay_s = screened.basis.velocity->delay_s.value();
    const double from_s = span.start.seconds() + delay_s;
    const double to_s = from_s + span.duration.seconds();
    Eigen::Vector2d moved = Eigen::Vector2d::Zero();
    const ScreenedEpoch* before = nullptr;
    for (const ScreenedEpoch& row : screened.rows) {
        if (!row.recorded_velocity_east_m_s) continue;
        if (before != nullptr && row.time > before->time) {
            const double a = before->time.seconds(), b = row.time.seconds();
            const double part = std::max(0.0, std::min(b, to_s) - std::max(a, from_s));
            moved += 0.5 * part *
                     Eigen::Vector2d(
                         *row.recorded_velocity_east_m_s + *before->recorded_velocity_east_m_s,
                         *row.recorded_velocity_north_m_s + *before->recorded_velocity_north_m_s);
        }
        before = &row;
    }
    return moved.norm() / span.duration.seconds();
}

struct RaceRun {
    const char* name;
    double one_s_km_h, ten_s_km_h;
};

void PrintTo(const RaceRun& run, std::ostream* out) {
    *out << run.name;
}

class RaceCar : public testing::TestWithParam<RaceRun> {};

TEST_P(RaceCar, IsSlowerOverLongerTimesAndAsFastAsItsRecordedVelocities) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const RaceRun& given = GetParam();
    const Rules rules;
    rules.bring_in(*data / "race_car_vbo" / (std::string(given.name) + ".vbo"));
    std::string profiles;
    for (const int duration_s : {1, 2, 3, 5, 10}) {
        rules.put(
            fmt::format("rule{}.yaml", duration_s),
            profile_of(fmt::format("rule{}", duration_s),
                       fmt::format("{{duration_s: {}, definition: displacement}}", duration_s)));
        profiles += fmt::format("{}rule{}.yaml", duration_s > 1 ? ", " : "", duration_s);
    }
    const Verdict verdict = rules.judge(fmt::format(
        "schema: attempt/1.0\nid: race\ncraft: {{name: car, class: car}}\n"
        "receivers: [{{id: primary, recording: {}.vbo, accuracy: {{horizontal_m: 0.3, vertical_m: "
        "0.5}}}}]\nprofiles: [{}]\nparameters: {{screen: {{allowed_fixes: [single]}}}}\n",
        given.name, profiles));
    const ScreenedTable screened = screened_of(rules);
    double before_m_s = 1000.0;
    for (const ProfileVerdict& profile : verdict.profiles) {
        SCOPED_TRACE(profile.profile);
        EXPECT_LT(*profile.speed_m_s, before_m_s);
        before_m_s = *profile.speed_m_s;
        EXPECT_NEAR(recorded_speed_over(screened, *profile.window), *profile.speed_m_s,
                    *profile.expanded_uncertainty_m_s);
    }
    // The recorded velocities tell what the choice of the window added to the shortest.
    const ProfileVerdict& one_s = verdict.profiles.front();
    EXPECT_LE(*one_s.speed_m_s * 3.6, given.one_s_km_h + 0.2);
    EXPECT_GE(*one_s.speed_m_s, recorded_speed_over(screened, *one_s.window) - 0.2 / 3.6);
    EXPECT_NEAR(*verdict.profiles.back().speed_m_s * 3.6, given.ten_s_km_h, 0.2);
    EXPECT_TRUE(any_contains(verdict.statements, "The rules do not measure the same: rule1 "));
}

INSTANTIATE_TEST_SUITE_P(Both, RaceCar,
                         testing::Values(RaceRun{"run_a", 251.4, 218.826},
                                         RaceRun{"run_b", 264.9, 240.303}),
                         [](const auto& instance) { return std::string(instance.param.name); });

// A car in a city.

TEST(UrbanCar, IsRefusedForItsHillsUnlessTheLimitIsReplacedAndThatIsPrinted) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const Rules rules;
    rules.bring_in(*data / "ppk_urban_car" / "rover.pos");
    const std::string attempt =
        "schema: attempt/1.0\nid: urban\ncraft: {name: car, class: car}\n"
        "receivers: [{id: primary, recording: rover.pos}]\nprofiles: [nalsa]\n"
        "record: {speed: 30, unit: km/h, source: none}\n"
        "origin: {latitude_deg: 35.134709483, longitude_deg: 136.977574275, height_m: 104.728}\n";
    const ProfileVerdict refused = rules.judge_one(attempt);
    EXPECT_EQ(refused.outcome, Outcome::not_certifiable);
    EXPECT_NEAR(*refused.speed_m_s * 3.6, 44.482, 0.05);
    EXPECT_NEAR(*refused.expanded_uncertainty_m_s * 3.6, 0.20, 0.03);
    for (const char* part : {"Not met: flat-course", " m ± ", "at most 1 m"})
        EXPECT_TRUE(contains(refused.reason, part)) << refused.reason;

    const ProfileVerdict decided = rules.judge_one(
        attempt +
        "rules: [{profile: nalsa, figure: clauses.flat-course.limit, value: 10, reason: a street "
        "is no lake bed}]\n");
    EXPECT_EQ(decided.outcome, Outcome::beaten) << decided.reason;
    EXPECT_EQ(*decided.speed_m_s, *refused.speed_m_s);
    ASSERT_EQ(decided.overrides.size(), 1U);
    EXPECT_EQ(decided.overrides[0].figure, "clauses.flat-course.limit");
    EXPECT_EQ(decided.overrides[0].rule, 1.0);
    EXPECT_EQ(decided.overrides[0].used, 10.0);
    EXPECT_EQ(decided.overrides[0].reason, "a street is no lake bed");
    EXPECT_TRUE(any_contains(decided.notes, "clauses.flat-course.limit is 10 m, not 1 m"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
