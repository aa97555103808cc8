#include "witness_study.h"

#include <fmt/format.h>

#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "schemas/windows/windows.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "study_phases.h"
#include "supposed_errors.h"

namespace runcert {
namespace {

SimulationSpec salt_lake(std::uint64_t seed) {
    SimulationSpec spec;
    spec.run = {.top_speed_m_s = 64.5, .start_speed_m_s = 0.1, .half_speed_time_s = 25.0};
    spec.duration_ms = 60'000;
    spec.bearing = Angle::from_degrees(160.0);
    spec.place = study_origin().position;
    spec.start = study_start();
    spec.seed = seed;
    spec.white = {.horizontal_m = 0.003, .vertical_m = 0.006};
    spec.correlated = {.horizontal_m = 0.006, .vertical_m = 0.012};
    spec.correlation_time_s = 1.5;
    return spec;
}

void add_common_error(const WitnessStudyOptions& options, std::uint64_t seed,
                      std::vector<SimulatedEpoch>& epochs) {
    RandomGenerator random(seed);
    const double step_s = 0.1;
    const double decay = std::exp(-step_s / options.common_time_s);
    const auto normals = [&] { return Eigen::Vector2d(random.normal(), random.normal()); };
    Eigen::Vector2d error = options.common_m * normals();
    for (SimulatedEpoch& epoch : epochs) {
        epoch.measured_enu_m.head<2>() += error;
        epoch.true_enu_m.head<2>() += error;
        error = decay * error + options.common_m * std::sqrt(1.0 - decay * decay) * normals();
    }
}

EnuTable table_of(const std::vector<SimulatedEpoch>& epochs) {
    EnuTable table;
    table.facts.receiver = "primary";
    table.facts.vertical_measured = false;
    table.facts.georeferenced = true;
    table.facts.nominal_interval_s = 0.1;
    table.facts.time_source = "satellites";
    table.facts.first_epoch = study_start();
    table.origin = study_origin();
    for (const SimulatedEpoch& epoch : epochs) {
        EnuEpoch& row = table.rows.emplace_back();
        row.epoch = epoch.epoch;
        row.time = {epoch.time_ms * 1'000'000};
        row.east_m = epoch.measured_enu_m.x();
        row.north_m = epoch.measured_enu_m.y();
        row.sigma_east_m = row.sigma_north_m = 0.010;
        row.fix = FixType::fixed;
    }
    return table;
}

WitnessedRun judged(const CertifiableWindow& best, const std::vector<SimulatedEpoch>& truth,
                    double coverage_factor) {
    const auto at = [&](std::int64_t epoch) {
        return truth[static_cast<std::size_t>(epoch) - 1].true_enu_m;
    };
    const double true_m_s = (at(best.span.last_epoch) - at(best.span.first_epoch)).norm() /
                            best.span.duration.seconds();
    return {.error_m_s = best.speed_m_s - true_m_s,
            .expanded_m_s = expanded_uncertainty_by_rule_m_s(best, coverage_factor)};
}

WitnessStudyRun run_once(const WitnessStudyOptions& options, std::uint64_t seed) {
    static const Profile profile = read_profile(builtin_profile("nalsa"), "nalsa");
    const std::vector<SimulatedEpoch> truth = simulate(salt_lake(seed));
    std::vector<SimulatedEpoch> epochs = truth;
    add_common_error(options, seed + 1'000'000'007, epochs);
    const EnuTable measured = table_of(epochs);
    const StudyPhases phases = study_phases(epochs, 0.001, 0.0, seed, measured);
    const ScreenConfig screen_config = study_screen_config();
    const auto witness =
        phase_witness<2>(phases.phases, phases.first_epoch, measured.facts.first_epoch,
                         measured.origin, screen_config.jerk_density);
    const WindowConfig config = window_config(study_attempt(), study_attempt().receivers.front());
    const auto best = [&](const Witness<2>* heard, const Beside& beside) {
        const ScreenedTable screened = screen(measured, screen_config, {.phases = heard});
        const TrajectoryTable trajectory =
            smooth_trajectory(screened, smooth_config(study_attempt()));
        return find_windows(screened, trajectory, {profile}, config, std::nullopt, beside)
            .profiles.front()
            .best.value();
    };
    const double factor = profile.coverage_factor;
    WitnessStudyRun run;
    run.alone = judged(best(nullptr, {}), truth, factor);
    const CertifiableWindow with =
        best(&*witness, {.phases = phases.phases, .first_of_phases = phases.first_epoch});
    run.beside = judged(with, truth, factor);
    run.refused = with.witnesses.empty() || with.witnesses.front().normalised_error > 1.0;
    return run;
}

std::string line(const char* name, const std::vector<WitnessStudyRun>& runs,
                 WitnessedRun WitnessStudyRun::*which) {
    double expanded = 0.0, largest = 0.0;
    std::int64_t held = 0;
    for (const WitnessStudyRun& run : runs) {
        const WitnessedRun& one = run.*which;
        expanded += one.expanded_m_s / static_cast<double>(runs.size());
        largest = std::max(largest, std::abs(one.error_m_s));
        held += std::abs(one.error_m_s) <= one.expanded_m_s ? 1 : 0;
    }
    return fmt::format("{:<24} {:8.1f} % {:10.3f} {:14.3f}\n", name,
                       100.0 * static_cast<double>(held) / static_cast<double>(runs.size()),
                       3.6 * expanded, 3.6 * largest);
}

}  // namespace

std::vector<WitnessStudyRun> study_witness(const WitnessStudyOptions& options) {
    return results_of(options.runs, options.threads, [&](std::int64_t i) {
        return run_once(options, options.seed * 1'000'003 + static_cast<std::uint64_t>(i));
    });
}

std::string witness_table(const WitnessStudyOptions& options,
                          const std::vector<WitnessStudyRun>& runs) {
    std::int64_t refused = 0;
    for (const WitnessStudyRun& run : runs)
        refused += run.refused ? 1 : 0;
    return fmt::format("{} runs, common error {} m over {} s; contradicted {}\n", runs.size(),
                       options.common_m, options.common_time_s, refused) +
           fmt::format("{:<24} {:>10} {:>10} {:>14}\n", "", "held", "U, km/h", "error, km/h") +
           line("positions alone", runs, &WitnessStudyRun::alone) +
           line("with phases", runs, &WitnessStudyRun::beside);
}

}  // namespace runcert
