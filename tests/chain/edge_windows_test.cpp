#include <cmath>

#include "motion_script.h"
#include "rules_support.h"

// Honest recordings that leave the smoother little to go by: an interval that holds the truth, or
// the true reason why there is none.

namespace runcert::chain::RUNCERT_FILE {
namespace {

PlaneRecording recording_of(const MotionScript& motion, double first_s, double duration_s) {
    return {.position_at =
                [motion](double time_s) {
                    return PlanePosition{.north_m = motion.at(time_s).distance_m};
                },
            .duration_s = duration_s,
            .first_s = first_s,
            .noise_m = 0.010,
            .noise_up_m = 0.020};
}

ProfileVerdict judge(const PlaneRecording& recording) {
    const Rules rules;
    rules.put("recording.csv", recording.text());
    return rules
        .judge(
            "schema: attempt/1.0\nid: edge\ncraft: {name: yacht, class: land-yacht}\n"
            "receivers: [" +
            csv_receiver("primary", "recording.csv") +
            "]\nprofiles: [nalsa]\nrecord: {speed: 500, unit: km/h, source: test}\n")
        .profiles.front();
}

/// The speed of the stated window is within its interval; returns it.
double expect_held(const PlaneRecording& recording, const ProfileVerdict& verdict) {
    EXPECT_TRUE(verdict.window && verdict.speed_m_s) << verdict.reason;
    if (!verdict.window || !verdict.speed_m_s) return 0.0;
    const double begin_s = recording.first_s + verdict.window->start.seconds();
    const double length_s = verdict.window->duration.seconds();
    const double true_m_s = (recording.position_at(begin_s + length_s).north_m -
                             recording.position_at(begin_s).north_m) /
                            length_s;
    EXPECT_LE(std::abs(*verdict.speed_m_s - true_m_s), *verdict.expanded_uncertainty_m_s);
    EXPECT_LE(*verdict.expanded_uncertainty_m_s, 0.4);
    return *verdict.speed_m_s;
}

MotionScript up_to_speed() {
    MotionScript motion;
    motion.add(10.0).change_speed(50.0, 2.5, 1.0).add(60.0);
    return motion;
}

TEST(EdgeWindows, TheRecordingEndsInTheFastestWindow) {
    const PlaneRecording recording = recording_of(up_to_speed(), 0.0, 29.0);
    EXPECT_GT(expect_held(recording, judge(recording)), 40.0);
}

TEST(EdgeWindows, TheRecordingBeginsInIt) {
    MotionScript motion = up_to_speed();
    motion.change_speed(-50.0, 3.0, 0.5).add(5.0);
    const PlaneRecording recording = recording_of(motion, 88.5, 16.0);
    EXPECT_GT(expect_held(recording, judge(recording)), 45.0);
}

TEST(EdgeWindows, OnlyTheRun) {
    const PlaneRecording recording = recording_of(up_to_speed(), 12.0, 22.0);
    EXPECT_GT(expect_held(recording, judge(recording)), 49.0);
}

TEST(EdgeWindows, ThreeSeconds) {
    const PlaneRecording recording = recording_of(up_to_speed(), 40.0, 3.0);
    EXPECT_NEAR(expect_held(recording, judge(recording)), 50.0, 0.4);
}

TEST(EdgeWindows, LessThanThreeSecondsHaveNoWindow) {
    const ProfileVerdict verdict = judge(recording_of(up_to_speed(), 40.0, 2.9));
    EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
    EXPECT_FALSE(verdict.window);
}

TEST(EdgeWindows, QuietThroughout) {
    MotionScript standing;
    standing.add(400.0);
    const PlaneRecording recording = recording_of(standing, 0.0, 300.0);
    const ProfileVerdict verdict = judge(recording);
    EXPECT_EQ(verdict.outcome, Outcome::not_beaten);
    ASSERT_TRUE(verdict.speed_m_s);
    EXPECT_GE(*verdict.speed_m_s + *verdict.expanded_uncertainty_m_s, 0.0);
    EXPECT_LE(*verdict.speed_m_s - *verdict.expanded_uncertainty_m_s, 0.0);
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
