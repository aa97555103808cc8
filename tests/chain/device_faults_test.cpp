#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "motion_script.h"
#include "rules_support.h"

// What a device does to positions and times before it writes them, and positions alone cannot see:
// never a record without the clause that names it.

namespace runcert::chain::RUNCERT_FILE {
namespace {

constexpr double interval_s = 0.1;
constexpr double white_m = 0.010;

/// Standing, up to 57 m/s, a plateau, and back.
MotionScript run_of(double acceleration_m_s2, double rounding_s, double plateau_s = 6.0) {
    MotionScript script;
    script.add(20.0)
        .change_speed(57.0, acceleration_m_s2, rounding_s)
        .add(plateau_s)
        .change_speed(-57.0, acceleration_m_s2, rounding_s)
        .add(10.0);
    return script;
}

struct Stamped {
    double stamp_s = 0.0;
    double along_m = 0.0;
};

/// What is recorded at each epoch, before noise.
struct DeviceRecording {
    std::vector<Stamped> rows;
    double best_m_s = 0.0;  ///< fastest true speed over 3 s

    template <typename Position, typename Stamp>
    DeviceRecording(const MotionScript& motion, Position position, Stamp stamp) {
        const auto count = static_cast<int>(std::floor(motion.duration_s() / interval_s));
        for (int k = 0; k <= count; ++k) {
            const double time_s = interval_s * k;
            rows.push_back({stamp(time_s), position(time_s)});
            if (time_s >= 3.0)
                best_m_s = std::max(
                    best_m_s,
                    (motion.at(time_s).distance_m - motion.at(time_s - 3.0).distance_m) / 3.0);
        }
    }

    /// As a table; the noise of each epoch given by `noise`, along and across.
    template <typename Noise>
    std::string text(Noise noise) const {
        std::string table = "time_s,east_m,north_m,up_m\n";
        for (const Stamped& row : rows) {
            const auto [along_m, across_m] = noise();
            table += fmt::format("{:.4f},{:.5f},{:.5f},0\n", row.stamp_s, across_m,
                                 row.along_m + along_m);
        }
        return table;
    }
};

auto white_noise(std::uint64_t seed, double size_m = white_m) {
    return [random = std::make_shared<RandomGenerator>(seed), size_m] {
        return std::pair{size_m * random->normal(), size_m * random->normal()};
    };
}

double as_it_is(double time_s) {
    return time_s;
}

/// Certifies against a record that the truth misses by 0.2 km/h: "beaten" is false.
ProfileVerdict judge(const std::string& table, double best_m_s, const std::string& solution) {
    const Rules rules;
    rules.put("recording.csv", table);
    const double margin_kmh = 1.609344;
    return rules
        .judge(fmt::format(
            "schema: attempt/1.0\nid: device\ncraft: {{name: yacht, class: land-yacht}}\n"
            "receivers: [{}]\nprofiles: [nalsa]\n"
            "record: {{speed: {:.4f}, unit: km/h, source: test}}\n"
            "parameters:\n  screen: {{allowed_fixes: [fixed, single]}}\n"
            "  window: {{plane_scale_bound: 0}}\n",
            csv_receiver("primary", "recording.csv", white_m, {}, solution),
            best_m_s * 3.6 + 0.2 - margin_kmh))
        .profiles.front();
}

const Requirement& requirement(const ProfileVerdict& verdict, const std::string& clause) {
    return *std::ranges::find(verdict.requirements, clause, &Requirement::clause);
}

/// Prints a line of the table, and holds it to: no record without the clause.
void expect_no_silent_record(const std::string& device, const ProfileVerdict& verdict,
                             const std::string& clause) {
    const Requirement& named = requirement(verdict, clause);
    fmt::print("{:<44} {:<16} {}\n    {}: {} ({})\n", device, to_text(verdict.outcome),
               verdict.reason, clause, to_text(named.status), named.evidence);
    SCOPED_TRACE(device);
    EXPECT_NE(named.status, RequirementStatus::met);
    if (verdict.outcome == Outcome::beaten) {
        EXPECT_EQ(named.status, RequirementStatus::attest);
        EXPECT_EQ(verdict.reason.substr(0, 21), "By positions alone, t") << verdict.reason;
        ASSERT_TRUE(verdict.decision && verdict.decision->drift_survived_m);
        EXPECT_GT(*verdict.decision->drift_survived_m, 0.0);
    }
}

TEST(DeviceFaults, AClockThatRunsWrong) {
    const MotionScript motion = run_of(2.0, 1.0);
    const auto position = [&](double time_s) { return motion.at(time_s).distance_m; };
    for (const double short_by : {0.0015, 0.002, 0.004}) {
        const DeviceRecording recording(motion, position,
                                        [&](double t) { return t * (1.0 - short_by); });
        const ProfileVerdict verdict =
            judge(recording.text(white_noise(1)), recording.best_m_s, "fixed");
        expect_no_silent_record(fmt::format("stamps {:g} % short", 100.0 * short_by), verdict,
                                "time-scale");
        EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
        EXPECT_EQ(requirement(verdict, "time-scale").status, RequirementStatus::not_met);
    }
    // Stamps that count epochs, of a device that measured a little less often.
    const DeviceRecording counted(
        motion, [&](double t) { return motion.at(1.0004 * t).distance_m; }, as_it_is);
    expect_no_silent_record("epochs 0.04 % further apart than stamped",
                            judge(counted.text(white_noise(1)), counted.best_m_s, "fixed"),
                            "time-scale");
}

/// A filter of second order on what it is given, one value an epoch.
class SecondOrderFilter {
  public:
    SecondOrderFilter(double frequency_hz, double damping)
        : rate_(2.0 * std::numbers::pi * frequency_hz), damping_(damping) {}

