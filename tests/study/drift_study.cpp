#include "drift_study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <memory>

#include "answered.h"
#include "core/failure.h"
#include "core/parallel.h"
#include "people_study.h"
#include "simulated_arc.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_phases.h"
#include "study_verdict.h"
#include "study_witnesses.h"

namespace runcert {
namespace {

constexpr double position_rate_hz = 10.0;
constexpr double position_wander_m = 0.004, position_wander_s = 5.0;
constexpr double drift_s = 6.0;
constexpr double doppler_m_s = 0.05, doppler_slow_m_s = 0.03;
constexpr double calibration = 1e-3;  // relative standard uncertainty
constexpr double tyre_m_s = 0.05;
constexpr double radar_m_s = 0.1, radar_each_s = 0.4;
constexpr double gates_each_m = 30.0;

/// A class, and no record; few draws, on which nothing counted here rests.
const Attempt& drift_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: drift\ncraft: {name: drift, class: land-yacht}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n"
        "parameters: {window: {monte_carlo_trials_max: 100000}}\n",
        "drift");
    return attempt;
}

/// Slow driving, then a fast stretch of three gusts.
class DriftingRun {
  public:
    DriftingRun(const DriftCell& cell, std::uint64_t seed) : cell_(cell), random_(seed) {
        auto script = std::make_shared<MotionScript>();
        constexpr double slow_m_s = 10.0, standing_s = 4.0;
        const double fast_m_s = 45.0 + 15.0 * random_.uniform();
        script->add(standing_s)
            .change_speed(slow_m_s, 2.0, 1.0)
            .add(30.0)
            .change_speed(fast_m_s - slow_m_s, 3.0, 2.0);
        fast_from_s_ = script->duration_s();
        for (int gust = 0; gust < 3; ++gust) {
            const double by_m_s = 0.5 + random_.uniform();
            script->change_speed(by_m_s, 0.6, 1.0)
                .add(1.5)
                .change_speed(-by_m_s, 0.6, 1.0)
                .add(1.0);
        }
        fast_until_s_ = script->duration_s();
        script->change_speed(-fast_m_s, 4.0, 2.0).add(standing_s);
        StudyRun run{
            .rate_hz = position_rate_hz, .length_s = script->duration_s(), .jerk_density = 0.0};
        run.noise = {.white_m = study_white_m,
                     .error_sigma_m = position_wander_m,
                     .error_tau_s = position_wander_s};
        run.script = std::move(script);
        motion_ = simulate_recording(run, random_.next());
        least_fast_m_s_ = fast_m_s - 0.1;
        measure();
    }

    DriftRun certify() {
        const Attempt& attempt = drift_attempt();
        const Profile& rule = people_rules().front();
        std::vector<ScreeningWitnesses> to_screen(tables_.size());
        to_screen.front().handed_in = handed_in_;
        const std::vector<ScreenedTable> screened =
            screen_receivers(tables_, screen_config(attempt), to_screen);
        std::vector<TrajectoryTable> trajectories;
        for (const ScreenedTable& table : screened)
            trajectories.push_back(smooth_trajectory(table, smooth_config(attempt)));
        WitnessRecords beside;
        beside.handed_in = handed_in_;
        if (screened.size() > 1)
            beside.receivers.push_back(
                {.screened = &screened.back(), .trajectory = &trajectories.back()});
        Windows windows = test::answered(
            find_windows(screened.front(), trajectories.front(), {rule},
                         window_config(attempt, attempt.receivers.front()), std::nullopt, beside));
        const ReceiverFindings findings =
            findings_of(screened.front(), std::move(trajectories.front()), std::move(windows));
        const ProfileVerdict verdict = verdict_at(attempt, std::nullopt, findings, rule);
        if (verdict.outcome == Outcome::not_certifiable || !verdict.window)
            return {.refusal = reason_words(verdict.reason)};
        const double truth_m_s = true_speed(*verdict.window);
        return {.error = *verdict.speed_m_s - truth_m_s,
                .expanded = *verdict.expanded_uncertainty_m_s,
                .falsely_beaten =
                    verdict_at(attempt, truth_m_s, findings, rule).outcome == Outcome::beaten};
    }

  private:
    double true_speed(const WindowSpan& span) const {
        const auto at = [&](std::int64_t epoch) {
            return motion_.truth[static_cast<std::size_t>(epoch) - 1];
        };
        return (at(span.last_epoch) - at(span.first_epoch)).norm() / span.duration.seconds();
    }
    bool is_fast(std::size_t k) const { return motion_.velocity[k].norm() >= least_fast_m_s_; }

