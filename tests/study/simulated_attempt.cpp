#include "simulated_attempt.h"

#include <cmath>

#include "answered.h"
#include "motion/chain.h"
#include "schemas/windows/windows.h"
#include "stages/check/decision.h"
#include "stages/smooth/smooth.h"
#include "stages/window/position_speed.h"
#include "study_witnesses.h"
#include "supposed_errors.h"
#include "witness/arcs.h"
#include "witness/evidence.h"

namespace runcert {
namespace {

constexpr double rate_hz = 10.0;
constexpr double duration_of_window_s = 3.0;
constexpr double speed_kept_m_s = 60.0, standing_s = 4.0;
constexpr double acceleration_m_s2 = 4.0, rounding_s = 2.0;
// What is stated of each, or what the program takes it to err by. Of gates both are the same: that
// they agree with the positions too well is a sign that they were made from them.
constexpr double slow_m = 0.02, slow_tau_s = 5.0;
constexpr double common_m = 0.010, common_tau_s = 20.0;  // of positions and phases
constexpr double velocity_slow_m_s = 0.03;
constexpr double wheel_noise_m_s = 0.05, wheel_scale = 2e-4;
constexpr double gates_apart_m = 60.0;

/// Along a straight line, to the top speed, which it keeps, and back.
SimulatedRecording motion_of(const WitnessCell& cell, std::uint64_t seed) {
    auto script = std::make_shared<MotionScript>();
    script->add(standing_s)
        .change_speed(speed_kept_m_s, acceleration_m_s2, rounding_s)
        .add(duration_of_window_s * cell.rivals + 0.2)
        .change_speed(-speed_kept_m_s, acceleration_m_s2, rounding_s)
        .add(standing_s);
    StudyRun run{.rate_hz = rate_hz, .length_s = script->duration_s(), .jerk_density = 0.0};
    run.noise.white_m = study_white_m;
    run.script = std::move(script);
    return simulate_recording(run, seed);
}

void move(EnuEpoch& row, const Eigen::Vector2d& by_m) {
    *row.east_m += by_m.x();
    *row.north_m += by_m.y();
}

}  // namespace

SimulatedAttempt::SimulatedAttempt(const WitnessCell& cell, std::uint64_t seed)
    : cell_(cell), random_(seed), motion_(motion_of(cell, seed + 1)) {
    positions_ = to_be_screened(motion_.screened);
    positions_.facts.georeferenced = true;
    positions_.facts.time_source = "satellites";
    positions_.facts.first_epoch = study_start();
    positions_.origin = study_origin();
    const double common = cell.part * common_m, slow = cell.part * slow_m;
    SlowError shared(common, common_tau_s, rate_hz, random_);
    SlowError own(std::sqrt(slow * slow - common * common), slow_tau_s, rate_hz, random_);
    for (EnuEpoch& row : positions_.rows) {
        common_.push_back(shared.next());
        move(row, common_.back() + own.next());
    }
}

void SimulatedAttempt::add_fault(std::size_t first, double rate_m_s) {
    for (std::size_t k = first; k < positions_.rows.size(); ++k)
        move(positions_.rows[k],
             rate_m_s * std::min(duration_of_window_s, static_cast<double>(k - first) / rate_hz) *
                 study_direction());
}

std::size_t SimulatedAttempt::any_window(RandomGenerator& random) const {
    if (cell_.rivals == 1) return static_cast<std::size_t>(best_->span.first_epoch) - 1;
    const double from_s = standing_s + speed_kept_m_s / acceleration_m_s2 + rounding_s;
    const double at_s = from_s + duration_of_window_s * (cell_.rivals - 1) * random.uniform();
    return static_cast<std::size_t>(std::lround(at_s * rate_hz));
}

StudyPhases SimulatedAttempt::phases() {
    std::vector<SimulatedEpoch> epochs(motion_.truth.size());
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        epochs[k].epoch = static_cast<std::int64_t>(k) + 1;
        epochs[k].time_ms = positions_.rows[k].time.nanoseconds / 1'000'000;
        epochs[k].true_enu_m.head<2>() = motion_.truth[k] + common_[k];
    }
    return study_phases(epochs, 0.001, 0.0, random_.next(), positions_);
}

