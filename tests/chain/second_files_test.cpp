#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>
#include <sstream>

#include "attestations_support.h"

// A second file may contradict. It narrows nothing and meets nothing before an official has
// answered for it.

namespace runcert::chain {
namespace {

/// The recording with noise added to its positions: what a second receiver never recorded.
std::string with_noise(const std::string& recording, double sigma_m) {
    std::mt19937 generator(5);
    std::normal_distribution<double> noise(0.0, sigma_m);
    constexpr double metres_per_degree = 111'000.0;
    std::istringstream lines(recording);
    std::string made;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        std::string day, time, rest;
        double latitude = 0.0, longitude = 0.0, height = 0.0;
        if (line.starts_with('%') || !(fields >> day >> time >> latitude >> longitude >> height)) {
            made += line + "\n";
            continue;
        }
        std::getline(fields, rest);
        made += fmt::format("{} {} {:.9f} {:.9f} {:.4f} {}\n", day, time,
                            latitude + noise(generator) / metres_per_degree,
                            longitude + noise(generator) / metres_per_degree,
                            height + noise(generator), rest);
    }
    return made;
}

/// The salt lake's run by two receivers, of which the second is the first one and noise.
class SecondFiles : public Attestations {
  protected:
    void SetUp() override {
        const fs::path lake = examples / "salt_lake";
        fs::create_directories(folder());
        const std::string recording = read_file(lake / "recording.pos");
        write_file_atomically(folder() / "recording.pos", recording);
        write_file_atomically(folder() / "second.pos", with_noise(recording, 0.01));
        std::string attempt = read_file(lake / "attempt.yaml");
        attempt.insert(attempt.find("origin:"),
                       "  - {id: second, recording: second.pos, format: rtklib-pos}\n");
        attempt.erase(attempt.find("  - fisly"), 10);
        write_file_atomically(folder() / "attempt.yaml", attempt);
        const ProcessResult made =
            certify(folder() / "attempt.yaml", run(), {"--no-render", "--key", key("measurer")});
        ASSERT_NE(made.exit_status, 2) << made.errors;
    }
    fs::path folder() const { return run().parent_path() / "second_files"; }
    static double u_km_h(const nlohmann::json& profile) {
        return profile["expanded_uncertainty_km_h"].get<double>();
    }
    static std::string status(const nlohmann::json& profile, const std::string& clause) {
        for (const auto& one : profile["requirements"])
            if (one["clause"] == clause) return one["status"];
        return "not asked";
    }
};

TEST_F(SecondFiles, AReceiverMadeOfTheFirstNarrowsNothingAndMeetsNothing) {
    const nlohmann::json all = report();
    const nlohmann::json& before = all["verdict"]["profiles"][0];
    const nlohmann::json& after = all["verdict"]["with_files"][0];
    EXPECT_GT(u_km_h(before), 1.2 * u_km_h(after));
    EXPECT_EQ(status(before, "secondary-method"), "attest");
    EXPECT_EQ(status(after, "secondary-method"), "met");
    EXPECT_EQ(status(before, "secondary-as-recorded"), "attest");
    EXPECT_EQ(all["verdict"]["second_files"], nlohmann::json({"secondary-as-recorded"}));
    // The uncertainty is that of the same run without the file, and so are the witnesses.
    EXPECT_TRUE(before["witnesses"].empty());
    EXPECT_TRUE(before.contains("unseen_drift_m_s"));
    std::string attempt = read_file(folder() / "attempt.yaml");
    attempt.erase(attempt.find("  - {id: second"),
                  attempt.find("origin:") - attempt.find("  - {id: second"));
    write_file_atomically(folder() / "alone.yaml", attempt);
    (void)certify(folder() / "alone.yaml", folder() / "alone", {"--no-render"});
    const auto alone =
        nlohmann::json::parse(read_file(folder() / "alone" / "report.json"))["predicate"];
    EXPECT_FALSE(alone.contains("with_files"));
    EXPECT_NEAR(u_km_h(before), u_km_h(alone["verdict"]["profiles"][0]), 0.01);
}

TEST_F(SecondFiles, TheyCountOnceAnOfficialOfTheRosterHasAnswered) {
    const auto found_with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"explain", run().string()});
        return runcert(more).output;
    };
    const std::string before = found_with({"--roster", roster()});
    EXPECT_NE(before.find("can only contradict"), std::string::npos) << before;
    must_attest("measurer", "measurer", {"secondary-as-recorded"});
    const std::string after = found_with({"--roster", roster()});
    EXPECT_NE(after.find("have answered for the second files"), std::string::npos) << after;
    EXPECT_NE(found_with({}).find("can only contradict"), std::string::npos)
        << "nobody vouches for that key";
    const auto all = found();
    EXPECT_FALSE(says(layer(all, "attestations"), "nalsa/secondary-method")) << all.dump(1);
}

TEST_F(SecondFiles, ANoLeavesThemOut) {
    must_attest("measurer", "measurer", {"secondary-as-recorded"}, {"--no"});
    const std::string said = runcert({"explain", run().string(), "--roster", roster()}).output;
    EXPECT_NE(said.find("can only contradict"), std::string::npos) << said;
}

TEST_F(SecondFiles, ThePagesFollow) {
    must_attest("measurer", "measurer", {"secondary-as-recorded"});
    const ProcessResult made =
        runcert({"attest", run().string(), "--render", "--roster", roster()});
    ASSERT_EQ(made.exit_status, 0) << made.errors;
    const auto all = report();
    const std::string page = read_file(run() / "report.html");
    const std::string shown =
        page.substr(page.find("<main"), page.find("</main>") - page.find("<main"));
    const auto u_of = [](const nlohmann::json& profile) {
        return profile["shown"]["speed"].get<std::string>() + " km/h ± " +
               profile["shown"]["expanded_uncertainty"].get<std::string>();
    };
    EXPECT_NE(shown.find(u_of(all["verdict"]["with_files"][0])), std::string::npos);
    EXPECT_NE(shown.find("Without them: " + u_of(all["verdict"]["profiles"][0])),
              std::string::npos);
    EXPECT_EQ(layer(found(), "pages")["passed"], true) << layer(found(), "pages").dump(1);
}

}  // namespace
}  // namespace runcert::chain
