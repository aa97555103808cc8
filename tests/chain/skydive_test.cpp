#include <algorithm>
#include <cmath>
#include <vector>

#include "core/rounding.h"
#include "core/text.h"
#include "rules_support.h"

// Speed skydives under the rules of 2026: which part of a jump counts, and the scorers' arithmetic.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// A jump at 5 Hz as a FlySight records it. It falls at 100 tanh(t / 10 s) m/s from `top_m` on,
/// 15 m/s faster around `fastest_s` after the exit, until the canopy opens.
struct SimulatedJump {
    double top_m = 4200.0;
    double ground_m = 100.0;
    double fastest_s = 22.0;
    bool lands = true;
    bool dives_before = false;  ///< the aeroplane, faster than the jump will be
    double ends_below_m = -1e9;
    double accuracy_m = 1.5;

    struct Sample {
        std::int64_t tick = 0;  ///< of 0.2 s
        double height_m = 0.0;
        double down_m_s = 0.0;
    };

    std::vector<Sample> samples() const {
        constexpr double opens_m = 1200.0;
        constexpr int steps = 20;  // of 0.01 s, between two samples
        std::vector<Sample> all;
        double height_m = top_m;
        double stood_s = 0.0;
        double down_m_s = 0.0;
        for (std::int64_t tick = 0; stood_s < 30.0 && height_m > ends_below_m; ++tick) {
            all.push_back({tick, height_m, down_m_s});
            for (int step = 0; step < steps; ++step) {
                const double time_s = 0.2 * static_cast<double>(tick) + 0.01 * step;
                down_m_s = wanted_m_s(time_s, height_m, opens_m, down_m_s);
                height_m -= 0.01 * down_m_s;
            }
            if (height_m > ground_m) continue;
            if (!lands) break;
            height_m = ground_m;
            down_m_s = 0.0;
            stood_s += 0.2;
        }
        return all;
    }

    double exit_s() const { return dives_before ? 100.0 : 20.0; }

    double wanted_m_s(double time_s, double height_m, double opens_m, double now_m_s) const {
        const double since_s = time_s - exit_s();
        if (since_s < 0.0) {
            if (!dives_before) return 0.0;
            // 15 s of a dive, and 60 s to climb above where it began.
            if (time_s < 20.0) return 0.0;
            if (time_s < 35.0) return 130.0 * std::sin(std::numbers::pi * (time_s - 20.0) / 15.0);
            return time_s < 95.0 ? -22.0 : 0.0;
        }
        if (height_m < opens_m) return std::max(5.0, now_m_s - 0.3);
        const double bump = (since_s - fastest_s) / 3.0;
        return 100.0 * std::tanh(since_s / 10.0) + 15.0 * std::exp(-0.5 * bump * bump);
    }

    std::string text() const {
        std::string rows =
            "time,lat,lon,hMSL,velN,velE,velD,hAcc,vAcc,sAcc,heading,cAcc,gpsFix,numSV\n"
            ",(deg),(deg),(m),(m/s),(m/s),(m/s),(m),(m),(m/s),(deg),(deg),,\n";
        RandomGenerator random(7);
        for (const Sample& sample : samples()) {
            const std::int64_t tenths = 2 * sample.tick;
            rows += fmt::format(
                "2026-03-14T10:{:02}:{:02}.{}0Z,54.7675000,37.6420000,{:.3f},0.00,0.00,{:.2f},1.0,"
                "{:.1f},0.25,0.0,0.9,3,14\n",
                tenths / 600, tenths / 10 % 60, tenths % 10,
                sample.height_m + 0.05 * random.normal(), sample.down_m_s + 0.05 * random.normal(),
                accuracy_m);
        }
        return rows;
    }
};

