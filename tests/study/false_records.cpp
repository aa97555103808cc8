#include "false_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "answered.h"
#include "core/failure.h"
#include "core/parallel.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_phases.h"

namespace runcert {
namespace {

constexpr double far_m_s = 0.8 / 3.6;
constexpr double earliest_error_s = 10.0;

double log_uniform(double least, double most, RandomGenerator& random) {
    return least * std::pow(most / least, random.uniform());
}

std::int64_t one_to(std::int64_t most, RandomGenerator& random) {
    return 1 + static_cast<std::int64_t>(random.uniform() * static_cast<double>(most));
}

ErrorScenario random_scenario(double rate_hz, RandomGenerator& random) {
    switch (one_to(5, random)) {
        case 1:
            return {.kind = Hypothesis::outlier,
                    .size = log_uniform(3.0, 100.0, random),
                    .errors = one_to(5, random)};
        case 2:
            return {.kind = Hypothesis::burst,
                    .epochs = 1 + static_cast<std::size_t>(one_to(19, random)),
                    .size = log_uniform(3.0, 100.0, random)};
        case 3:
            return {.kind = Hypothesis::step,
                    .size = log_uniform(3.0, 300.0, random),
                    .errors = one_to(5, random)};
        case 4:
            return {.kind = Hypothesis::ramp, .size = log_uniform(0.02, 2.0, random)};
        default:
            return {.kind = Hypothesis::time_shift,
                    .size = random.uniform() < 0.5 ? 0.02 : 1.0 / rate_hz};
    }
}

std::vector<SupposedError> random_errors(const StudyRun& run, RandomGenerator& random) {
    const double last_s = run.length_s - 1.0;
    const ErrorScenario scenario = random_scenario(run.rate_hz, random);
    std::vector<SupposedError> errors;
    for (std::int64_t i = 0; i < scenario.errors; ++i) {
        const double at_s = earliest_error_s + (last_s - earliest_error_s) * random.uniform();
        const auto first = static_cast<std::size_t>(std::lround(at_s * run.rate_hz));
        errors.push_back(random_error(scenario, run.noise, first, random));
        SupposedError& error = errors.back();
        const auto rows = static_cast<std::size_t>(std::lround(run.length_s * run.rate_hz)) + 1;
        error.epochs = std::min(error.epochs, rows - first);
    }
    return errors;
}

double late_at(const std::vector<SupposedError>& errors, std::size_t k) {
    double late_s = 0.0;
    for (const SupposedError& error : errors)
        if (k >= error.first) late_s += error.late_s;
    return late_s;
}

/// What the craft truly did from the first epoch of the window to its last, when these were truly
/// measured.
double true_speed(const SimulatedRecording& recording, const std::vector<SupposedError>& errors,
                  const WindowSpan& span) {
    const auto first = static_cast<std::size_t>(span.first_epoch) - 1;
    const auto last = static_cast<std::size_t>(span.last_epoch) - 1;
    const double first_late_s = late_at(errors, first);
    const double last_late_s = late_at(errors, last);
    return (true_position(recording, last, last_late_s) -
            true_position(recording, first, first_late_s))
               .norm() /
           (span.duration.seconds() - last_late_s + first_late_s);
}

/// Velocities, wrong in nothing but their stamps.
void record_velocities(const SimulatedRecording& recording,
                       const std::vector<SupposedError>& errors, double noise_m_s,
                       RandomGenerator& random, EnuTable& measured) {
    for (std::size_t k = 0; k < measured.rows.size(); ++k) {
        const Eigen::Vector2d velocity =
            recording.velocity[k] - late_at(errors, k) * recording.acceleration[k];
        measured.rows[k].recorded_velocity_east_m_s = velocity.x() + noise_m_s * random.normal();
        measured.rows[k].recorded_velocity_north_m_s = velocity.y() + noise_m_s * random.normal();
    }
}

void judge_window(const CertifiableWindow& best, const EstimationSummary& estimation,
                  const Profile& profile, double true_m_s, CertifiedRun& run) {
    run.error_m_s = best.speed_m_s - true_m_s;
    run.expanded_m_s = expanded_uncertainty_by_rule_m_s(best, profile.coverage_factor);
    for (const UndetectedError& error : best.reliability)
        run.undetected_m_s = std::max(run.undetected_m_s, error.speed_m_s);
    run.first_epoch = best.span.first_epoch;
    for (const WitnessedSpeed& one : best.witnesses)
        run.witnesses +=
            fmt::format("; {} {:+.3f} +-{:.3f} km/h, E_n {:.2f}, share {:.2f}", to_text(one.kind),
                        -3.6 * one.difference_m_s, 7.2 * one.standard_uncertainty_m_s,
                        one.normalised_error, one.share);
    using Outcome = CertifiedRun::Outcome;
    const bool robust_agrees = best.robust ? best.robust->agrees : estimation.robust_unsolved == 0;
    const bool contradicted = std::ranges::any_of(best.witnesses, &contradicts);
    run.outcome = !robust_agrees ? Outcome::robust_refused
                  : contradicted ? Outcome::witness_refused
                  : run.expanded_m_s > profile.accuracy_limit_m_s.value()
                      ? Outcome::accuracy_refused
                      : Outcome::certified;
}

/// The motion as a simulation of raw measurements takes it.
std::vector<SimulatedEpoch> true_epochs(const SimulatedRecording& recording) {
    std::vector<SimulatedEpoch> epochs(recording.truth.size());
    for (std::size_t k = 0; k < epochs.size(); ++k) {
        epochs[k].epoch = static_cast<std::int64_t>(k) + 1;
        epochs[k].time_ms = recording.screened.rows[k].time.nanoseconds / 1'000'000;
        epochs[k].true_enu_m.head<2>() = recording.truth[k];
    }
    return epochs;
}

/// Where the craft points: along its way at speed; while it hardly moves, much as the whole run
/// goes.
Eigen::Vector2d heading_of(const Eigen::Vector2d& velocity) {
    constexpr double slow_m_s = 5.0;
    const Eigen::Vector2d of_run = Eigen::Vector2d::Constant(1.0).normalized();
    return (velocity + slow_m_s * of_run).normalized();
}

/// Another receiver a metre from the first on the craft, with noise of its own.
EnuTable second_receiver(const SimulatedRecording& recording, const StudyNoise& noise,
                         RandomGenerator& random) {
    EnuTable table = to_be_screened(recording.screened);
    table.facts.receiver = "second";
    table.facts.first_epoch = study_start();
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const Eigen::Vector2d track = heading_of(recording.velocity[k]);
        const Eigen::Vector2d antenna =
            recording.truth[k] - 0.9 * track + 0.4 * Eigen::Vector2d(-track.y(), track.x());
        table.rows[k].east_m = antenna.x() + noise.white_m * random.normal();
        table.rows[k].north_m = antenna.y() + noise.white_m * random.normal();
    }
    return table;
}

/// Smoothing and window search.
void certify(const ScreenedTable& screened, const SimulatedRecording& recording,
             const Profile& profile, const WitnessRecords& beside, CertifiedRun& run) {
    const TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(study_attempt()));
    WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
    // The draws check the budget, which does not rest on them.
    config.monte_carlo_trials_max = 100'000;
    const Windows windows =
        test::answered(find_windows(screened, trajectory, {profile}, config, std::nullopt, beside));
    if (const auto& best = windows.profiles.front().best)
        judge_window(*best, trajectory.estimation, profile,
                     true_speed(recording, run.errors, best->span), run);
}

