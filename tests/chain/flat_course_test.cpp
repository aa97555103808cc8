#include "rules_support.h"

// Flatness and standing start of a course whose heights and speeds are known.

namespace runcert::chain::RUNCERT_FILE {
namespace {

/// Still for 8 s (or rolling), then 2 m/s^2 up to 25 m/s, which it keeps.
struct Approach {
    double rolling_m_s = 0.0;

    double speed_m_s(double time_s) const {
        return std::clamp(2.0 * (time_s - 8.0), rolling_m_s, 25.0);
    }
    double path_m(double time_s) const {
        const double gains_from_s = 8.0 + 0.5 * rolling_m_s;
        const double slow_m = rolling_m_s * std::min(time_s, gains_from_s);
        if (time_s <= gains_from_s) return slow_m;
        const double until_s = std::min(time_s, 20.5);
        return slow_m + 0.5 * (speed_m_s(until_s) + rolling_m_s) * (until_s - gains_from_s) +
               25.0 * std::max(0.0, time_s - 20.5);
    }
};

/// Over a hill of so much, 200 m across; 20 mm of noise in heights, 10 mm horizontally.
PlaneRecording over_a_hill(double height_m, Approach run = {}, std::uint64_t seed = 1) {
    return {.position_at =
                [height_m, run](double time_s) {
                    const double path_m = run.path_m(time_s);
                    const double part = std::clamp((path_m - 100.0) / 200.0, 0.0, 1.0);
                    return PlanePosition{
                        .north_m = path_m,
                        .up_m = 0.5 * height_m * (1.0 - std::cos(2.0 * std::numbers::pi * part))};
                },
            .duration_s = 36.0,
            .noise_m = 0.01,
            .noise_up_m = 0.02,
            .seed = seed};
}

ProfileVerdict judged(const PlaneRecording& recording) {
    const Rules rules;
    rules.put("recording.csv", recording.text());
    return rules.judge_one(
        plane_attempt("nalsa", "record: {speed: 50, unit: km/h, source: none}\n"));
}

/// The height difference that is stated is the true one within its uncertainty and what noise
/// raises it by.
void expect_height(const ProfileVerdict& verdict, double true_m) {
    const Requirement requirement = requirement_of(verdict, "flat-course");
    ASSERT_EQ(requirement.figures.size(), 1U) << requirement.evidence;
    const Figure& figure = requirement.figures[0];
    ASSERT_TRUE(figure.expanded_uncertainty.has_value());
    EXPECT_GT(*figure.expanded_uncertainty, 0.02);
    EXPECT_LT(*figure.expanded_uncertainty, 0.12);
    EXPECT_GT(figure.value, true_m - *figure.expanded_uncertainty);
    EXPECT_LT(figure.value, true_m + *figure.expanded_uncertainty + 0.05);
}

TEST(FlatCourse, OfEightyCentimetresIsMet) {
    const ProfileVerdict verdict = judged(over_a_hill(0.8));
    EXPECT_EQ(requirement_of(verdict, "flat-course").status, RequirementStatus::met);
    expect_height(verdict, 0.8);
    EXPECT_EQ(verdict.outcome, Outcome::beaten) << verdict.reason;
}

TEST(FlatCourse, OfAMetreAndTwentyIsNotMetAndNotCertifiable) {
    const ProfileVerdict verdict = judged(over_a_hill(1.2));
    EXPECT_EQ(requirement_of(verdict, "flat-course").status, RequirementStatus::not_met);
    expect_height(verdict, 1.2);
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    for (const char* part : {"Not met: flat-course", "1.2", " m ± 0.0", "at most 1 m"})
        EXPECT_TRUE(contains(verdict.reason, part)) << verdict.reason;
}

TEST(FlatCourse, OfOneMetreIsForAPersonToAttest) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
        const ProfileVerdict verdict = judged(over_a_hill(1.0, {}, seed));
        const Requirement requirement = requirement_of(verdict, "flat-course");
        EXPECT_EQ(requirement.status, RequirementStatus::attest) << requirement.evidence;
        EXPECT_TRUE(
            contains(requirement.evidence,
                     "the limit lies within the uncertainty, not decidable from the recording"));
        expect_height(verdict, 1.0);
        EXPECT_EQ(verdict.outcome, Outcome::beaten) << verdict.reason;
    }
}

TEST(StandingStart, FromRestIsMet) {
    const ProfileVerdict verdict = judged(over_a_hill(0.5));
    const Requirement start = requirement_of(verdict, "own-start");
    EXPECT_EQ(start.status, RequirementStatus::met) << start.evidence;
    EXPECT_TRUE(start.figures.at(0).expanded_uncertainty.has_value());
    ASSERT_EQ(verdict.runs.size(), 1U);
    EXPECT_EQ(verdict.runs[0].began, RunEdge::standing);
    // 312.5 m / 25 m/s^2 of acceleration, less what is passed below 1 m/s, then 25 m/s.
    EXPECT_NEAR(verdict.runs[0].length_m, 156.25 + 25.0 * 15.5, 1.0);
}

TEST(StandingStart, RollingIsNotMet) {
    const ProfileVerdict verdict = judged(over_a_hill(0.5, Approach{.rolling_m_s = 0.6}));
    const Requirement start = requirement_of(verdict, "own-start");
    EXPECT_EQ(start.status, RequirementStatus::not_met) << start.evidence;
    EXPECT_NEAR(start.figures.at(0).value, 0.6, 0.1);
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_TRUE(contains(verdict.reason, "it was moving when the run began")) << verdict.reason;
}

TEST(StandingStart, ThatWasNotRecordedIsForAPerson) {
    const ProfileVerdict verdict = judged(over_a_hill(0.5, Approach{.rolling_m_s = 5.0}));
    const Requirement start = requirement_of(verdict, "own-start");
    EXPECT_EQ(start.status, RequirementStatus::attest) << start.evidence;
    EXPECT_TRUE(contains(start.evidence, "the recording begins with the craft moving"));
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