/// The scorers' arithmetic, done again on the text: km/h, of samples whose heights are above an
/// end.
double scored_km_h(const std::string& text, double below_exit_m, double above_m) {
    std::vector<double> heights;
    std::size_t begin = 0, line = 0;
    bool falls = false;
    double exit_m = 0.0, highest_m = -1e9;
    std::vector<std::pair<double, double>> rows;  // height, down
    for (std::size_t from = 0; from < text.size(); ++line) {
        const std::size_t to = text.find('\n', from);
        std::vector<std::string> cells;
        std::string cell;
        for (const char c : text.substr(from, to - from) + ",")
            if (c == ',')
                cells.push_back(std::move(cell)), cell.clear();
            else
                cell += c;
        if (line > 1) rows.emplace_back(*parse_double(cells[3]), *parse_double(cells[6]));
        from = to + 1;
    }
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (rows[i].first > highest_m) {
            highest_m = rows[i].first;
            begin = i;
        }
    for (std::size_t i = begin; i < rows.size(); ++i) {
        if (!falls && rows[i].second < 10.0) continue;
        if (!falls) exit_m = rows[i].first;
        falls = true;
        if (rows[i].first < std::max(exit_m - below_exit_m, above_m)) break;
        heights.push_back(rows[i].first);
    }
    double best = 0.0;
    for (std::size_t i = 15; i < heights.size(); ++i)
        best = std::max(best, (heights[i - 15] - heights[i]) / 3.0);
    return std::round(best * 360.0) / 100.0;
}

struct JudgedJump {
    ProfileVerdict verdict;
    ProfileWindows windows;
    double scored_km_h = 0.0;

    RequirementStatus status(const std::string& clause) const {
        return requirement_of(verdict, clause).status;
    }
    double own_km_h() const {
        return *parse_double(
            verdict.own_arithmetic.shown.substr(0, verdict.own_arithmetic.shown.find(' ')));
    }
};

JudgedJump judged(const SimulatedJump& jump, const std::string& more = {},
                  const std::string& profile = "fai-speed-skydiving-2026") {
    const Rules rules;
    const std::string text = jump.text();
    rules.put("TRACK.CSV", text);
    JudgedJump result;
    result.verdict = rules.judge_one(
        fmt::format("schema: attempt/1.0\nid: jump\ncraft: {{name: diver, class: skydiver}}\n"
                    "date: \"2026-03-14\"\nreceivers: [{{id: r1, recording: TRACK.CSV}}]\n"
                    "profiles: [{}]\nrecord: {{speed: 300, unit: km/h, source: none}}\n{}",
                    profile, more));
    result.windows = rules.windows().profiles.at(0);
    result.scored_km_h = scored_km_h(text, 2256.0, jump.lands ? jump.ground_m + 1707.0 : -1e9);
    return result;
}

TEST(SkydivePart, TheFastest3SInIt) {
    const JudgedJump jump = judged({});
    EXPECT_EQ(jump.own_km_h(), jump.scored_km_h);
    EXPECT_GT(jump.scored_km_h, 390.0);
    EXPECT_NEAR(*jump.verdict.speed_m_s * 3.6, jump.scored_km_h,
                *jump.verdict.expanded_uncertainty_m_s * 3.6);
    for (const char* clause : {"performance-window", "average-over-3-s", "validation-window",
                               "exit-at-most", "samples-3-s-apart", "fastest-certifiable"})
        EXPECT_EQ(jump.status(clause), RequirementStatus::met)
            << clause << requirement_of(jump.verdict, clause).evidence;
    EXPECT_EQ(jump.status("exit-at-least"), RequirementStatus::attest);
}

TEST(SkydivePart, FasterAfterItCountsNot) {
    const JudgedJump jump = judged({.fastest_s = 36.0});
    EXPECT_EQ(jump.own_km_h(), jump.scored_km_h);
    EXPECT_LT(jump.scored_km_h, 365.0);
    EXPECT_LT(*jump.verdict.speed_m_s * 3.6, 365.0);
    EXPECT_LT(jump.windows.indicated->speed_m_s * 3.6, 365.0);
}

TEST(SkydivePart, FasterBeforeItCountsNot) {
    const JudgedJump jump = judged({.dives_before = true});
    EXPECT_EQ(jump.own_km_h(), jump.scored_km_h);
    EXPECT_LT(jump.own_km_h(), 430.0);
    EXPECT_GT(jump.windows.part->from->time_s, 100.0);
}

