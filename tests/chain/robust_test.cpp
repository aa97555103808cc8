#include <fmt/format.h>
#include <gtest/gtest.h>

#include <numbers>

#include "core/random.h"
#include "simulation/simulate.h"
#include "stages/check/check.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"

// Smoothing, windows and verdict of a run that screening let errors through in.

namespace runcert::RUNCERT_FILE {
namespace {

constexpr const char* attempt_text = R"(schema: attempt/1.0
id: robust
craft: {name: simulated land yacht, class: land-yacht}
receivers: [{id: primary, recording: recording.csv}]
record: {speed: 202.9, unit: km/h, source: published}
profiles: [nalsa]
)";

/// The run of [DHD22], 45 s at 10 Hz with 10 mm of white noise, all epochs usable.
ScreenedTable screened_run() {
    RandomGenerator random(2);
    ScreenedTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.nominal_interval_s = 0.1;
    for (std::int64_t k = 0; k <= 450; ++k) {
        const double along_m =
            logistic_run({}, 0.1 * static_cast<double>(k)).distance_m / std::numbers::sqrt2;
        ScreenedEpoch& row = table.rows.emplace_back();
        row.epoch = k + 1;
        row.time = {k * 100'000'000};
        row.east_m = along_m + 0.010 * random.normal();
        row.north_m = along_m + 0.010 * random.normal();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.fix = FixType::fixed;
        row.usable = true;
        row.arc = 1;
    }
    return table;
}

struct Result {
    CertifiableWindow window;
    ProfileVerdict verdict;
    std::vector<double> weights;
};

Result judged(const ScreenedTable& screened) {
    const Attempt attempt = read_attempt(attempt_text, "attempt");
    const std::vector<Profile> profiles{read_profile(builtin_profile("nalsa"), "nalsa")};
    const TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(attempt));
    ReceiverFindings results;
    results.receiver = "primary";
    results.facts = screened.facts;
    results.accuracy_source = "recording";
    results.screening = summarise(screened.rows);
    results.estimation = trajectory.estimation;
    results.windows = find_windows(screened, trajectory, profiles,
                                   window_config(attempt, attempt.receivers.front()));
    Result result;
    result.window = results.windows.profiles.at(0).best.value();
    result.verdict =
        check({.attempt = attempt, .profiles = profiles, .judged = results}).profiles.at(0);
    for (const TrajectoryEpoch& row : trajectory.rows)
        result.weights.push_back(row.robust_weight.value());
    return result;
}

TEST(Robust, AgreesWhereScreeningMissedNothing) {
    const Result result = judged(screened_run());
    ASSERT_TRUE(result.window.robust.has_value());
    EXPECT_TRUE(result.window.robust->agrees);
    EXPECT_LT(std::abs(result.window.robust->difference_m_s), 0.01);
    EXPECT_EQ(result.verdict.outcome, Outcome::beaten) << result.verdict.reason;
}

TEST(Robust, AnErrorThatScreeningKeptAtAWindowsEndIsNotCertifiable) {
    // 0.3 m ahead over four epochs: the fastest window ends among them, too fast by 0.1 m/s.
    ScreenedTable screened = screened_run();
    for (std::size_t k = 380; k < 384; ++k) {
        *screened.rows[k].east_m += 0.3 / std::numbers::sqrt2;
        *screened.rows[k].north_m += 0.3 / std::numbers::sqrt2;
    }
    const Result result = judged(screened);
    EXPECT_GE(result.window.span.last_epoch, 381);
    EXPECT_LE(result.window.span.last_epoch, 384);
    ASSERT_TRUE(result.window.robust.has_value());
    const RobustSpeed& robust = *result.window.robust;
    fmt::print("robust {:+.4f} m/s, limit {:.4f} m/s, {} epochs downweighted\n",
               robust.difference_m_s, robust.limit_m_s, robust.downweighted);
    EXPECT_LT(robust.difference_m_s, 0.0);
    EXPECT_FALSE(robust.agrees);
    EXPECT_GE(robust.downweighted, 1);
    EXPECT_LT(result.weights[380], 0.5);
    EXPECT_LT(result.weights[381], 0.5);
    EXPECT_EQ(result.verdict.outcome, Outcome::not_certifiable);
    EXPECT_NE(result.verdict.reason.find("robust"), std::string::npos) << result.verdict.reason;
}

}  // namespace
}  // namespace runcert::RUNCERT_FILE