    double next(double input) {
        constexpr int steps = 200;
        constexpr double step_s = interval_s / steps;
        for (int i = 0; i < steps; ++i) {
            const double at = before_ + (input - before_) * (i + 0.5) / steps;
            speed_ += step_s * (rate_ * rate_ * (at - value_) - 2.0 * damping_ * rate_ * speed_);
            value_ += step_s * speed_;
        }
        before_ = input;
        return value_;
    }

  private:
    double rate_;
    double damping_;
    double before_ = 0.0;
    double value_ = 0.0;
    double speed_ = 0.0;
};

TEST(DeviceFaults, AFilterThatSwings) {
    for (const double acceleration_m_s2 : {2.0, 4.0}) {
        const MotionScript motion = run_of(acceleration_m_s2, 0.5, 15.0);
        SecondOrderFilter filter(0.3, 0.3);
        const DeviceRecording recording(
            motion, [&](double t) { return filter.next(motion.at(t).distance_m); }, as_it_is);
        for (const double noise_m : {white_m, 0.1 * white_m}) {
            const ProfileVerdict verdict =
                judge(recording.text(white_noise(1, noise_m)), recording.best_m_s, "fixed");
            expect_no_silent_record(fmt::format("filter of 0.3 Hz, damping 0.3; {:g} mm, {:g} m/s2",
                                                1e3 * noise_m, acceleration_m_s2),
                                    verdict, "positions-as-measured");
            if (noise_m == white_m && acceleration_m_s2 < 4.0) continue;
            const std::string& said = requirement(verdict, "positions-as-measured").evidence;
            EXPECT_NE(said.find("oscillates with a period of 3."), std::string::npos) << said;
        }
    }
}

TEST(DeviceFaults, PositionsExtrapolated) {
    const MotionScript motion = run_of(2.0, 0.5);
    constexpr double ahead_s = 0.4;
    const DeviceRecording recording(
        motion,
        [&](double t) {
            const LineState before = motion.at(std::max(0.0, t - ahead_s));
            return before.distance_m + ahead_s * before.speed_m_s;
        },
        as_it_is);
    expect_no_silent_record("extrapolated by 0.4 s",
                            judge(recording.text(white_noise(1)), recording.best_m_s, "fixed"),
                            "positions-as-measured");
}

TEST(DeviceFaults, PositionsUpsampledOrHeld) {
    const MotionScript motion = run_of(2.0, 0.5);
    for (const bool held : {false, true}) {
        // Measured twice a second, with noise; between, a line or the same again.
        const auto noise = white_noise(1);
        constexpr double measured_every_s = 0.5;
        std::vector<double> measured;
        for (double t = 0.0; t <= motion.duration_s() + 1.0; t += measured_every_s)
            measured.push_back(motion.at(t).distance_m + noise().first);
        const DeviceRecording recording(
            motion,
            [&](double t) {
                const double at = t / measured_every_s + 1e-9;
                const auto i = static_cast<std::size_t>(at);
                return held ? measured[i]
                            : measured[i] +
                                  (at - static_cast<double>(i)) * (measured[i + 1] - measured[i]);
            },
            as_it_is);
        const ProfileVerdict verdict = judge(recording.text([] {
            return std::pair{0.0, 0.0};
        }),
                                             recording.best_m_s, "fixed");
        expect_no_silent_record(held ? "2 Hz held to 10 Hz" : "2 Hz interpolated to 10 Hz", verdict,
                                "positions-as-measured");
        EXPECT_EQ(verdict.outcome, Outcome::not_certifiable);
        EXPECT_EQ(requirement(verdict, "positions-as-measured").status, RequirementStatus::not_met);
    }
}

/// Gauss-Markov errors of 0.5 m and 20 s, low-passed, beside white noise.
auto slow_errors(std::uint64_t seed) {
    struct State {
        RandomGenerator random;
        double along_m = 0.0, across_m = 0.0, smooth_along_m = 0.0, smooth_across_m = 0.0;
    };
    auto state = std::make_shared<State>(State{.random = RandomGenerator(seed)});
    state->along_m = 0.5 * state->random.normal();
    state->across_m = 0.5 * state->random.normal();
    state->smooth_along_m = state->along_m;
    state->smooth_across_m = state->across_m;
    return [state] {
        const double kept = std::exp(-interval_s / 20.0);
        const double driven = 0.5 * std::sqrt(1.0 - kept * kept);
        state->along_m = kept * state->along_m + driven * state->random.normal();
        state->across_m = kept * state->across_m + driven * state->random.normal();
        constexpr double gain = 0.1;
        state->smooth_along_m += gain * (state->along_m - state->smooth_along_m);
        state->smooth_across_m += gain * (state->across_m - state->smooth_across_m);
        return std::pair{state->smooth_along_m + 0.3 * white_m * state->random.normal(),
                         state->smooth_across_m + 0.3 * white_m * state->random.normal()};
    };
}

TEST(DeviceFaults, AFixThatNobodyStates) {
    const MotionScript motion = run_of(2.0, 1.0);
    const auto position = [&](double time_s) { return motion.at(time_s).distance_m; };
    const DeviceRecording recording(motion, position, as_it_is);
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const std::string table = recording.text(slow_errors(seed));
        const ProfileVerdict unstated = judge(table, recording.best_m_s, "");
        fmt::print("{:<44} {:<16} {}\n", "0.5 m and 20 s, kind not stated",
                   to_text(unstated.outcome), unstated.reason);
        EXPECT_NE(unstated.outcome, Outcome::beaten);
        ASSERT_TRUE(unstated.speed_m_s);
        EXPECT_LE(std::abs(*unstated.speed_m_s - recording.best_m_s),
                  *unstated.expanded_uncertainty_m_s);
        expect_no_silent_record("the same, stated as fixed",
                                judge(table, recording.best_m_s, "fixed"), "kind-of-solution");
    }
}

TEST(DeviceFaults, ARampInTheWindow) {
    const MotionScript motion = run_of(2.0, 1.0);
    const double begins_s = motion.duration_s() / 2.0 - 4.0;
    const DeviceRecording recording(
        motion,
        [&](double t) {
            return motion.at(t).distance_m + 0.1 * std::clamp(t - begins_s, 0.0, 3.0);
        },
        as_it_is);
    expect_no_silent_record("positions that drift 0.3 m in 3 s",
                            judge(recording.text(white_noise(1)), recording.best_m_s, "fixed"),
                            "positions-as-measured");
}

}  // namespace
}  // namespace runcert::chain::RUNCERT_FILE