std::string kind_of(const CertifiedRun& run) {
    return run.errors.empty() ? "none" : std::string(to_text(run.errors.front().kind));
}

struct KindCount {
    std::int64_t runs = 0, no_window = 0, robust = 0, witness = 0, accuracy = 0, failed = 0;
    std::int64_t certified = 0, missed = 0, wrong = 0, far = 0, unstated = 0;
    double largest_m_s = 0.0;

    void add(const CertifiedRun& run) {
        using Outcome = CertifiedRun::Outcome;
        ++runs;
        if (run.outcome == Outcome::no_window) ++no_window;
        if (run.outcome == Outcome::robust_refused) ++robust;
        if (run.outcome == Outcome::witness_refused) ++witness;
        if (run.outcome == Outcome::accuracy_refused) ++accuracy;
        if (run.outcome == Outcome::failed) ++failed;
        if (run.outcome != Outcome::certified) return;
        ++certified;
        if (run.missed()) ++missed;
        if (run.wrong()) ++wrong;
        if (run.far_off()) ++far;
        if (run.unstated()) ++unstated;
        largest_m_s = std::max(largest_m_s, std::abs(run.error_m_s));
    }
    std::string line(const std::string& name) const {
        return fmt::format(
            "{:<11} {:6} {:10} {:7} {:8} {:9} {:7} {:10} {:8} {:12} {:11} {:9} {:9.3f}\n", name,
            runs, no_window, robust, witness, accuracy, failed, certified, missed, wrong, far,
            unstated, largest_m_s * 3.6);
    }
};

std::string size_of(const SupposedError& error) {
    if (error.kind == Hypothesis::time_shift) return fmt::format("{:+.3f} s", error.late_s);
    const bool ramp = error.kind == Hypothesis::ramp;
    return fmt::format("{:.3f} {} at {:.0f} deg", error.size.norm(), ramp ? "m/s" : "m",
                       std::atan2(error.size.x(), error.size.y()) * 180.0 / std::numbers::pi);
}

}  // namespace

bool CertifiedRun::missed() const {
    return outcome == Outcome::certified && std::abs(error_m_s) > expanded_m_s;
}

bool CertifiedRun::far_off() const {
    return missed() && std::abs(error_m_s) > far_m_s;
}

bool CertifiedRun::wrong() const {
    constexpr double negligible_m_s = 0.05 / 3.6;
    return missed() && std::abs(error_m_s) > expanded_m_s + negligible_m_s;
}

bool CertifiedRun::unstated() const {
    return missed() && std::abs(error_m_s) > expanded_m_s + undetected_m_s;
}

