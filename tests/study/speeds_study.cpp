#include "speeds_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/statistics.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_verdict.h"

namespace runcert {
namespace {

/// The draws that check the budget change nothing that is counted here: the fewest are made.
const Attempt& speeds_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: speeds\ncraft: {name: speeds, class: board}\n"
        "receivers: [{id: primary, recording: none}]\n"
        "profiles: [gps-speed-sailing-2s, gps-speed-sailing-10s]\n"
        "parameters: {window: {monte_carlo_trials_max: 100000}}\n",
        "speeds");
    return attempt;
}

const std::vector<Profile>& speeds_rules() {
    static const std::vector<Profile> rules = [] {
        std::vector<Profile> all;
        for (const std::string& name : speeds_attempt().profiles)
            all.push_back(read_profile(builtin_profile(name), name));
        return all;
    }();
    return rules;
}

using TrueSpeed = std::function<double(double)>;

/// Over the samples of a window but its first, as the rules take the mean.
double mean_over(const WindowSpan& span, const std::vector<ScreenedEpoch>& rows,
                 const TrueSpeed& true_speed) {
    const double from_s = span.start.seconds(), to_s = from_s + span.duration.seconds();
    std::vector<double> speeds;
    for (const ScreenedEpoch& row : rows)
        if (row.time.seconds() > from_s + 1e-6 && row.time.seconds() < to_s + 1e-6)
            speeds.push_back(true_speed(row.time.seconds()));
    return mean(speeds);
}

CertifiedSpeed judged(const ReceiverFindings& findings, const Profile& rule,
                      const std::vector<ScreenedEpoch>& rows, const TrueSpeed& true_speed,
                      double delay_s) {
    CertifiedSpeed one{.rule = rule.id};
    const ProfileVerdict verdict = verdict_at(speeds_attempt(), std::nullopt, findings, rule);
    if (verdict.outcome == Outcome::not_certifiable || !verdict.window) {
        one.refusal = reason_words(verdict.reason);
        return one;
    }
    one.speed = *verdict.speed_m_s;
    one.expanded = *verdict.expanded_uncertainty_m_s;
    one.truth = mean_over(*verdict.window, rows, true_speed);
    one.truth_before = mean_over(*verdict.window, rows,
                                 [&](double time_s) { return true_speed(time_s - delay_s); });
    one.falsely_beaten =
        verdict_at(speeds_attempt(), one.truth, findings, rule).outcome == Outcome::beaten;
    return one;
}

std::vector<CertifiedSpeed> certify(const EnuTable& measured, const TrueSpeed& true_speed,
                                    double delay_s) {
    const Attempt& attempt = speeds_attempt();
    std::vector<CertifiedSpeed> all;
    try {
        const ScreenedTable screened = screen(measured, screen_config(attempt));
        TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(attempt));
        Windows windows = find_windows(screened, trajectory, speeds_rules(),
                                       window_config(attempt, attempt.receivers.front()));
        const ReceiverFindings findings =
            findings_of(screened, std::move(trajectory), std::move(windows));
        for (const Profile& rule : speeds_rules())
            all.push_back(judged(findings, rule, screened.rows, true_speed, delay_s));
    } catch (const Failure& failure) {
        all.clear();
        for (const Profile& rule : speeds_rules())
            all.push_back({.rule = rule.id, .refusal = reason_words(failure.what())});
    }
    return all;
}

std::vector<SpeedsCell> every_speeds_cell() {
    std::vector<SpeedsCell> cells;
    const auto add = [&](std::string name, SpeedsCell cell) {
        cell.name = std::move(name);
        cells.push_back(std::move(cell));
    };
    const auto hertz = [](double rate_hz) { return fmt::format("{:g} Hz", rate_hz); };
    for (const double rate_hz : {1.0, 5.0, 10.0, 20.0})
        add("honest, " + hertz(rate_hz), {.rate_hz = rate_hz});
    for (const double rate_hz : {1.0, 5.0, 10.0, 20.0})
        add("jitter and gaps, " + hertz(rate_hz), {.rate_hz = rate_hz, .jitters = true});
    const SpeedsCell calm{.white_m_s = 0.05};
    const auto erring = [&](double slow_m_s, double tau_s, double stated_m_s) {
        SpeedsCell cell = calm;
        cell.slow_m_s = slow_m_s;
        cell.slow_tau_s = tau_s;
        cell.stated_m_s = stated_m_s;
        return cell;
    };
    add("errs 0.15 m/s, states 0.08", erring(0.15, 15.0, 0.08));
    add("errs 0.15 m/s, states 0.3", erring(0.15, 15.0, 0.3));
    add("errs 0.2 m/s, states 0.15", erring(0.2, 20.0, 0.15));
    for (const double percent : {1.5, -1.5, 0.5})
        add(fmt::format("scale {:+g} %", percent),
            {.stated_m_s = 0.08, .scale = 1.0 + percent / 100.0});
    add("low-passed 0.5 s, 10 Hz", {.low_pass_s = 0.5});
    add("low-passed 1.5 s, 10 Hz", {.low_pass_s = 1.5});
    add("low-passed 1.5 s, 1 Hz", {.rate_hz = 1.0, .low_pass_s = 1.5});
    add("overshoot", {.overshoots = true});
    add("bursts", {.bursts = true});
    for (const double rate_hz : {5.0, 10.0, 20.0})
        for (const double percent : {10.0, 20.0, 45.0, 80.0})
            add(fmt::format("spike of {:+g} %, {}", percent, hertz(rate_hz)),
                {.rate_hz = rate_hz, .length_s = 200.0, .spike = {.part = percent / 100.0}});
    add("spike of two samples, +25 %", {.length_s = 200.0, .spike = {.part = 0.25, .samples = 2}});
    add("spike of +45 % that states 3 m/s",
        {.length_s = 200.0, .spike = {.part = 0.45, .stated_m_s = 3.0}});
    const auto beside = [&](SpeedsPositions positions, double tau_s, double stated_m_s,
                            double added_m) {
        SpeedsCell cell = erring(0.2, 20.0, stated_m_s);
        cell.positions = positions;
        cell.positions_tau_s = tau_s;
        cell.added_m = added_m;
        return cell;
    };
    for (const double added_m : {0.0, 0.1})
        for (const double stated_m_s : {0.15, 0.25})
            add(fmt::format("positions integrated{}, states {:g}", added_m > 0.0 ? ", 0.1 m" : "",
                            stated_m_s),
                beside(SpeedsPositions::integrated, 0.0, stated_m_s, added_m));
    for (const double tau_s : {15.0, 30.0, 100.0})
        add(fmt::format("positions smoothed over {:g} s", tau_s),
            beside(SpeedsPositions::smoothed, tau_s, 0.25, 0.0));
    for (const double added_m_s : {0.0, 0.03})
        add(fmt::format("differences of positions{}", added_m_s > 0.0 ? ", 0.03 m/s" : ""),
            {.stated_m_s = 0.1, .positions = SpeedsPositions::differenced, .added_m_s = added_m_s});
    for (const double wave_m : {0.4, 0.8})
        add(fmt::format("positions wave by {:g} m", wave_m), {.wave_m = wave_m});
    add("equal legs", {.equal_legs = true});
    return cells;
}

}  // namespace