    void measure() {
        EnuTable positions;
        positions.facts = motion_.screened.facts;
        positions.facts.georeferenced = true;
        positions.facts.time_source = "satellites";
        positions.facts.first_epoch = study_start();
        positions.origin = study_origin();
        positions.rows.assign(motion_.screened.rows.begin(), motion_.screened.rows.end());
        for (EnuEpoch& row : positions.rows)
            row.satellites = 14;
        tables_.push_back(std::move(positions));
        const DriftWitnesses& heard = cell_.heard;
        if (heard.receiver)
            tables_.push_back(
                second_receiver_of(motion_, tables_.front(), position_wander_m, random_));
        add_drift();
        if (heard.velocities) add_velocities();
        if (heard.gates) {
            hand_in("gates", gates_of(motion_, gates_each_m, least_fast_m_s_, random_), handed_in_);
            handed_in_.attempt.gates = GateSeries{.expanded_uncertainty_m = 2.0 * study_gate_m,
                                                  .expanded_uncertainty_s = 2.0 * study_gate_s};
        }
        if (heard.calibrated || heard.wheel) {
            // Without a calibration it counts in another unit.
            const double scale = heard.calibrated ? 1.0 + calibration * random_.normal() : 1.03;
            hand_in("wheel", wheel_of(motion_, scale, tyre_m_s, random_), handed_in_);
            handed_in_.attempt.wheel.emplace();
            if (heard.calibrated)
                handed_in_.attempt.wheel =
                    WheelSeries{.scale = 1.0, .expanded_uncertainty_scale = 2.0 * calibration};
        }
        if (heard.radar) add_radar();
    }

    void add_drift() {
        const double last_s = fast_until_s_ - drift_s;
        const double from_s = fast_from_s_ + (last_s - fast_from_s_) * random_.uniform();
        for (std::size_t k = 0; k < motion_.truth.size(); ++k) {
            const double after_s = static_cast<double>(k) / position_rate_hz - from_s;
            const double lasts_s =
                cell_.while_fast
                    ? (motion_.truth[k] - motion_.truth.front()).norm() / least_fast_m_s_
                    : std::clamp(after_s, 0.0, drift_s);
            const Eigen::Vector2d moved = cell_.drift_m_s * lasts_s * study_direction();
            *tables_.front().rows[k].east_m += moved.x();
            *tables_.front().rows[k].north_m += moved.y();
        }
    }

    void add_velocities() {
        std::vector<EnuEpoch>& rows = tables_.front().rows;
        record_velocities(motion_, doppler_slow_m_s, doppler_m_s, random_, tables_.front());
        for (std::size_t k = 0; k < rows.size(); ++k) {
            EnuEpoch& row = rows[k];
            row.sigma_recorded_velocity_east_m_s = row.sigma_recorded_velocity_north_m_s =
                doppler_m_s;
            *row.recorded_velocity_east_m_s *= cell_.velocity_scale;
            *row.recorded_velocity_north_m_s *= cell_.velocity_scale;
            if (!cell_.differenced || k == 0 || k + 1 == rows.size()) continue;
            const EnuEpoch &before = rows[k - 1], &after = rows[k + 1];
            row.recorded_velocity_east_m_s =
                0.5 * position_rate_hz * (*after.east_m - *before.east_m) +
                cell_.added_m_s * random_.normal();
            row.recorded_velocity_north_m_s =
                0.5 * position_rate_hz * (*after.north_m - *before.north_m) +
                cell_.added_m_s * random_.normal();
        }
    }

    void add_radar() {
        constexpr double shown_m_s = 0.03;  // what one reading scatters by
        const double lasting_m_s = radar_m_s * random_.normal();
        const auto each = static_cast<std::size_t>(std::lround(radar_each_s * position_rate_hz));
        std::vector<SeriesSample>& samples = handed_in_.series["speed_trap"].samples;
        for (std::size_t k = 0; k < motion_.velocity.size(); k += each)
            if (is_fast(k))
                samples.push_back(
                    {.time_s = static_cast<double>(k) / position_rate_hz,
                     .value =
                         motion_.velocity[k].norm() + lasting_m_s + shown_m_s * random_.normal(),
                     .expanded_uncertainty_m_s = 2.0 * std::hypot(radar_m_s, shown_m_s)});
        handed_in_.attempt.speed_trap.emplace();
    }

    const DriftCell& cell_;
    RandomGenerator random_;
    SimulatedRecording motion_;
    double fast_from_s_ = 0.0, fast_until_s_ = 0.0, least_fast_m_s_ = 0.0;
    std::vector<EnuTable> tables_;
    HandedIn handed_in_;
};

