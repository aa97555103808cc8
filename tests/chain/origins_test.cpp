#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rules_support.h"

// What a claimant types or hands in, as if somebody had observed it. Each of these was certified,
// or met a requirement, before inputs had an origin.

namespace runcert::chain::RUNCERT_FILE {
namespace {

struct Sample {
    double time_s = 0.0;
    double east_m = 0.0, north_m = 0.0;
    double speed_m_s = 0.0;  ///< recorded, towards north
    double true_m = 0.0;     ///< the way there without errors
};
using Samples = std::vector<Sample>;

/// A run northwards up to 60 m/s, standing before it; positions with white and lasting errors,
/// speeds measured on their own.
Samples sailed(std::uint64_t seed = 1) {
    RandomGenerator random(seed);
    Samples samples;
    double way_m = 0.0, lasting_east_m = 0.0, lasting_north_m = 0.0;
    for (int k = 0; k <= 1200; ++k) {
        const double t = 0.1 * k;
        const double speed_m_s = 60.0 / (1.0 + std::exp(-(t - 60.0) / 6.0));
        way_m = 360.0 * std::log1p(std::exp((t - 60.0) / 6.0));
        lasting_east_m += -0.05 * lasting_east_m + 0.0015 * random.normal();
        lasting_north_m += -0.05 * lasting_north_m + 0.0015 * random.normal();
        samples.push_back({.time_s = t,
                           .east_m = lasting_east_m + 0.004 * random.normal(),
                           .north_m = way_m + lasting_north_m + 0.004 * random.normal(),
                           .speed_m_s = speed_m_s + 0.03 * random.normal(),
                           .true_m = way_m});
    }
    return samples;
}

std::string table(const Samples& samples) {
    std::string text = "time_s,east_m,north_m,velocity_east,velocity_north\n";
    for (const Sample& one : samples)
        text += fmt::format("{:.2f},{:.4f},{:.4f},0.0000,{:.4f}\n", one.time_s, one.east_m,
                            one.north_m, one.speed_m_s);
    return text;
}

std::string receiver(const std::string& id, const std::string& file, bool velocities,
                     const std::string& accuracy = "horizontal_m: 0.01, velocity_mps: 0.05") {
    return fmt::format(
        "{{id: {}, recording: {}, format: csv, columns: {{time: time_s, east: east_m, north: "
        "north_m, up: null{}}}, frame: local_plane, start_gps: \"2026-03-14T03:20:18.000\", "
        "solution: fixed, accuracy: {{{}}}}}",
        id, file,
        velocities ? ", velocity_east: velocity_east, velocity_north: velocity_north" : "",
        accuracy);
}

class Origins : public testing::Test {
  protected:
    void write(const std::string& name, const std::string& text) const {
        write_file_atomically(folder_.path() / name, text);
    }

    /// Certifies what was written, and keeps the verdict of its one rule.
    void judge(const std::string& receivers, const std::string& more = {},
               const std::string& profile = "nalsa") {
        write(
            "attempt.yaml",
            fmt::format("schema: attempt/1.0\nid: run\ncraft: {{name: yacht, class: land-yacht}}\n"
                        "receivers: [{}]\nprofiles: [{}]\n"
                        "record: {{speed: 200, unit: km/h, source: a newspaper}}\n{}",
                        receivers, profile, more));
        const fs::path run = folder_.path() / "run";
        fs::remove_all(run);
        result_ = certify(folder_.path() / "attempt.yaml", run, {"--no-render"});
        ASSERT_NE(result_.exit_status, 2) << result_.errors;
        verdict_ = read_yaml(run / "6-verdict.yaml");
        windows_ = read_yaml(run / "5-windows.yaml");
    }
    void judge_alone(const Samples& samples, bool velocities = false,
                     const std::string& more = {}) {
        write("one.csv", table(samples));
        judge(receiver("one", "one.csv", velocities), more);
    }

