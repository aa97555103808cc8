#include "motion_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/parallel.h"
#include "stages/check/decision.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "supposed_errors.h"

namespace runcert {
namespace {

constexpr double top_speed_m_s = 57.0;
constexpr double window_s = 3.0;

/// Standing, then up to speed, at it for a while, and back to a halt.
MotionScript plateau(double quiet_s, double acceleration_m_s2, double rounding_s, double plateau_s,
                     double braking_m_s2) {
    MotionScript script;
    script.add(quiet_s + 5.0)
        .change_speed(top_speed_m_s, acceleration_m_s2, rounding_s)
        .add(plateau_s)
        .change_speed(-top_speed_m_s, braking_m_s2, rounding_s)
        .add(10.0);
    return script;
}

std::vector<MotionCell> motions_at(double rate_hz) {
    std::vector<MotionCell> cells;
    const auto add = [&](std::string name, const MotionScript& script) {
        MotionCell& cell = cells.emplace_back();
        cell.motion = std::move(name);
        cell.run.rate_hz = rate_hz;
        cell.run.jerk_density = 0.0;
        cell.run.script = std::make_shared<const MotionScript>(script);
        cell.run.length_s = std::floor(script.duration_s());
    };
    for (const double quiet_min : {0.0, 1.0, 20.0, 60.0})
        for (const double acceleration : {1.0, 2.0, 4.0})
            for (const double plateau_s : {0.5, 3.5, 30.0})
                add(fmt::format("quiet {:g} min, {:g} m/s2 at once, plateau {:g} s", quiet_min,
                                acceleration, plateau_s),
                    plateau(60.0 * quiet_min, acceleration, 0.0, plateau_s, acceleration));
    for (const double quiet_min : {0.0, 20.0})
        for (const double acceleration : {4.0, 6.0, 8.0})
            for (const double rounding_s : {1.0, 0.5})
                add(fmt::format("quiet {:g} min, {:g} m/s2 over {:g} s, plateau 3.5 s", quiet_min,
                                acceleration, rounding_s),
                    plateau(60.0 * quiet_min, acceleration, rounding_s, 3.5, acceleration));
    for (const double quiet_min : {1.0, 20.0})
        for (const double acceleration : {4.4, 5.3, 6.2})
            for (const double jerk : {3.0, 6.7})
                add(fmt::format("quiet {:g} min, peak at {:g} m/s2, jerk {:g}", quiet_min,
                                acceleration, jerk),
                    plateau(60.0 * quiet_min, acceleration, acceleration / jerk, 0.0,
                            acceleration));
    for (const double quiet_min : {1.0, 20.0}) {
        add(fmt::format("quiet {:g} min, peak at 4 m/s2", quiet_min),
            plateau(60.0 * quiet_min, 4.0, 0.0, 0.0, 4.0));
        add(fmt::format("quiet {:g} min, braking at 8 m/s2 over 0.3 s", quiet_min),
            plateau(60.0 * quiet_min, 2.0, 0.3, 6.0, 8.0));
        MotionScript gusts;
        gusts.add(60.0 * quiet_min + 5.0).change_speed(45.0, 2.0, 1.0);
        gusts.gust(1.0, 2.3).gust(2.0, 7.0).add(40.0);
        add(fmt::format("quiet {:g} min, gusts of 2.3 and 7 s", quiet_min), gusts);
        MotionScript two;
        two.add(60.0 * quiet_min + 5.0);
        for (int i = 0; i < 2; ++i)
            two.change_speed(top_speed_m_s, 2.0, 0.5)
                .add(3.5)
                .change_speed(-top_speed_m_s, 3.0, 0.5)
                .add(10.0);
        add(fmt::format("quiet {:g} min, two equal runs", quiet_min), two);
    }
    return cells;
}

struct Errors {
    const char* name;
    StudyNoise noise;
};

const std::vector<Errors>& kinds_of_errors() {
    static const std::vector<Errors> kinds{
        {"10 mm white", {.white_m = 0.010}},
        {"3 mm white, 8 mm 1.5 s", {.white_m = 0.003, .error_sigma_m = 0.008, .error_tau_s = 1.5}},
        {"3 mm white, 20 mm 1.5 s", {.white_m = 0.003, .error_sigma_m = 0.020, .error_tau_s = 1.5}},
        {"10 mm white, 80 mm 1.5 s along",
         {.white_m = 0.010, .error_sigma_m = 0.080, .error_tau_s = 1.5, .error_along_only = true}},
        {"0.3 m white, 0.5 m 20 s, single",
         {.white_m = 0.300, .error_sigma_m = 0.500, .error_tau_s = 20.0, .fix = FixType::single}},
    };
    return kinds;
}

double speed_between(const SimulatedRecording& recording, std::size_t first, std::size_t last) {
    return (recording.truth[last] - recording.truth[first]).norm() / window_s;
}

/// Fastest true speed over a window between epochs.
double best_true(const SimulatedRecording& recording, double rate_hz) {
    const auto length = static_cast<std::size_t>(std::lround(window_s * rate_hz));
    double best = 0.0;
    for (std::size_t k = 0; k + length < recording.truth.size(); ++k)
        best = std::max(best, speed_between(recording, k, k + length));
    return best;
}

void judge(const CertifiableWindow& window, const EstimationSummary& estimation,
           const Profile& profile, const SimulatedRecording& recording, double rate_hz,
           MotionResult& result) {
    const double best = best_true(recording, rate_hz);
    const double truth =
        speed_between(recording, static_cast<std::size_t>(window.span.first_epoch) - 1,
                      static_cast<std::size_t>(window.span.last_epoch) - 1);
    result.certified = window.robust ? window.robust->agrees : estimation.robust_unsolved == 0;
    result.stated_m_s = window.speed_m_s;
    result.budget = window.budget;
    if (window.selection) result.bias_m_s = window.selection->bias_m_s;
    result.error_m_s = window.speed_m_s - truth;
    result.missed_m_s = best - truth;
    const SpeedPosterior posterior{
        .speed_m_s = window.speed_m_s,
        .standard_uncertainty_m_s = window.standard_uncertainty_m_s,
        .effective_degrees_of_freedom = window.effective_degrees_of_freedom,
        .bias_limit_m_s = window.bias_limit_m_s};
    result.expanded_m_s = expanded_uncertainty_by_rule_m_s(window, profile.coverage_factor);
    const auto outcome = [&](double required_speed_m_s) {
        return decide(posterior, Threshold{.speed_m_s = required_speed_m_s},
                      profile.decision_probability);
    };
    result.falsely_beaten = result.certified && outcome(best) == Outcome::beaten;
    result.falsely_not_beaten = result.certified && outcome(0.99 * best) == Outcome::not_beaten &&
                                !(result.indicated_m_s >= 0.99 * best);
}

MotionResult study_one(const MotionCell& cell, std::uint64_t seed) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    const SimulatedRecording recording = simulate_recording(cell.run, seed);
    MotionResult result;
    try {
        ScreenConfig screen_config = study_screen_config();
        screen_config.counted_fixes.insert(cell.run.noise.fix);
        const ScreenedTable screened = screen(to_be_screened(recording.screened), screen_config);
        result.left_out = std::ssize(screened.rows) - summarise(screened.rows).usable;
        const TrajectoryTable trajectory =
            smooth_trajectory(screened, smooth_config(study_attempt()));
        WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
        config.plane_scale_bound = 0.0;
        const Windows windows = find_windows(screened, trajectory, {profile}, config);
        const ProfileWindows& found = windows.profiles.front();
        if (found.indicated && !found.indicated->refusals.empty())
            result.indicated_m_s = found.indicated->speed_m_s;
        if (found.best)
            judge(*found.best, trajectory.estimation, profile, recording, cell.run.rate_hz, result);
    } catch (const Failure& failure) {
        result.failure = failure.what();
    }
    return result;
}

}  // namespace

