#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "chain_support.h"
#include "core/random.h"

// Recordings that noise cannot be estimated from, or not as it should be: the verdict says so.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// One epoch of an engineering CRS at 5 Hz.
struct Epoch {
    double east_m = 0.0;
    double north_m = 0.0;
    double sigma_m = 0.010;
};

/// On a curve at about 20 m/s, with white noise of the stated 10 mm.
std::vector<Epoch> on_a_curve(int epochs) {
    RandomGenerator random(3);
    std::vector<Epoch> recording;
    for (int k = 0; k < epochs; ++k) {
        const double t = 0.2 * k;
        recording.push_back({.east_m = 200.0 * std::sin(t / 10.0) + 0.010 * random.normal(),
                             .north_m = 200.0 * std::cos(t / 10.0) + 0.010 * random.normal(),
                             .sigma_m = 0.010 + 0.0001 * (k % 7)});
    }
    return recording;
}

std::string attempt_for(const std::string& columns) {
    return "schema: attempt/1.0\nid: noise\ncraft: {name: yacht, class: land-yacht}\n"
           "receivers:\n  - {id: primary, recording: recording.csv, format: csv, "
           "frame: local_plane, columns: {" +
           columns +
           "}, solution: fixed}\nrecord: {speed: 50, unit: km/h, source: made up}\nprofiles: "
           "[nalsa]\n";
}

/// What certifying a recording came to.
struct Outcome {
    int exit_status = 0;
    std::string errors;
    std::string statements;
    YamlValue verdict;

    /// Whether a statement of the verdict holds these words.
    bool says(const std::string& words) const {
        return statements.find(words) != std::string::npos;
    }
    YamlValue profile() const { return verdict["profiles"].list().at(0); }
};

Outcome certified(const std::vector<Epoch>& recording,
                  const std::string& columns =
                      "time: time, east: east, north: north, up: null, "
                      "sigma_east: sigma, sigma_north: sigma") {
    const TemporaryFolder folder;
    std::string text = "time,east,north,sigma\n";
    for (std::size_t k = 0; k < recording.size(); ++k)
        text += fmt::format("{:.1f},{:.4f},{:.4f},{:.4f}\n", 0.2 * static_cast<double>(k),
                            recording[k].east_m, recording[k].north_m, recording[k].sigma_m);
    write_file_atomically(folder.path() / "recording.csv", text);
    write_file_atomically(folder.path() / "attempt.yaml", attempt_for(columns));
    const fs::path run = folder.path() / "run";
    const ProcessResult result = certify(folder.path() / "attempt.yaml", run, {"--no-render"});
    Outcome outcome{result.exit_status, result.errors, {}, {YamlNode(), ""}};
    if (!fs::exists(run / "6-verdict.yaml")) return outcome;
    outcome.verdict = read_yaml(run / "6-verdict.yaml");
    for (const YamlValue& statement : outcome.verdict["statements"].list())
        outcome.statements += statement.text() + "\n";
    return outcome;
}

TEST(BadNoise, AGoodRecordingIsLearntFrom) {
    const Outcome good = certified(on_a_curve(200));
    EXPECT_EQ(good.exit_status, 0) << good.errors;
    EXPECT_EQ(good.profile()["outcome"].text(), "beaten");
    EXPECT_TRUE(good.says("The horizontal noise was estimated from 200 epochs")) << good.statements;
    for (const char* amiss : {"could not be estimated", "equal at all epochs", "stay correlated"})
        EXPECT_FALSE(good.says(amiss)) << good.statements;
}

TEST(BadNoise, ARecordingTooShortToFitSaysHowManyEpochsAreNeeded) {
    const Outcome outcome = certified(on_a_curve(25));
    EXPECT_LE(outcome.exit_status, 1) << outcome.errors;
    EXPECT_TRUE(outcome.says("has 25 usable epochs where 33 are required")) << outcome.statements;
    EXPECT_TRUE(outcome.says("a jerk density of")) << outcome.statements;
}