    YamlValue profile() const { return verdict_["profiles"].list().front(); }
    std::string outcome() const { return profile()["outcome"].text(); }
    std::string reason() const { return profile()["reason"].text(); }
    double expanded_uncertainty_km_h() const {
        return profile()["expanded_uncertainty_km_h"].real();
    }
    YamlValue requirement(const std::string& clause) const {
        for (const YamlValue& one : profile()["requirements"].list())
            if (one["clause"].text() == clause) return one;
        ADD_FAILURE() << "no clause " << clause;
        return profile();
    }
    std::string status(const std::string& clause) const {
        return requirement(clause)["status"].text();
    }
    bool evidence_has(const std::string& clause, const std::string& part) const {
        return requirement(clause)["evidence"].text().find(part) != std::string::npos;
    }
    bool says(const std::string& part) const {
        const std::string text = read_file(folder_.path() / "run" / "6-verdict.yaml") +
                                 read_file(folder_.path() / "run" / "5-windows.yaml");
        return text.find(part) != std::string::npos;
    }
    std::size_t witnesses() const {
        return windows_["profiles"].list().front()["best"]["witnesses"].list().size();
    }

    TemporaryFolder folder_;
    ProcessResult result_;
    YamlValue verdict_{YamlNode(), ""};
    YamlValue windows_{YamlNode(), ""};
};

Samples with_speeds(Samples samples, const std::function<double(const Sample&)>& speed) {
    for (Sample& one : samples)
        one.speed_m_s = speed(one);
    return samples;
}

/// Speeds as a mean of central differences of the positions over so many rows on either side.
Samples speeds_from_positions(Samples samples, std::size_t either_side) {
    const Samples from = samples;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t a = k > either_side ? k - either_side : 0;
        const std::size_t b = std::min(samples.size() - 1, k + either_side);
        samples[k].speed_m_s =
            std::max(0.0, (from[b].north_m - from[a].north_m) / (from[b].time_s - from[a].time_s));
    }
    return samples;
}

TEST_F(Origins, ARecordThatIsTypedIsToBeAttestedWithItsSource) {
    judge_alone(sailed());
    EXPECT_EQ(status("margin"), "attest");
    EXPECT_TRUE(evidence_has("margin",
                             "record.speed: 200; record.unit: km/h; "
                             "record.source: “a newspaper”"));
    EXPECT_EQ(status("craft-and-attempts"), "attest");
    EXPECT_TRUE(evidence_has("craft-and-attempts", "attempts_made: 1"));
    EXPECT_EQ(status("accuracy"), "attest");
    EXPECT_TRUE(evidence_has("accuracy", "receivers.one.accuracy.horizontal_m: 0.01 m"));
    EXPECT_EQ(status("kind-of-solution"), "attest");
    EXPECT_EQ(status("recording-as-read"), "attest");
}

TEST_F(Origins, ASecondMethodThatCouldNotHaveFailedConfirmsNothing) {
    const auto typed = [](double uncertainty) {
        return fmt::format(
            "secondary: {{method: radar, source: a note, speed: 215, unit: km/h, "
            "expanded_uncertainty: {}}}\n",
            uncertainty);
    };
    for (const double uncertainty : {100000.0, 1000.0, 100.0, 20.0, 10.0}) {
        SCOPED_TRACE(uncertainty);
        judge_alone(sailed(), false, typed(uncertainty));
        EXPECT_EQ(status("secondary-method"), "attest");
        EXPECT_TRUE(evidence_has("secondary-method", "too uncertain to confirm"));
        EXPECT_TRUE(reason().starts_with("By positions alone")) << reason();
        EXPECT_TRUE(profile()["witnesses"].list().empty());
    }
    // One that could have failed is shown, and still somebody's word.
    judge_alone(sailed(), false, typed(3.0));
    EXPECT_EQ(status("secondary-method"), "attest");
    EXPECT_FALSE(evidence_has("secondary-method", "too uncertain to confirm"));
    EXPECT_TRUE(evidence_has("secondary-method", "secondary.expanded_uncertainty: 3"));
    EXPECT_TRUE(reason().starts_with("By positions alone")) << reason();
}

TEST_F(Origins, ASecondMethodThatContradictsIsHeard) {
    judge_alone(sailed(), false,
                "secondary: {method: radar, source: a note, speed: 190, unit: km/h, "
                "expanded_uncertainty: 3}\n");
    EXPECT_EQ(outcome(), "not_certifiable");
}

TEST_F(Origins, VelocitiesMeasuredBesideThePositionsAreHeard) {
    judge_alone(sailed(), true);
    EXPECT_EQ(outcome(), "beaten") << reason();
    EXPECT_EQ(witnesses(), 1U);
    EXPECT_FALSE(reason().starts_with("By positions alone")) << reason();
}

TEST_F(Origins, VelocitiesOfAnotherSpeedThanThePositionsShowAreRefused) {
    write("speeds.yaml",
          profile_of("speeds", "{duration_s: 3, definition: mean_n, source: velocity}"));
    for (const double factor : {1.5, 1.05, 0.9, 2.0, 1.03}) {
        SCOPED_TRACE(factor);
        write("one.csv", table(with_speeds(
                             sailed(), [&](const Sample& one) { return factor * one.speed_m_s; })));
        for (const char* rule : {"speeds.yaml", "nalsa"}) {
            SCOPED_TRACE(rule);
            judge(receiver("one", "one.csv", true), {}, rule);
            EXPECT_EQ(outcome(), "not_certifiable");
            EXPECT_NE(reason().find("times what the positions show"), std::string::npos)
                << reason();
        }
    }
    // Higher near the end alone, where the window is.
    write("one.csv", table(with_speeds(sailed(), [](const Sample& one) {
              return one.time_s > 110.0 ? one.speed_m_s + 3.0 : one.speed_m_s;
          })));
    judge(receiver("one", "one.csv", true), {}, "speeds.yaml");
    EXPECT_FALSE(outcome() == "beaten" && profile()["speed_m_s"].real() > 61.0) << reason();
    // The control: as measured.
    write("one.csv", table(sailed()));
    judge(receiver("one", "one.csv", true), {}, "speeds.yaml");
    EXPECT_EQ(outcome(), "beaten") << reason();
}

TEST_F(Origins, AClaimedAccuracyOfVelocitiesNeverSharpensBeyondTheirScatter) {
    write("speeds.yaml",
          profile_of("speeds", "{duration_s: 3, definition: mean_n, source: velocity}"));
    RandomGenerator random(5);
    write("one.csv", table(with_speeds(sailed(), [&](const Sample& one) {
              return one.speed_m_s + 0.4 * random.normal();
          })));
    judge(receiver("one", "one.csv", true, "horizontal_m: 0.01, velocity_mps: 0.001"), {},
          "speeds.yaml");
    if (outcome() != "not_certifiable") {
        EXPECT_GT(expanded_uncertainty_km_h(), 2.0 * 0.2 * 3.6);
    }
}

TEST_F(Origins, ATypedSmallerAccuracyOfVelocitiesCertifiesNothingTighter) {
    write("speeds.yaml",
          profile_of("speeds", "{duration_s: 3, definition: mean_n, source: velocity}"));
    RandomGenerator random(7);
    write("one.csv", table(with_speeds(sailed(), [&](const Sample& one) {
              return one.speed_m_s + 0.1 * random.normal();
          })));
    double before_km_h = 100.0;
    for (const double typed_m_s : {0.001, 0.05, 0.15, 0.5, 5.0}) {
        SCOPED_TRACE(typed_m_s);
        judge(receiver("one", "one.csv", true,
                       fmt::format("horizontal_m: 0.01, velocity_mps: {}", typed_m_s)),
              {}, "speeds.yaml");
        ASSERT_EQ(outcome(), "beaten") << reason();
        // White noise below what is typed averages; 0.05 m/s that last stay.
        EXPECT_LE(expanded_uncertainty_km_h(), before_km_h);
        EXPECT_GT(expanded_uncertainty_km_h(), 3.6 * (typed_m_s < 0.1 ? 0.2 : 0.1));
        before_km_h = expanded_uncertainty_km_h();
    }
    EXPECT_LT(before_km_h, 3.6 * 0.2);
}

TEST_F(Origins, VelocitiesRaisedAtTheWindowAloneAreRefusedOrWithinTheirUncertainty) {
    write("speeds.yaml",
          profile_of("speeds", "{duration_s: 3, definition: mean_n, source: velocity}"));
    for (const double raised_m_s : {0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0})
        for (const double typed_m_s : {0.001, 0.05, 0.5}) {
            SCOPED_TRACE(fmt::format("{} {}", raised_m_s, typed_m_s));
            write("one.csv", table(with_speeds(sailed(), [&](const Sample& one) {
                      return one.speed_m_s + (one.time_s > 112.0 ? raised_m_s : 0.0);
                  })));
            judge(receiver("one", "one.csv", true,
                           fmt::format("horizontal_m: 0.01, velocity_mps: {}", typed_m_s)),
                  {}, "speeds.yaml");
            if (outcome() == "not_certifiable") continue;
            EXPECT_LT(profile()["speed_m_s"].real(), 60.0 + expanded_uncertainty_km_h() / 3.6);
        }
}

TEST_F(Origins, VelocitiesMadeFromThePositionsConfirmNothing) {
    for (const std::size_t either_side : {1U, 3U, 10U, 30U}) {
        SCOPED_TRACE(either_side);
        judge_alone(speeds_from_positions(sailed(), either_side), true);
        EXPECT_EQ(witnesses(), 0U);
        EXPECT_TRUE(says("The recorded velocities were computed from the positions"));
        EXPECT_TRUE(reason().starts_with("By positions alone") || outcome() == "not_certifiable")
            << reason();
    }
}

// A drift for most of the recording makes velocities look wrong, which are right: 60.3 m/s for 60
// were certified beside them.
TEST_F(Origins, ADriftAllOverTheRecordingIsNotTakenForAnErrorOfTheVelocities) {
    judge_alone(sailed(), true);
    EXPECT_EQ(outcome(), "beaten");
    EXPECT_FALSE(says("which the errors of neither explain"));
    for (const double drift_m_s : {0.15, 0.3, 1.0}) {
        Samples drifting = sailed();
        for (Sample& one : drifting)
            one.north_m += drift_m_s * std::max(0.0, one.time_s - 20.0);
        judge_alone(drifting, true);
        EXPECT_TRUE(outcome() == "not_certifiable" ||
                    expanded_uncertainty_km_h() > 3.6 * drift_m_s - 0.05)
            << drift_m_s << " " << outcome() << " " << expanded_uncertainty_km_h();
        EXPECT_TRUE(says("which the errors of neither explain")) << drift_m_s;
    }
}

TEST_F(Origins, ACopyIsNoSecondReceiver) {
    const Samples first = sailed();
    const auto judge_with = [&](const Samples& second) {
        write("one.csv", table(first));
        write("two.csv", table(second));
        judge(receiver("one", "one.csv", false) + ", " + receiver("two", "two.csv", false));
    };
    const auto changed = [&](const std::function<void(Sample&)>& change) {
        Samples copy = first;
        for (Sample& one : copy)
            change(one);
        return copy;
    };
    Samples between;
    for (std::size_t k = 1; k < first.size(); ++k) {
        between.push_back(first[k]);
        between.back().time_s -= 0.05;
        between.back().east_m = 0.5 * (first[k - 1].east_m + first[k].east_m);
        between.back().north_m = 0.5 * (first[k - 1].north_m + first[k].north_m);
    }
    for (const Samples& copy :
         {first, changed([](Sample& one) { one.east_m += 0.6; }),
          changed([](Sample& one) { one.east_m += 0.3 + 0.05 * std::sin(0.3 * one.time_s); }),
          changed([](Sample& one) { one.north_m = std::round(one.north_m * 500.0) / 500.0; }),
          between}) {
        judge_with(copy);
        EXPECT_NE(status("secondary-method"), "met");
        EXPECT_EQ(witnesses(), 0U);
        EXPECT_TRUE(says("one recording was made from the other"));
    }
    // Another receiver, measured.
    Samples measured = sailed(2);
    for (Sample& one : measured)
        one.east_m += 0.6;
    judge_with(measured);
    EXPECT_EQ(status("secondary-method"), "attest") << "nobody has answered for its file";
    EXPECT_EQ(witnesses(), 1U);
    for (const YamlValue& one : verdict_["with_files"].list().front()["requirements"].list())
        if (one["clause"].text() == "secondary-method") {
            EXPECT_EQ(one["status"].text(), "met");
        }
}

/// Passages of so many gates from a time on, on the positions or the truth.
std::string gates(const Samples& samples, bool from_positions, double from_s = 95.0,
                  double apart_m = 180.0, int most = 6) {
    std::string text = "time_gps,distance_m\n";
    double distance_m = -1.0, first_m = 0.0;
    int count = 0;
    for (std::size_t k = 1; k < samples.size() && count < most; ++k) {
        if (samples[k].time_s < from_s) continue;
        const double at_m = from_positions ? samples[k].north_m : samples[k].true_m;
        if (distance_m < 0.0) first_m = at_m;
        if (distance_m >= 0.0 && at_m - first_m < distance_m + apart_m) continue;
        distance_m = at_m - first_m;
        ++count;
        text += fmt::format("2026-03-14T03:{:02}:{:07.4f},{:.4f}\n",
                            20 + static_cast<int>(18.0 + samples[k].time_s) / 60,
                            std::fmod(18.0 + samples[k].time_s, 60.0), distance_m);
    }
    return text;
}

TEST_F(Origins, GatesMadeFromThePositionsAreNotHeard) {
    const std::string stated =
        "gates: {file: gates.csv, source: a survey, expanded_uncertainty_m: 0.02, "
        "expanded_uncertainty_s: 0.0002}\n";
    write("gates.csv", gates(sailed(), true));
    judge_alone(sailed(), false, stated);
    EXPECT_TRUE(says("The gates agree with the positions better than"));
    EXPECT_EQ(witnesses(), 0U);
    write("gates.csv", gates(sailed(), false));
    judge_alone(sailed(), false, stated);
    EXPECT_FALSE(says("The gates agree with the positions better than"));
    // Heard or not, an official answers for them.
    EXPECT_EQ(status("gates-as-measured"), "attest");
    EXPECT_TRUE(reason().starts_with("By positions alone")) << reason();
}

TEST_F(Origins, AWheelMadeFromThePositionsIsNotHeard) {
    const auto wheel = [](const Samples& samples, double scale) {
        std::string text = "time_s,speed_m_s\n";
        for (const Sample& one : samples)
            text +=
                fmt::format("{:.2f},{:.5f}\n", one.time_s, std::max(0.0, scale * one.speed_m_s));
        return text;
    };
    const std::string stated = "wheel: {file: wheel.csv, source: a sensor}\n";
    for (const std::size_t either_side : {1U, 2U, 10U}) {
        SCOPED_TRACE(either_side);
        write("wheel.csv", wheel(speeds_from_positions(sailed(), either_side), 1.02));
        judge_alone(sailed(), false, stated);
        EXPECT_TRUE(says("The wheel's speeds keep to the positions"));
        EXPECT_EQ(witnesses(), 0U);
    }
    write("wheel.csv", wheel(sailed(), 1.02));
    judge_alone(sailed(), false, stated);
    EXPECT_EQ(witnesses(), 1U);
    EXPECT_EQ(status("wheel-as-measured"), "attest");
}

/// Speeds of a radar gun, ten a second while the craft is fast; each uncertain by 0.2 m/s.
std::string radar(const Samples& samples, double wrong_m_s = 0.0) {
    std::string text = "time_s,speed_m_s,expanded_uncertainty_m_s,length_m\n";
    for (const Sample& one : samples)
        if (one.time_s >= 90.0 && one.time_s < 120.0)
            text += fmt::format("{:.2f},{:.4f},0.2,0\n", one.time_s, one.speed_m_s + wrong_m_s);
    return text;
}

TEST_F(Origins, ARadarGunIsHeardAndAnsweredForWhereItIsNoCopy) {
    const std::string stated = "speed_trap: {file: radar.csv, source: behind the finish}\n";
    judge_alone(sailed());
    const double alone_km_h = expanded_uncertainty_km_h();
    for (const std::size_t either_side : {1U, 3U, 8U}) {
        write("radar.csv", radar(speeds_from_positions(sailed(), either_side)));
        judge_alone(sailed(), false, stated);
        EXPECT_TRUE(says("The speeds of the radar gun or speed trap keep to the positions"))
            << either_side;
        EXPECT_EQ(witnesses(), 0U);
        EXPECT_NEAR(expanded_uncertainty_km_h(), alone_km_h, 0.01);
    }
    write("radar.csv", radar(sailed()));
    judge_alone(sailed(), false, stated);
    EXPECT_EQ(witnesses(), 1U);
    EXPECT_LE(expanded_uncertainty_km_h(), alone_km_h + 0.005);
    EXPECT_EQ(status("speed-trap-as-measured"), "attest");
    EXPECT_TRUE(reason().starts_with("By positions alone"))
        << "an official hands it in: " << reason();
    // A gun that shows 5 m/s more contradicts the positions, and nothing is certified.
    write("radar.csv", radar(sailed(), 5.0));
    judge_alone(sailed(), false, stated);
    EXPECT_EQ(outcome(), "not_certifiable");
}

/// Speeds as a wheel gives them that rolls 2 % further than it says, each `every`-th sample a mean
/// over so many on either side.
std::string wheel_of_speeds(const Samples& samples, std::size_t either_side, std::size_t every) {
    std::string text = "time_s,speed_m_s\n";
    for (std::size_t k = either_side; k + either_side < samples.size(); k += every) {
        double sum = 0.0;
        for (std::size_t i = k - either_side; i <= k + either_side; ++i)
            sum += samples[i].speed_m_s;
        text +=
            fmt::format("{:.2f},{:.5f}\n", samples[k].time_s,
                        std::max(0.0, sum / (2.0 * static_cast<double>(either_side) + 1.0) / 1.02));
    }
    return text;
}

TEST_F(Origins, WhatWasMadeFromAnotherWitnessIsHeardOnce) {
    const std::string wheel =
        "wheel: {file: wheel.csv, source: a sensor, scale: 1.02, "
        "expanded_uncertainty_scale: 0.0002}\n";
    const Samples first = sailed();
    judge_alone(first, true);
    const double once_km_h = expanded_uncertainty_km_h();
    for (const auto& [either_side, every] :
         {std::pair(0U, 1U), {2U, 1U}, {8U, 1U}, {0U, 2U}, {3U, 5U}}) {
        SCOPED_TRACE(fmt::format("{} {}", either_side, every));
        write("wheel.csv", wheel_of_speeds(first, either_side, every));
        judge_alone(first, true, wheel);
        EXPECT_TRUE(says("The wheel's speeds have the errors of the recorded velocities"));
        EXPECT_EQ(witnesses(), 1U);
        EXPECT_EQ(expanded_uncertainty_km_h(), once_km_h);
    }
    // Another receiver's positions, made into speeds and gates.
    const Samples second = sailed(2);
    write("one.csv", table(first));
    write("two.csv", table(second));
    const std::string two =
        receiver("one", "one.csv", false) + ", " + receiver("two", "two.csv", false);
    write("wheel.csv", wheel_of_speeds(speeds_from_positions(second, 3), 0, 1));
    judge(two, wheel);
    EXPECT_TRUE(says("The wheel's speeds have the errors of receiver"));
    EXPECT_EQ(witnesses(), 1U);
    write("gates.csv", gates(second, true));
    judge(two,
          "gates: {file: gates.csv, source: a survey, expanded_uncertainty_m: 0.02, "
          "expanded_uncertainty_s: 0.0002}\n");
    EXPECT_TRUE(says("The passages of the gates have the errors of receiver"));
    EXPECT_EQ(witnesses(), 1U);
    // What was measured on its own is heard beside them.
    write("wheel.csv", wheel_of_speeds(second, 0, 1));
    judge(two, wheel);
    EXPECT_EQ(witnesses(), 2U);
    judge_alone(first, true, wheel);
    EXPECT_EQ(witnesses(), 2U);
    EXPECT_LE(expanded_uncertainty_km_h(), once_km_h);
}

/// Three runs northwards, southwards and northwards, the last the fastest; some minutes apart.
Samples three_runs(double wrong_share, std::uint64_t seed = 3) {
    RandomGenerator random(seed);
    Samples samples;
    double way_m = 0.0, wrong_m = 0.0;
    for (int k = 0; k <= 4200; ++k) {
        const double t = 0.1 * k;
        const auto pulse = [&](double from_s, double top_m_s) {
            const double since_s = t - from_s;
            const double share = std::clamp(std::min(since_s, 50.0 - since_s) / 20.0, 0.0, 1.0);
            return top_m_s * share * share * (3.0 - 2.0 * share);
        };
        const double speed_m_s = pulse(20.0, 57.0) - pulse(170.0, 57.0) + pulse(330.0, 60.0);
        way_m += 0.1 * speed_m_s;
        if (t > 320.0) wrong_m += 0.1 * wrong_share * speed_m_s;
        samples.push_back({.time_s = t,
                           .east_m = 0.004 * random.normal(),
                           .north_m = way_m + wrong_m + 0.004 * random.normal(),
                           .speed_m_s = std::abs(speed_m_s + 0.02 * random.normal()),
                           .true_m = way_m});
    }
    return samples;
}

/// Speeds of a wheel that rolls 2 % further than it says.
std::string wheel_of(const Samples& samples) {
    std::string text = "time_s,speed_m_s\n";
    for (const Sample& one : samples)
        text += fmt::format("{:.2f},{:.5f}\n", one.time_s, std::max(0.0, one.speed_m_s / 1.02));
    return text;
}

/// The true speed (m/s) over the certified window.
double true_speed(const YamlValue& best, const Samples& samples) {
    const auto at = [&](const char* name) {
        return samples[static_cast<std::size_t>(best[name].integer() - 1)];
    };
    const Sample first = at("first_epoch"), last = at("last_epoch");
    return (last.true_m - first.true_m) / (last.time_s - first.time_s);
}

TEST_F(Origins, AWheelThatIsFittedToTheRunThatItWitnessesHasNoShare) {
    // 0.5 % of the speed, 0.3 m/s: the fitted scale takes it in.
    Samples drifting = sailed();
    for (Sample& one : drifting)
        one.north_m += 0.005 * one.true_m;
    judge_alone(drifting);
    const double alone_km_h = expanded_uncertainty_km_h();
    write("wheel.csv", wheel_of(drifting));
    const std::string stated = "wheel: {file: wheel.csv, source: a sensor}\n";
    judge_alone(drifting, false, stated);
    EXPECT_EQ(witnesses(), 1U);
    EXPECT_TRUE(says("confirm nothing of the window"));
    EXPECT_NEAR(expanded_uncertainty_km_h(), alone_km_h, 0.01 * alone_km_h);
    EXPECT_TRUE(reason().starts_with("By positions alone")) << reason();
    // One whose scale was calibrated shows it.
    judge_alone(drifting, false,
                "wheel: {file: wheel.csv, source: a sensor, scale: 1.02, "
                "expanded_uncertainty_scale: 0.001}\n");
    EXPECT_NE(outcome(), "beaten") << reason();
    EXPECT_NE(reason().find("one of the two is wrong"), std::string::npos) << reason();
    EXPECT_FALSE(says("confirm nothing of the window"));
}

TEST_F(Origins, AWheelOfOtherRunsShowsADriftInTheWindowsRun) {
    const std::string stated = "wheel: {file: wheel.csv, source: a sensor}\n";
    for (const double wrong_share : {0.0, 0.005, -0.005}) {
        SCOPED_TRACE(wrong_share);
        const Samples samples = three_runs(wrong_share);
        write("wheel.csv", wheel_of(samples));
        judge_alone(samples, false, stated);
        EXPECT_FALSE(says("confirm nothing of the window"));
        EXPECT_EQ(witnesses(), 1U);
        if (outcome() == "not_certifiable") continue;
        // Of the run that drifts nothing is certified: it is that of another.
        const YamlValue best = windows_["profiles"].list().front()["best"];
        const double wrong_km_h = 3.6 * (profile()["speed_m_s"].real() - true_speed(best, samples));
        EXPECT_LE(std::abs(wrong_km_h), expanded_uncertainty_km_h());
        EXPECT_EQ(best["start_time_s"].real() > 320.0, wrong_share == 0.0);
    }
}

// Whatever of a witness is fitted to the positions: a drift in the window that the fit could take
// in never makes a speed that is wrong by more than its interval.
TEST_F(Origins, WhatIsFittedOfAWitnessTakesInNoDriftOfTheWindow) {
    const std::string with_gates =
        "gates: {file: gates.csv, source: a survey, expanded_uncertainty_m: 0.02, "
        "expanded_uncertainty_s: 0.0002}\n";
    const auto rate = [](int kind, const Samples& samples, std::size_t k) {
        const double t = samples[k].time_s;
        if (t < 100.0 || k == 0) return 0.0;
        const double speed_m_s = 60.0 / (1.0 + std::exp(-(t - 60.0) / 6.0));
        switch (kind) {
            case 0:  // as a scale does
                return 0.005 * speed_m_s;
            case 1:  // as a delay does, for what is left of the acceleration
                return 10.0 * speed_m_s * (1.0 - speed_m_s / 60.0);
            case 2:  // as a vector that turns would
                return 0.3 * std::sin(0.5 * (t - 100.0));
            default:
                return 0.3;
        }
    };
    const Samples true_to = sailed(), second = sailed(2);
    write("gates.csv", gates(true_to, false, 102.0, 55.0, 19));
    for (const int kind : {0, 1, 2, 3}) {
        Samples drifting = true_to;
        double wrong_m = 0.0;
        for (std::size_t k = 0; k < drifting.size(); ++k) {
            wrong_m += 0.1 * rate(kind, true_to, k);
            drifting[k].north_m += wrong_m;
        }
        for (const std::string witness : {"velocities", "gates", "receiver"}) {
            SCOPED_TRACE(fmt::format("{} {}", witness, kind));
            write("one.csv", table(drifting));
            write("two.csv", table(second));
            std::string receivers = receiver("one", "one.csv", witness == "velocities");
            if (witness == "receiver") receivers += ", " + receiver("two", "two.csv", false);
            judge(receivers, witness == "gates" ? with_gates : "");
            if (outcome() != "beaten") continue;
            EXPECT_EQ(witnesses(), 1U);
            const YamlValue best = windows_["profiles"].list().front()["best"];
            const double wrong_km_h =
                3.6 * (profile()["speed_m_s"].real() - true_speed(best, true_to));
            EXPECT_LE(wrong_km_h, expanded_uncertainty_km_h() + 0.05) << reason();
        }
    }
}

TEST_F(Origins, ASeriesOfTheWindIsToBeAttestedUnderTheClauseThatItMeets) {
    write("windy.yaml", profile_of("windy", "{duration_s: 3, definition: displacement}",
                                   clause_of("wind_mean", ", limit: 10, unit: m/s")));
    write("wind.csv", "time_s,speed_m_s,direction_deg\n0,3,10\n60,4,10\n120,3,12\n");
    write("one.csv", table(sailed()));
    judge(receiver("one", "one.csv", false), "wind: {file: wind.csv, source: a mast}\n",
          "windy.yaml");
    EXPECT_EQ(status("wind_mean"), "attest");
    EXPECT_TRUE(evidence_has("wind_mean", "wind.file: wind.csv (handed in)"));
    write("wind.csv", "time_s,speed_m_s,direction_deg\n0,30,10\n60,40,10\n120,30,12\n");
    judge(receiver("one", "one.csv", false), "wind: {file: wind.csv, source: a mast}\n",
          "windy.yaml");
    EXPECT_EQ(status("wind_mean"), "not_met");
}

TEST_F(Origins, EachInputIsListedWithWhoSaysIt) {
    judge_alone(sailed());
    std::map<std::string, std::string> origin;
    for (const YamlValue& one : verdict_["origins"].list())
        origin[one["name"].text()] = one["origin"].text();
    EXPECT_EQ(origin["receivers.one.recording"], "observed");
    EXPECT_EQ(origin["record.speed"], "claimed");
    const ProcessResult explained = runcert({"explain", (folder_.path() / "run").string()});
    EXPECT_NE(explained.output.find("Claimed"), std::string::npos) << explained.output;
    EXPECT_NE(explained.output.find("record.source: “a newspaper”"), std::string::npos)
        << explained.output;
    const std::string report = read_file(folder_.path() / "run" / "report.json");
    EXPECT_NE(report.find("\"Who says what the figures rest on\""), std::string::npos);
    EXPECT_NE(report.find("record.source: “a newspaper”"), std::string::npos);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