TEST(SkydivePart, TheBreakOffEndsIt) {
    const SimulatedJump low{.top_m = 3700.0, .fastest_s = 24.0};
    const JudgedJump jump = judged(low);
    EXPECT_EQ(jump.windows.part->to->event, WindowEvent::above_ground);
    EXPECT_EQ(jump.own_km_h(), jump.scored_km_h);
}

TEST(SkydivePart, AnExitTooHighHasNoScore) {
    const JudgedJump jump = judged({.top_m = 4450.0});
    EXPECT_EQ(jump.status("exit-at-most"), RequirementStatus::not_met);
    EXPECT_EQ(jump.verdict.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(jump.verdict.reason, "exit-at-most")) << jump.verdict.reason;
}

TEST(SkydivePart, WithoutTheGroundItIsToBeAttested) {
    const SimulatedJump cut{.lands = false, .ends_below_m = 900.0};
    const JudgedJump jump = judged(cut);
    EXPECT_EQ(jump.own_km_h(), jump.scored_km_h);
    for (const char* clause : {"performance-window", "exit-at-most"}) {
        EXPECT_EQ(jump.status(clause), RequirementStatus::attest);
        EXPECT_TRUE(contains(requirement_of(jump.verdict, clause).evidence, "ground"));
    }
    // The attempt's own word on the ground is to be attested, too.
    const JudgedJump stated = judged(cut, "ground_height_m: 100\n");
    EXPECT_EQ(stated.windows.part->ground, GroundSource::attempt);
    EXPECT_EQ(stated.status("performance-window"), RequirementStatus::attest);
    EXPECT_TRUE(
        contains(requirement_of(stated.verdict, "performance-window").evidence, "ground_height_m"));
    EXPECT_EQ(judged(cut, "ground_height_m: -200\n").verdict.outcome, Outcome::not_certifiable);
}

TEST(SkydivePart, SamplesTooInaccurateBeforeTheWindowEndsAreRefused) {
    const JudgedJump jump = judged({.accuracy_m = 7.0});
    EXPECT_EQ(jump.status("validation-window"), RequirementStatus::not_met);
    EXPECT_EQ(jump.verdict.outcome, Outcome::not_certifiable);
}

TEST(SkydivePart, ARecordingThatEndsInItSaysSo) {
    const JudgedJump jump = judged({.lands = false, .ends_below_m = 2600.0});
    EXPECT_FALSE(jump.windows.part->to);
    EXPECT_EQ(jump.status("performance-window"), RequirementStatus::attest);
    EXPECT_TRUE(contains(requirement_of(jump.verdict, "performance-window").evidence,
                         "the recording ends before"));
}

TEST(SkydivePart, ARecordIsRoundedDownToAWholeNumber) {
    const JudgedJump jump = judged({}, {}, "fai-speed-skydiving-record");
    EXPECT_EQ(jump.own_km_h(), std::floor(jump.scored_km_h));
    EXPECT_NEAR(*jump.verdict.required_speed_m_s * 3.6, 306.0, 1e-6);
}

// Public recordings, by the scorers' arithmetic.

struct ScoredRecording {
    const char* file;
    const char* shown;
};

TEST(SkydiveScores, OfPublicRecordings) {
    const auto data = recordings();
    if (!data) GTEST_SKIP() << "RUNCERT_DATA is not set";
    for (const auto& [file, shown] : {ScoredRecording{"flysight1_good.csv", "444.61 km/h"},
                                      ScoredRecording{"flysight2_track.csv", "472.81 km/h"}}) {
        const Rules rules;
        rules.bring_in(*data / "speed_skydive" / file);
        const ProfileVerdict verdict = rules.judge_one(
            fmt::format("schema: attempt/1.0\nid: jump\ncraft: {{name: d, class: skydiver}}\n"
                        "receivers: [{{id: r1, recording: {}}}]\n"
                        "profiles: [fai-speed-skydiving-2026]\n",
                        file));
        EXPECT_EQ(verdict.own_arithmetic.shown, shown) << file;
        EXPECT_TRUE(contains(verdict.own_arithmetic.text, "noise of single samples is smoothed"))
            << verdict.own_arithmetic.text;
    }
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