WitnessedRun SimulatedAttempt::judged(StudyHeard heard, double limit_m_s) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    std::vector<EnuTable> tables{positions_};
    WitnessRecords beside;
    std::optional<PhaseWitness<2>> phase_motion;
    const ScreenConfig screening = study_screen_config();
    const auto velocities = [&](double noise_m_s) {
        record_velocities(motion_, cell_.part * velocity_slow_m_s, noise_m_s, random_,
                          tables.front());
    };
    if (heard == StudyHeard::fine_velocities) velocities(0.05);
    if (heard == StudyHeard::coarse_velocities) velocities(0.3);
    if (heard == StudyHeard::receiver)
        tables.push_back(second_receiver_of(motion_, positions_, cell_.part * slow_m, random_));
    if (heard == StudyHeard::wheel) {
        const double scale = 1.0 + cell_.part * wheel_scale * random_.normal();
        hand_in("wheel", wheel_of(motion_, scale, wheel_noise_m_s, random_), beside.handed_in);
        beside.handed_in.attempt.wheel =
            WheelSeries{.scale = 1.0, .expanded_uncertainty_scale = 2.0 * wheel_scale};
    }
    if (heard == StudyHeard::gates) {
        hand_in("gates", gates_of(motion_, gates_apart_m, 0.5 * speed_kept_m_s, random_),
                beside.handed_in);
        beside.handed_in.attempt.gates = GateSeries{.expanded_uncertainty_m = 2.0 * study_gate_m,
                                                    .expanded_uncertainty_s = 2.0 * study_gate_s};
    }
    if (heard == StudyHeard::phases) {
        const StudyPhases of_run = phases();
        beside.phases = of_run.phases;
        beside.first_of_phases = of_run.first_epoch;
        phase_motion =
            phase_witness<2>(of_run.phases, of_run.first_epoch, positions_.facts.first_epoch,
                             positions_.origin, screening.jerk_density);
    }
    std::vector<ScreeningWitnesses> to_screen(tables.size());
    to_screen.front() = {.phases = phase_motion ? &*phase_motion : nullptr,
                         .handed_in = beside.handed_in};
    const std::vector<ScreenedTable> screened = screen_receivers(tables, screening, to_screen);
    const auto smoothed = [](const ScreenedTable& table) {
        return smooth_trajectory(table, smooth_config(study_attempt()));
    };
    trajectory_ = smoothed(screened.front());
    screened_ = screened.front();
    std::optional<TrajectoryTable> second;
    if (screened.size() > 1) {
        second = smoothed(screened.back());
        beside.receivers.push_back({.screened = &screened.back(), .trajectory = &*second});
    }
    WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
    // The draws check the budget, which does not rest on them.
    config.monte_carlo_trials_max = 100'000;
    const Windows windows = test::answered(
        find_windows(screened_, trajectory_, {profile}, config, std::nullopt, beside));
    best_ = windows.profiles.front().best;
    WitnessedRun run;
    if (!best_) return run;
    run.certified = std::ranges::none_of(best_->witnesses, &contradicts) &&
                    best_->evidence->disagreement <= 1.0;
    const auto at = [&](std::int64_t epoch) {
        return motion_.truth[static_cast<std::size_t>(epoch) - 1];
    };
    const double true_m_s = (at(best_->span.last_epoch) - at(best_->span.first_epoch)).norm() /
                            best_->span.duration.seconds();
    run.error_m_s = best_->speed_m_s - true_m_s;
    run.expanded_m_s = expanded_uncertainty_by_rule_m_s(*best_, profile.coverage_factor);
    const SpeedPosterior speed = *figure_of(windows.profiles.front());
    run.probability = conformance_probability(speed, {.speed_m_s = true_m_s - limit_m_s});
    run.tail_m_s =
        speed.speed_m_s + speed.bias_limit_m_s -
        mixture_of(*speed.evidence, speed.speed_m_s, WitnessSet::observed).quantile(1e-4);
    return run;
}

SimulatedAttempt::Optimum SimulatedAttempt::optimum() const {
    EstimationModel known = model_of(noise_of<2>(trajectory_));
    known.measurement_scale = 1.0;
    known.error = GaussMarkovError::steady(cell_.part * slow_m, slow_tau_s);
    const std::vector<Arc<2>> arcs = arcs_of<2>(screened_, trajectory_);
    const auto row_of = [&](std::int64_t epoch) { return static_cast<std::size_t>(epoch) - 1; };
    const Arc<2>& arc = arcs.at(static_cast<std::size_t>(best_->arc) - 1);
    const auto index_of = [&](std::int64_t epoch) {
        return static_cast<std::size_t>(std::ranges::find(arc.rows, row_of(epoch)) -
                                        arc.rows.begin());
    };
    const Chain<2> smoothed = Chain<2>(arc.epochs, known);
    const EstimatedWindow<2> at{
        .epochs = arc.epochs,
        .smoothed = smoothed,
        .model = known,
        .window = {index_of(best_->span.first_epoch), index_of(best_->span.last_epoch)},
        .duration_s = best_->span.duration.seconds()};
    const SpeedQuantity quantity{SpeedDefinition::displacement};
    const SpeedWeights<2> weights = speed_weights(at, quantity);
    const double all_m_s =
        smoothed_speed(smoothed, at.window, at.duration_s, quantity).standard_uncertainty_m_s;
    const double white = weighted_variance<2>(arc.epochs, known.measurement_scale, weights);
    const double slow = weighted_variance<2>(arc.epochs, known.error, weights);
    return {.white_m_s = std::sqrt(white),
            .slow_m_s = std::sqrt(slow),
            .motion_m_s = std::sqrt(std::max(0.0, all_m_s * all_m_s - white - slow))};
}

}  // namespace runcert