const std::vector<SpeedsCell>& speeds_cells() {
    static const std::vector<SpeedsCell> cells = every_speeds_cell();
    return cells;
}

std::vector<CertifiedSpeed> certify_speeds(const SpeedsCell& cell, std::uint64_t seed) {
    const SpeedsRecording recording = record_speeds(cell, seed);
    return certify(
        recording.measured, [&](double time_s) { return recording.path.velocity(time_s).norm(); },
        cell.delay_s());
}

std::vector<CertifiedSpeed> certify_speeds(const PeopleKind& kind, std::uint64_t seed) {
    const PeopleRecording recording = record_people(kind, PeopleFault::none, seed);
    return certify(
        recording.measured,
        [&](double time_s) {
            return recording.path.velocity(time_s - recording.device.velocity_late_s).norm();
        },
        0.0);
}

std::string SpeedsSummary::misses() const {
    std::vector<std::string> all;
    if (certified == 0) return {};
    if (held < 0.94) all.push_back(fmt::format("{:.0f} % inside", 100.0 * held));
    if (falsely_beaten > 0.025)
        all.push_back(fmt::format("{:.0f} % falsely beaten", 100.0 * falsely_beaten));
    if (std::abs(mean_error) > 0.3 * mean_expanded)
        all.push_back(fmt::format("mean error {:+.2f} U", mean_error / mean_expanded));
    return fmt::format("{}", fmt::join(all, ", "));
}

std::vector<SpeedsSummary> study_speeds(
    const std::function<std::vector<CertifiedSpeed>(std::uint64_t)>& certify, std::int64_t runs,
    std::uint64_t seed, unsigned threads) {
    const auto results = results_of(runs, threads, [&](std::int64_t i) {
        return certify(seed * 7'000'003 + static_cast<std::uint64_t>(i));
    });
    std::vector<SpeedsSummary> summaries;
    for (std::size_t rule = 0; rule < speeds_rules().size(); ++rule) {
        SpeedsSummary& summary = summaries.emplace_back();
        summary.rule = speeds_rules()[rule].id;
        summary.runs = runs;
        std::vector<double> errors, before, expanded;
        for (const auto& result : results) {
            const CertifiedSpeed& one = result[rule];
            if (!one.certified()) {
                ++summary.refusals[one.refusal];
                continue;
            }
            errors.push_back(one.error());
            before.push_back(one.speed - one.truth_before);
            expanded.push_back(one.expanded);
            summary.held += std::abs(one.error()) <= one.expanded ? 1.0 : 0.0;
            summary.falsely_beaten += one.falsely_beaten ? 1.0 : 0.0;
        }
        summary.certified = std::ssize(errors);
        if (errors.empty()) continue;
        summary.held /= static_cast<double>(errors.size());
        summary.falsely_beaten /= static_cast<double>(errors.size());
        summary.mean_error = mean(errors);
        summary.mean_error_before = mean(before);
        summary.mean_expanded = mean(expanded);
        if (errors.size() > 1) summary.sd_error = standard_deviation(errors);
    }
    return summaries;
}

std::string speeds_heading() {
    return "                                                       certified inside beaten  mean "
           "error  unless late       sd        U\n"
           "                                                         of runs        falsely      "
           "of "
           "U        of U     km/h     km/h\n";
}

std::string speeds_lines(const std::string& name, const std::vector<SpeedsSummary>& rules) {
    std::string text;
    for (const SpeedsSummary& one : rules) {
        const std::string_view figures = std::string_view(one.rule).substr(one.rule.rfind('-') + 1);
        const double per_expanded = one.mean_expanded > 0.0 ? 1.0 / one.mean_expanded : 0.0;
        text += fmt::format(
            "{:48} {:>4} {:4} of {:<4} {:6.3f} {:6.3f} {:+11.2f} {:+11.2f} {:8.3f} {:8.3f}\n", name,
            figures, one.certified, one.runs, one.held, one.falsely_beaten,
            one.mean_error * per_expanded, one.mean_error_before * per_expanded, 3.6 * one.sd_error,
            3.6 * one.mean_expanded);
        for (const auto& [reason, count] : one.refusals)
            text += fmt::format("{:>53} refused: {}\n", count, reason);
    }
    return text;
}

}  // namespace runcert