CertifiedRun certify_run(std::uint64_t seed, const StudyWitness& witness) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    RandomGenerator random(seed);
    const std::vector<StudyRun> cells = screening_cells();
    StudyRun cell = cells[static_cast<std::size_t>(one_to(std::ssize(cells), random)) - 1];
    cell.length_s = 44.0 + static_cast<double>(one_to(16, random));
    cell.jerk_density = random.uniform() < 0.5 ? 0.0 : 0.6;
    const SimulatedRecording recording = simulate_recording(cell, random.next());
    CertifiedRun run;
    run.seed = seed;
    run.cell = cell_name(cell);
    run.length_s = cell.length_s;
    run.jerk_density = cell.jerk_density;
    if (random.uniform() > 1.0 / 6.0) run.errors = random_errors(cell, random);

    EnuTable measured = to_be_screened(with_errors(recording, run.errors));
    if (witness.velocity_noise_m_s)
        record_velocities(recording, run.errors, *witness.velocity_noise_m_s, random, measured);
    WitnessRecords beside;
    std::optional<PhaseWitness<2>> phases;
    if (witness.phases || witness.receiver) measured.facts.first_epoch = study_start();
    if (witness.phases) {
        measured.facts.georeferenced = true;
        measured.origin = study_origin();
        const StudyPhases of_run =
            study_phases(true_epochs(recording), 0.0012, 0.0, random.next(), measured);
        beside.phases = of_run.phases;
        beside.first_of_phases = of_run.first_epoch;
        phases = phase_witness<2>(of_run.phases, of_run.first_epoch, measured.facts.first_epoch,
                                  measured.origin, study_screen_config().jerk_density);
    }
    std::vector<EnuTable> tables{std::move(measured)};
    if (witness.receiver) tables.push_back(second_receiver(recording, cell.noise, random));
    std::vector<ScreeningWitnesses> heard(tables.size());
    heard.front().phases = phases ? &*phases : nullptr;
    const std::vector<ScreenedTable> screened =
        screen_receivers(tables, study_screen_config(), heard);
    if (summarise(screened.front().rows).usable == 0) return run;
    try {
        std::optional<TrajectoryTable> second;
        if (witness.receiver) {
            second = smooth_trajectory(screened.back(), smooth_config(study_attempt()));
            beside.receivers.push_back({.screened = &screened.back(), .trajectory = &*second});
        }
        certify(screened.front(), recording, profile, beside, run);
    } catch (const Failure& failure) {
        run.outcome = CertifiedRun::Outcome::failed;
        run.failure = failure.what();
    }
    return run;
}

std::vector<CertifiedRun> study_false_records(const FalseRecordOptions& options) {
    if (options.only) return {certify_run(*options.only, options.witness)};
    return results_of(options.runs, options.threads, [&](std::int64_t i) {
        return certify_run(options.seed * 4'000'037 + static_cast<std::uint64_t>(i),
                           options.witness);
    });
}

std::string run_line(const CertifiedRun& run) {
    std::string text = fmt::format(
        "  seed {}: {}, {:g} s, jerk {:g}; {:+.3f} km/h, stated +-{:.3f}, undetected {:.3f}; "
        "window "
        "from epoch {}{}\n",
        run.seed, run.cell, run.length_s, run.jerk_density, run.error_m_s * 3.6,
        run.expanded_m_s * 3.6, run.undetected_m_s * 3.6, run.first_epoch, run.witnesses);
    for (const SupposedError& error : run.errors)
        text += fmt::format("    {} of {} from epoch {}, {} epochs\n", to_text(error.kind),
                            size_of(error), error.first + 1, error.epochs);
    return text;
}

std::string false_records_table(const std::vector<CertifiedRun>& runs) {
    constexpr std::size_t shown = 20;
    std::map<std::string, KindCount> by_kind;
    KindCount all;
    std::vector<const CertifiedRun*> worst;
    std::string failures;
    for (const CertifiedRun& run : runs) {
        by_kind[kind_of(run)].add(run);
        all.add(run);
        if (run.missed()) worst.push_back(&run);
        if (!run.failure.empty()) failures += fmt::format("  seed {}: {}\n", run.seed, run.failure);
    }
    std::string text =
        "                              refused by                           of these the interval "
        "misses the truth\n"
        "errors        runs  no window  robust  witness  accuracy  failed  certified      all  "
        "> 0.05 km/h  > 0.8 km/h  unstated  "
        "largest error, km/h\n";
    for (const auto& [kind, count] : by_kind)
        text += count.line(kind);
    text += all.line("all");
    std::stable_sort(worst.begin(), worst.end(), [](const auto* a, const auto* b) {
        return std::abs(a->error_m_s) - a->expanded_m_s > std::abs(b->error_m_s) - b->expanded_m_s;
    });
    if (!failures.empty()) text += "Failed:\n" + failures;
    if (!worst.empty()) text += "Furthest off:\n";
    for (std::size_t i = 0; i < std::min(shown, worst.size()); ++i)
        text += run_line(*worst[i]);
    return text;
}

}  // namespace runcert
