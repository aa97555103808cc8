#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "chain_support.h"
#include "core/random.h"

// Recordings in which there is nothing to certify: never an invented window, and why, in one
// sentence. And one fault in a good recording: its window refused, the rest certified.

namespace runcert::chain::RUNCERT_FILE {
namespace {

struct Epoch {
    double time_s = 0.0;
    double east_m = 0.0;
    double noise_m = 0.010;
};

struct Outcome {
    int exit_status = 0;
    std::string errors;
    std::string outcome;
    std::string reason;
    YamlValue verdict{YamlNode(), ""};
};

Outcome certified(int epochs, const std::function<Epoch(int)>& epoch,
                  const std::string& stated = "0.010", const std::string& more = "") {
    RandomGenerator random(3);
    std::string text = "time,east,north\n";
    for (int k = 0; k < epochs; ++k) {
        const Epoch one = epoch(k);
        text +=
            fmt::format("{:.1f},{:.4f},{:.4f}\n", one.time_s,
                        one.east_m + one.noise_m * random.normal(), one.noise_m * random.normal());
    }
    const TemporaryFolder folder;
    write_file_atomically(folder.path() / "recording.csv", text);
    write_file_atomically(
        folder.path() / "attempt.yaml",
        fmt::format("schema: attempt/1.0\nid: bad\ncraft: {{name: yacht, class: land-yacht}}\n"
                    "receivers:\n  - {{id: primary, recording: recording.csv, format: csv, "
                    "frame: local_plane, columns: {{time: time, east: east, north: north, up: "
                    "null}}, accuracy: {{horizontal_m: {}}}, solution: fixed}}\n"
                    "record: {{speed: 100, unit: km/h, source: made up}}\nprofiles: [nalsa]\n{}",
                    stated, more));
    const fs::path run = folder.path() / "run";
    const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
    Outcome outcome;
    outcome.exit_status = result.exit_status;
    outcome.errors = result.errors;
    if (!fs::exists(run / "6-verdict.yaml")) return outcome;
    outcome.verdict = read_yaml(run / "6-verdict.yaml");
    const YamlValue profile = outcome.verdict["profiles"].list().at(0);
    outcome.outcome = profile["outcome"].text();
    outcome.reason = profile["reason"].text();
    return outcome;
}

Epoch steady(int k) {
    return {.time_s = 0.1 * k, .east_m = 3.0 * k};
}

TEST(BadScreening, NothingUsable) {
    const Outcome outcome =
        certified(400, steady, "0.010", "parameters: {screen: {allowed_fixes: [float]}}\n");
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    EXPECT_EQ(outcome.outcome, "not_certifiable");
    EXPECT_NE(outcome.reason.find("none of the 400 epochs is usable: 400 fix type not allowed"),
              std::string::npos)
        << outcome.reason;
}

TEST(BadScreening, OneLongGapBetweenTwoShortStretches) {
    const Outcome outcome = certified(40, [](int k) {
        Epoch epoch = steady(k);
        if (k >= 20) {
            epoch.time_s += 500.0;
            epoch.east_m += 15000.0;
        }
        return epoch;
    });
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    EXPECT_EQ(outcome.outcome, "not_certifiable");
    EXPECT_NE(outcome.reason.find("longest arc having 1.9 s"), std::string::npos) << outcome.reason;
}

TEST(BadScreening, TwoEpochs) {
    const Outcome outcome = certified(2, steady);
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    EXPECT_EQ(outcome.outcome, "not_certifiable");
    EXPECT_NE(outcome.reason.find("none of the 2 epochs is usable"), std::string::npos)
        << outcome.reason;
}

TEST(BadScreening, MillimetresStatedWhereTheErrorsAreTenMetres) {
    const Outcome outcome = certified(
        600,
        [](int k) {
            Epoch epoch = steady(k);
            epoch.noise_m = 10.0;
            return epoch;
        },
        "0.001");
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    EXPECT_EQ(outcome.outcome, "not_certifiable");
    EXPECT_NE(outcome.reason.find("limit 0.8 km/h"), std::string::npos) << outcome.reason;
    std::string statements;
    for (const YamlValue& statement : outcome.verdict["statements"].list())
        statements += statement.text() + "\n";
    EXPECT_NE(statements.find("stated for fixed solutions are optimistic"), std::string::npos)
        << statements;
}

TEST(BadScreening, AFaultThatShowsAsThreeTimesTheSpeed) {
    // [DHD22] tell of their vehicle trial that between 40 and 42 s a speed of 27 m/s showed as 75:
    // here positions that run ahead for a second, and come back.
    const Outcome outcome = certified(800, [](int k) {
        Epoch epoch{.time_s = 0.1 * k, .east_m = 2.7 * k};
        if (k >= 400 && k < 420) epoch.east_m += 4.8 * (k < 410 ? k - 399 : 419 - k);
        return epoch;
    });
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    // What it shows would be enough, so that what is left does not say that it was not.
    EXPECT_EQ(outcome.outcome, "not_certifiable");
    EXPECT_EQ(outcome.reason.substr(0, 19), "The recording shows") << outcome.reason;
    const YamlValue profile = outcome.verdict["profiles"].list().at(0);
    EXPECT_NEAR(profile["speed_km_h"].real(), 97.2, 0.1);
    EXPECT_GT(profile["indicated"]["speed_km_h"].real(), 140.0);
    ASSERT_EQ(profile["indicated"]["refusals"].list().size(), 1U);
    EXPECT_NE(profile["indicated"]["refusals"].list()[0].text().find("outliers"),
              std::string::npos);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