TEST(BadNoise, ConstantPositions) {
    std::vector<Epoch> recording = on_a_curve(200);
    for (Epoch& epoch : recording)
        epoch.east_m = epoch.north_m = 7.0;
    const Outcome outcome = certified(recording);
    EXPECT_EQ(outcome.exit_status, 1) << outcome.errors;
    EXPECT_TRUE(outcome.says("whose positions are all the same")) << outcome.statements;
    EXPECT_EQ(outcome.profile()["outcome"].text(), "not_beaten");
}

TEST(BadNoise, StatedAccuraciesOfZeroEndBeforeAnythingIsComputed) {
    std::vector<Epoch> recording = on_a_curve(200);
    for (Epoch& epoch : recording)
        epoch.sigma_m = 0.0;
    const Outcome outcome = certified(recording);
    EXPECT_EQ(outcome.exit_status, 2) << outcome.statements;
    for (const char* words : {"states no accuracy of its positions", "accuracy: {horizontal_m: 3"})
        EXPECT_NE(outcome.errors.find(words), std::string::npos) << outcome.errors;
}

TEST(BadNoise, StatedAccuraciesThatAreAllEqual) {
    std::vector<Epoch> recording = on_a_curve(200);
    for (Epoch& epoch : recording)
        epoch.sigma_m = 0.012;
    const Outcome outcome = certified(recording);
    EXPECT_EQ(outcome.exit_status, 0) << outcome.errors;
    EXPECT_TRUE(outcome.says("equal at all epochs (12.0 mm)")) << outcome.statements;
}

TEST(BadNoise, HeightsThatWereNotMeasured) {
    const Outcome outcome = certified(on_a_curve(200));
    EXPECT_TRUE(outcome.says("Heights were not measured")) << outcome.statements;
    EXPECT_FALSE(outcome.says("vertical")) << outcome.statements;
}

TEST(BadNoise, AHorizontalAxisThatIsMissingIsRefused) {
    const Outcome outcome =
        certified(on_a_curve(200), "time: time, east: east, sigma_east: sigma, sigma_north: sigma");
    EXPECT_EQ(outcome.exit_status, 2);
    EXPECT_NE(outcome.errors.find("north"), std::string::npos) << outcome.errors;
    EXPECT_NE(outcome.errors.find("what to do: "), std::string::npos) << outcome.errors;
}

TEST(BadNoise, AFitAtALimitOfItsRange) {
    // Straight on at 20 m/s: no jerk is too small.
    RandomGenerator random(5);
    std::vector<Epoch> recording = on_a_curve(200);
    for (std::size_t k = 0; k < recording.size(); ++k) {
        recording[k].east_m = 4.0 * static_cast<double>(k) + 0.010 * random.normal();
        recording[k].north_m = 0.010 * random.normal();
    }
    const Outcome outcome = certified(recording);
    EXPECT_LE(outcome.exit_status, 1) << outcome.errors;
    EXPECT_TRUE(outcome.says("limit of its range for: jerk density")) << outcome.statements;
}

TEST(BadNoise, PositionsThatTheDeviceExtrapolatedAreSaidToBeFiltered) {
    const std::vector<Epoch> measured = on_a_curve(400);
    std::vector<Epoch> recording;
    for (std::size_t k = 1; k < measured.size(); ++k) {
        recording.push_back(measured[k]);
        recording.back().east_m = 1.8 * measured[k].east_m - 0.8 * measured[k - 1].east_m;
        recording.back().north_m = 1.8 * measured[k].north_m - 0.8 * measured[k - 1].north_m;
    }
    const Outcome outcome = certified(recording);
    EXPECT_LE(outcome.exit_status, 1) << outcome.errors;
    EXPECT_TRUE(outcome.says("look as if the device had filtered them")) << outcome.statements;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