std::vector<DriftCell> every_drift_cell() {
    struct Named {
        std::string_view name;
        DriftWitnesses heard;
    };
    const DriftWitnesses all{
        .gates = true, .calibrated = true, .radar = true, .velocities = true, .receiver = true};
    const std::vector<Named> witnesses{{"alone", {}},
                                       {"gates", {.gates = true}},
                                       {"calibrated wheel", {.calibrated = true}},
                                       {"wheel", {.wheel = true}},
                                       {"radar", {.radar = true}},
                                       {"velocities", {.velocities = true}},
                                       {"second receiver", {.receiver = true}},
                                       {"all", all}};
    std::vector<DriftCell> cells;
    for (const auto& [name, heard] : witnesses)
        for (const bool while_fast : {false, true})
            for (const double drift_m_s : {0.0, 0.1, 0.2, 0.4}) {
                if (while_fast && drift_m_s == 0.0) continue;
                cells.push_back(
                    {.name = drift_m_s == 0.0
                                 ? fmt::format("{}, sound", name)
                                 : fmt::format("{}, drift of {:g} m/s {}", name, drift_m_s,
                                               while_fast ? "while fast" : "over 6 s"),
                     .heard = heard,
                     .drift_m_s = drift_m_s,
                     .while_fast = while_fast});
            }
    for (const double percent : {0.5, 1.0, 3.0})
        cells.push_back({.name = fmt::format("velocities {:+g} %", percent),
                         .heard = {.velocities = true},
                         .velocity_scale = 1.0 + percent / 100.0});
    for (const double drift_m_s : {0.0, 0.2})
        for (const double added_m_s : {0.0, 0.03})
            cells.push_back(
                {.name = fmt::format("differences{}{}", added_m_s > 0.0 ? ", 0.03 m/s" : "",
                                     drift_m_s > 0.0 ? ", drift of 0.2 m/s over 6 s" : ", sound"),
                 .heard = {.velocities = true},
                 .drift_m_s = drift_m_s,
                 .differenced = true,
                 .added_m_s = added_m_s});
    return cells;
}

}  // namespace

bool DriftCell::is_seen() const {
    constexpr double per_sigma = 2.8;  // 1.96 and 0.84
    constexpr double typical_m_s = 52.0;
    const double drift = drift_m_s / per_sigma;
    // In positions of some millimetres both are sharper than any drift here.
    if (heard.gates || heard.receiver) return true;
    if (heard.calibrated && drift > calibration * typical_m_s) return true;
    if (heard.radar && drift > radar_m_s) return true;
    return !while_fast && !differenced &&
           (heard.wheel || (heard.velocities && drift > doppler_slow_m_s));
}

const std::vector<DriftCell>& drift_cells() {
    static const std::vector<DriftCell> cells = every_drift_cell();
    return cells;
}

DriftRun certify_drift(const DriftCell& cell, std::uint64_t seed) {
    try {
        return DriftingRun(cell, seed).certify();
    } catch (const Failure& failure) {
        return {.refusal = reason_words(failure.what())};
    }
}

std::string DriftSummary::misses(const DriftCell& cell) const {
    if (certified == 0 || (cell.drift_m_s != 0.0 && !cell.is_seen())) return {};
    std::vector<std::string> all;
    const bool sound = cell.drift_m_s == 0.0;
    if (held < (sound ? 0.94 : 0.90)) all.push_back(fmt::format("{:.0f} % inside", 100.0 * held));
    if (sound && falsely_beaten > 0.025)
        all.push_back(fmt::format("{:.0f} % falsely beaten", 100.0 * falsely_beaten));
    if (sound && std::abs(mean_error) > 0.3 * mean_expanded)
        all.push_back(fmt::format("mean error {:+.2f} U", mean_error / mean_expanded));
    return fmt::format("{}", fmt::join(all, ", "));
}

DriftSummary study_drift(const DriftCell& cell, std::int64_t runs, std::uint64_t seed,
                         unsigned threads) {
    DriftSummary summary{.runs = runs};
    for (const DriftRun& run : results_of(runs, threads, [&](std::int64_t i) {
             return certify_drift(cell, seed * 9'000'011 + static_cast<std::uint64_t>(i));
         })) {
        if (!run.refusal.empty()) {
            ++summary.refusals[run.refusal];
            continue;
        }
        ++summary.certified;
        summary.held += std::abs(run.error) <= run.expanded ? 1.0 : 0.0;
        summary.falsely_beaten += run.falsely_beaten ? 1.0 : 0.0;
        summary.mean_error += run.error;
        summary.mean_expanded += run.expanded;
    }
    if (summary.certified == 0) return summary;
    for (double* const sum :
         {&summary.held, &summary.falsely_beaten, &summary.mean_error, &summary.mean_expanded})
        *sum /= static_cast<double>(summary.certified);
    return summary;
}

std::string drift_heading() {
    return fmt::format("{:48} {:>11} {:>7} {:>7} {:>7} {:>10} {:>9} {:>6}\n", "", "certified",
                       "refused", "inside", "beaten", "error of U", "U, km/h", "drift");
}

std::string drift_lines(const DriftCell& cell, const DriftSummary& summary) {
    const auto of_runs = static_cast<double>(summary.certified) / static_cast<double>(summary.runs);
    std::string text = fmt::format(
        "{:48} {:4} of {:<4} {:6.2f} {:7.3f} {:7.3f} {:+10.2f} {:9.3f} {:>6}\n", cell.name,
        summary.certified, summary.runs, 1.0 - of_runs, summary.held, summary.falsely_beaten,
        summary.mean_expanded > 0.0 ? summary.mean_error / summary.mean_expanded : 0.0,
        3.6 * summary.mean_expanded,
        cell.drift_m_s == 0.0 ? ""
        : cell.is_seen()      ? "seen"
                              : "unseen");
    for (const auto& [reason, count] : summary.refusals)
        text += fmt::format("{:>53} refused: {}\n", count, reason);
    return text;
}

}  // namespace runcert
