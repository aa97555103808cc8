#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "chain_support.h"

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Certifies a real recording as a car under nalsa; what comes out is in `run`.
ProcessResult certify_recording(const fs::path& recording, const fs::path& folder,
                                const std::string& more = {}) {
    const std::string attempt = fmt::format(
        "schema: attempt/1.0\nid: recorded\ncraft: {{name: car, class: car}}\n"
        "officials: [{{role: measurer}}]\n"
        "receivers: [{{id: primary, recording: \"{}\"}}]\n"
        "record: {{speed: 202.9, unit: km/h, source: published}}\nprofiles: [nalsa]\n{}",
        bring(recording, folder), more);
    write_file_atomically(folder / "attempt.yaml", attempt);
    return certify(folder / "attempt.yaml", folder / "run", {"--no-render"});
}

TEST(RealRecordings, UrbanCar) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const ProcessResult result = certify_recording(
        *data / "ppk_urban_car" / "rover.pos", folder.path(),
        "origin: {latitude_deg: 35.134709483, longitude_deg: 136.977574275, height_m: 104.728}\n");
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const YamlValue verdict = read_yaml(folder.path() / "run" / "6-verdict.yaml");
    const YamlValue profile = verdict["profiles"].list().at(0);
    // A course through a city is not flat within a metre.
    EXPECT_EQ(profile["outcome"].text(), "not_certifiable");
    EXPECT_TRUE(profile["reason"].text().starts_with("Not met: flat-course"));
    // The reference says 44.473 there.
    EXPECT_NEAR(profile["speed_km_h"].real(), 44.47, 0.05);
    ASSERT_TRUE(profile["indicated"].exists());
    EXPECT_GT(profile["indicated"]["speed_km_h"].real(), 50.0);
    EXPECT_FALSE(profile["indicated"]["refusals"].list().empty());
    const YamlValue windows = read_yaml(folder.path() / "run" / "5-windows.yaml");
    EXPECT_GT(windows["profiles"].list().at(0)["candidates"].integer(), 1000);
}

TEST(RealRecordings, RtkDrive) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const ProcessResult result =
        certify_recording(*data / "rtk_imu_drive" / "rover.pos", folder.path());
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const YamlValue profile =
        read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_NEAR(profile["speed_km_h"].real(), 58.5, 0.2);
    EXPECT_LT(profile["expanded_uncertainty_km_h"].real(), 0.8);
}

TEST(RealRecordings, TokyoEcef) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const ProcessResult result =
        certify_recording(*data / "ppk_tokyo_ecef" / "rover.pos", folder.path());
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const YamlValue profile =
        read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_GT(profile["speed_km_h"].real(), 50.0);
    EXPECT_LT(profile["speed_km_h"].real(), 60.5);
}

TEST(RealRecordings, Walk) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const TemporaryFolder folder;
    const ProcessResult result = certify_recording(*data / "ubx_walk" / "rover.pos", folder.path());
    EXPECT_EQ(result.exit_status, 1) << result.errors;
    const YamlValue profile =
        read_yaml(folder.path() / "run" / "6-verdict.yaml")["profiles"].list().at(0);
    EXPECT_LT(profile["speed_km_h"].real(), 8.0);
}

TEST(RealRecordings, Inspect) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const ProcessResult result =
        runcert({"inspect", (*data / "ppk_urban_car" / "rover.pos").string()});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    for (const char* fact : {"5395", "1799", "3596", "282", "20"})
        EXPECT_NE(result.output.find(fact), std::string::npos) << fact << "\n" << result.output;
}

// One document says what the positions are and what the raw measurements.
TEST(RealRecordings, InspectGivesOneDocument) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const std::string recording = (*data / "ubx_walk" / "rover.ubx").string();
    const ProcessResult result = runcert({"inspect", recording, "--json"});
    EXPECT_EQ(result.exit_status, 0) << result.errors;
    const auto document = nlohmann::json::parse(result.output);
    ASSERT_EQ(document["said"].size(), 3U);
    EXPECT_EQ(document["said"][0]["title"], "Positions");
    EXPECT_EQ(document["said"][2]["title"], "Raw measurements");
    // Every text of it stands on the terminal.
    const std::string said =
        std::regex_replace(runcert({"inspect", recording}).output, std::regex("\\s+"), " ");
    for (const auto& group : document["said"])
        for (const auto& fact : group["facts"])
            EXPECT_NE(
                said.find(fact["name"].get<std::string>() + " " + fact["value"].get<std::string>()),
                std::string::npos)
                << fact << said;
    for (const auto& concern : document["concerns"])
        EXPECT_NE(said.find("- " + concern["says"].get<std::string>()), std::string::npos)
            << concern;
}

// What the positions are is said though the raw measurements cannot be read.
TEST(RealRecordings, InspectSaysWhatItCanBeforeItFails) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    const ProcessResult result =
        runcert({"inspect", (*data / "ubx_walk" / "rover.ubx").string(), "--navigation",
                 (*data / "ppk_urban_car" / "rover.pos").string()});
    EXPECT_EQ(result.exit_status, 2) << result.output;
    EXPECT_NE(result.output.find("Positions\n---------\n"), std::string::npos) << result.output;
    EXPECT_EQ(result.output.find("Raw measurements"), std::string::npos) << result.output;
    EXPECT_NE(result.errors.find("what to do: "), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