std::vector<MotionCell> motion_cells(double rate_hz) {
    std::vector<MotionCell> cells;
    for (const MotionCell& motion : motions_at(rate_hz))
        for (const Errors& errors : kinds_of_errors()) {
            cells.push_back(motion);
            cells.back().errors = errors.name;
            cells.back().run.noise = errors.noise;
        }
    return cells;
}

std::vector<MotionResult> study_motion(const MotionCell& cell, const MotionStudyOptions& options) {
    return results_of(options.runs, options.threads, [&](std::int64_t i) {
        return study_one(cell, options.seed * 1'000'003 + static_cast<std::uint64_t>(i));
    });
}

MotionSummary summarise(const std::vector<MotionResult>& results) {
    MotionSummary sum;
    double squares = 0.0;
    for (const MotionResult& one : results) {
        ++sum.runs;
        sum.mean_left_out += static_cast<double>(one.left_out);
        if (one.falsely_not_beaten) ++sum.not_beaten;
        if (!one.certified) continue;
        ++sum.certified;
        if (std::abs(one.error_m_s) <= one.expanded_m_s) ++sum.held;
        if (one.missed_m_s > one.expanded_m_s) ++sum.missed;
        if (one.falsely_beaten) ++sum.beaten;
        sum.mean_error_m_s += one.error_m_s;
        squares += one.error_m_s * one.error_m_s;
        sum.mean_expanded_m_s += one.expanded_m_s;
        sum.largest_error_in_expanded =
            std::max(sum.largest_error_in_expanded, std::abs(one.error_m_s) / one.expanded_m_s);
    }
    const auto n = static_cast<double>(std::max<std::int64_t>(1, sum.certified));
    sum.mean_error_m_s /= n;
    sum.mean_expanded_m_s /= n;
    sum.sd_error_m_s =
        std::sqrt(std::max(0.0, squares / n - sum.mean_error_m_s * sum.mean_error_m_s));
    sum.mean_left_out /= static_cast<double>(std::max<std::int64_t>(1, sum.runs));
    return sum;
}

std::string motion_header() {
    return fmt::format(
        "{:<52} {:<32} {:>5} {:>5} {:>6} {:>7} {:>6} {:>6} {:>6} {:>6} {:>5} {:>6} {:>7}\n",
        "motion", "errors", "runs", "cert", "held %", "mean", "sd", "U", "max/U", "missed", "beat",
        "not b.", "out");
}

std::string motion_line(const MotionCell& cell, const MotionSummary& s) {
    return fmt::format(
        "{:<52} {:<32} {:5} {:5} {:6.1f} {:+7.3f} {:6.3f} {:6.3f} {:6.2f} {:6} {:5} {:6} {:7.1f}\n",
        cell.motion, cell.errors, s.runs, s.certified,
        s.certified ? 100.0 * static_cast<double>(s.held) / static_cast<double>(s.certified) : 0.0,
        s.mean_error_m_s * 3.6, s.sd_error_m_s * 3.6, s.mean_expanded_m_s * 3.6,
        s.largest_error_in_expanded, s.missed, s.beaten, s.not_beaten, s.mean_left_out);
}

}  // namespace runcert
