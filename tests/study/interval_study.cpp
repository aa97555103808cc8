#include "interval_study.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "core/failure.h"
#include "core/parallel.h"
#include "core/random.h"
#include "simulated_arc.h"
#include "stages/check/decision.h"
#include "stages/screen/screen.h"
#include "stages/smooth/smooth.h"
#include "stages/window/window.h"
#include "supposed_errors.h"
#include "witness/arcs.h"

namespace runcert {
namespace {

constexpr double interval_rate_hz = 10.0;
constexpr double float_stated_m = 0.15;

const Attempt& interval_attempt() {
    static const Attempt attempt = read_attempt(
        "schema: attempt/1.0\nid: interval\ncraft: {name: interval, class: land-yacht}\n"
        "receivers: [{id: primary, recording: none}]\nprofiles: [nalsa]\n"
        "parameters: {window: {monte_carlo_trials_max: 100000}}\n",
        "interval");
    return attempt;
}

std::vector<Profile> interval_rules(bool vertical) {
    std::vector<Profile> rules;
    for (const double length_s : interval_lengths_s) {
        Profile& rule = rules.emplace_back(read_profile(builtin_profile("nalsa"), "nalsa"));
        rule.id = fmt::format("over {:g} s", length_s);
        rule.duration_s = length_s;
        rule.accuracy_limit_m_s.reset();
        if (vertical) rule.dimension = Dimension::vertical;
    }
    return rules;
}

/// The fast stretch, s of the script.
struct FastRun {
    MotionScript script;
    double middle_s = 0.0;
};
FastRun fast_run() {
    constexpr double fast_s = 14.0, fast_m_s = 50.0;
    FastRun run;
    run.script.add(8.0).change_speed(fast_m_s, 4.0, 1.0);
    run.middle_s = run.script.duration_s() + 0.5 * fast_s;
    run.script.add(fast_s).change_speed(-fast_m_s, 4.0, 1.0).add(8.0);
    return run;
}

/// The sum of such errors at every epoch. Of those whose correlation times take turns, one turn
/// begins in the middle of the fast stretch.
std::vector<double> drawn(const std::vector<StudySlowError>& errors, std::size_t epochs,
                          double middle_s, RandomGenerator& random) {
    constexpr double step_s = 1.0 / interval_rate_hz;
    std::vector<double> sum(epochs, 0.0);
    for (const StudySlowError& one : errors) {
        double error_m = one.sigma_m * random.normal();
        for (std::size_t k = 0; k < epochs; ++k) {
            const double turns =
                std::floor((static_cast<double>(k) * step_s - middle_s) / one.turn_s + 1e-9);
            const auto count = static_cast<double>(one.tau_s.size());
            const auto turn =
                std::isinf(one.turn_s)
                    ? std::size_t{0}
                    : static_cast<std::size_t>(turns + count * 1000.0 - 1.0) % one.tau_s.size();
            const double decay = std::exp(-step_s / one.tau_s[turn]);
            if (k > 0)
                error_m = decay * error_m +
                          one.sigma_m * std::sqrt(1.0 - decay * decay) * random.normal();
            sum[k] += error_m;
        }
    }
    return sum;
}

/// The recording of a cell: the true run, and errors put on it.
SimulatedRecording recording_of(const IntervalCell& cell, std::uint64_t seed) {
    const FastRun fast = fast_run();
    StudyRun run{.rate_hz = interval_rate_hz,
                 .length_s = std::floor(fast.script.duration_s()),
                 .jerk_density = 0.0};
    run.noise = {.white_m = cell.white_m, .fix = cell.fix};
    run.script = std::make_shared<const MotionScript>(fast.script);
    SimulatedRecording recording = simulate_recording(run, seed);
    std::vector<ScreenedEpoch>& rows = recording.screened.rows;
    RandomGenerator random(seed ^ 0x51043);
    const auto east = drawn(cell.slow, rows.size(), fast.middle_s, random);
    const auto north =
        drawn(cell.north.empty() ? cell.slow : cell.north, rows.size(), fast.middle_s, random);
    const auto of_float =
        drawn({{.sigma_m = float_stated_m, .tau_s = {5.0}}}, rows.size(), fast.middle_s, random);
    const double phase = random.uniform();
    for (std::size_t k = 0; k < rows.size(); ++k) {
        ScreenedEpoch& row = rows[k];
        const double time_s = row.time.seconds();
        const double wave = std::sin(2.0 * std::numbers::pi * (time_s / cell.wave_s + phase));
        const double along_m = cell.wave_m * (cell.square_wave ? std::copysign(1.0, wave) : wave) /
                               std::numbers::sqrt2;
        double floating_m = 0.0;
        row.sigma_east_m = row.sigma_north_m = cell.stated_m;
        if (cell.floats && time_s >= fast.middle_s) {
            row.fix = FixType::float_ambiguities;
            row.sigma_east_m = row.sigma_north_m = float_stated_m;
            floating_m = of_float[k];
        }
        if (cell.vertical) {
            constexpr double from_m = 4000.0;
            const double fallen_m = (recording.truth[k] - recording.truth[0]).norm();
            row.up_m = from_m - fallen_m + cell.white_m * random.normal() + east[k];
            row.sigma_up_m = cell.stated_m;
            row.east_m = cell.white_m * random.normal();
            row.north_m = cell.white_m * random.normal();
            continue;
        }
        *row.east_m += east[k] + along_m + floating_m;
        *row.north_m += north[k] + along_m + floating_m;
    }
    recording.screened.facts.vertical_measured = cell.vertical;
    recording.screened.facts.time_source = "satellites";
    return recording;
}

/// Twice the uncertainty of the smoother with the true errors and the fitted motion.
template <int Axes>
double ideal_of(const IntervalCell& cell, const ScreenedTable& screened,
                const TrajectoryTable& trajectory, const CertifiableWindow& window) {
    const bool known = cell.slow.size() <= 1 && cell.north.empty() && cell.wave_m == 0.0 &&
                       !cell.floats && (cell.slow.empty() || cell.slow[0].tau_s.size() == 1);
    if (!known) return 0.0;
    EstimationModel model = model_of(Axes == 1 ? trajectory.estimation.vertical.value().noise
                                               : trajectory.estimation.horizontal.noise);
    model.measurement_scale = cell.white_m / cell.stated_m;
    model.error = cell.slow.empty()
                      ? GaussMarkovError::steady(0.0, 1.0)
                      : GaussMarkovError::steady(cell.slow[0].sigma_m, cell.slow[0].tau_s[0]);
    for (const Arc<Axes>& arc : arcs_of<Axes>(screened, trajectory)) {
        if (arc.number != window.arc) continue;
        const auto at = [&](std::int64_t epoch) {
            return static_cast<std::size_t>(
                std::ranges::find(arc.rows, static_cast<std::size_t>(epoch) - 1) -
                arc.rows.begin());
        };
        return 2.0 * smoothed_speed(Chain<Axes>(arc.epochs, model),
                                    {at(window.span.first_epoch), at(window.span.last_epoch)},
                                    window.span.duration.seconds(), {})
                         .standard_uncertainty_m_s;
    }
    return 0.0;
}

struct IntervalRun {
    bool certified = false;
    double error = 0.0, expanded = 0.0, by_noise = 0.0, slow = 0.0, ideal = 0.0;
};
using IntervalRuns = std::array<IntervalRun, interval_lengths_s.size()>;

IntervalRuns certify_intervals(const IntervalCell& cell, std::uint64_t seed) {
    const SimulatedRecording recording = recording_of(cell, seed);
    const Attempt& attempt = interval_attempt();
    const std::vector<Profile> rules = interval_rules(cell.vertical);
    ScreenConfig config = screen_config(attempt);
    config.counted_fixes.insert(cell.fix);
    config.counted_fixes.insert(FixType::float_ambiguities);
    IntervalRuns runs;
    try {
        const ScreenedTable screened = screen(to_be_screened(recording.screened), config);
        const TrajectoryTable trajectory = smooth_trajectory(screened, smooth_config(attempt));
        WindowConfig window_of = window_config(attempt, attempt.receivers.front());
        window_of.plane_scale_bound = 0.0;
        const Windows windows = find_windows(screened, trajectory, rules, window_of);
        for (std::size_t i = 0; i < rules.size(); ++i) {
            const auto& best = windows.profiles[i].best;
            if (!best || (best->robust && !best->robust->agrees)) continue;
            const auto truth = [&](std::int64_t epoch) {
                return recording.truth[static_cast<std::size_t>(epoch) - 1];
            };
            const double true_m_s =
                (truth(best->span.last_epoch) - truth(best->span.first_epoch)).norm() /
                best->span.duration.seconds();
            double slow = 0.0, square = 0.0;
            for (const BudgetRow& row : best->budget) {
                if (row.symbol == "b") slow = row.contribution_m_s;
                if (std::string_view("wbjo").find(row.symbol) != std::string_view::npos)
                    square += row.contribution_m_s * row.contribution_m_s;
            }
            runs[i] = {
                .certified = true,
                .error = best->speed_m_s - true_m_s,
                .expanded = expanded_uncertainty_by_rule_m_s(*best, rules[i].coverage_factor),
                .by_noise = 2.0 * std::sqrt(square) + best->bias_limit_m_s,
                .slow = slow,
                .ideal = cell.vertical ? ideal_of<1>(cell, screened, trajectory, *best)
                                       : ideal_of<2>(cell, screened, trajectory, *best)};
        }
    } catch (const Failure& failure) {
        fmt::print(stderr, "{}: {}\n", cell.name, failure.what());
    }
    return runs;
}

}  // namespace

const std::vector<IntervalCell>& interval_cells() {
    static const std::vector<IntervalCell> cells = [] {
        const auto slow = [](double sigma_m, double tau_s) {
            return std::vector<StudySlowError>{{.sigma_m = sigma_m, .tau_s = {tau_s}}};
        };
        const auto turns = [](std::vector<double> tau_s, double turn_s) {
            return std::vector<StudySlowError>{
                {.sigma_m = 0.020, .tau_s = std::move(tau_s), .turn_s = turn_s}};
        };
        std::vector<IntervalCell> all{
            {.name = "white 8 mm", .white_m = 0.008, .stated_m = 0.008},
            {.name = "8 mm 2 s", .slow = slow(0.008, 2.0)},
            {.name = "20 mm 0.5 s", .slow = slow(0.020, 0.5)},
            {.name = "20 mm 1 s", .slow = slow(0.020, 1.0)},
            {.name = "20 mm 2 s", .slow = slow(0.020, 2.0)},
            {.name = "20 mm 5 s", .slow = slow(0.020, 5.0)},
            {.name = "20 mm, 0.5 s then 10 s", .slow = turns({0.5, 10.0}, 100.0)},
            {.name = "20 mm, 10 s then 0.5 s", .slow = turns({10.0, 0.5}, 100.0)},
            {.name = "20 mm, 0.5 s and 10 s in turn, 1 s each", .slow = turns({0.5, 10.0}, 1.0)},
            {.name = "20 mm, 0.5 s and 10 s in turn, 3 s each", .slow = turns({0.5, 10.0}, 3.0)},
            {.name = "14 mm 0.5 s and 14 mm 10 s",
             .slow = {{.sigma_m = 0.0141, .tau_s = {0.5}}, {.sigma_m = 0.0141, .tau_s = {10.0}}}},
            {.name = "20 mm, 0.5 s east, 10 s north",
             .slow = slow(0.020, 0.5),
             .north = slow(0.020, 10.0)},
            {.name = "20 mm, 1 s east, 3 s north",
             .slow = slow(0.020, 1.0),
             .north = slow(0.020, 3.0)},
            {.name = "sine of 20 mm in 6 s", .wave_m = 0.020},
            {.name = "20 mm to and fro in 6 s", .wave_m = 0.020, .square_wave = true},
            {.name = "50 mm 1 s, stated 10 mm", .stated_m = 0.010, .slow = slow(0.050, 1.0)},
            {.name = "50 mm 5 s, stated 10 mm", .stated_m = 0.010, .slow = slow(0.050, 5.0)},
            {.name = "fixed 8 mm 2 s, then float 150 mm 5 s",
             .slow = slow(0.008, 2.0),
             .floats = true},
        };
        for (const auto& [sigma_m, tau_s] :
             {std::pair(0.3, 20.0), std::pair(1.0, 60.0), std::pair(1.5, 200.0)})
            all.push_back({.name = fmt::format("code {:g} m {:g} s", sigma_m, tau_s),
                           .white_m = 0.3,
                           .stated_m = 1.0,
                           .slow = slow(sigma_m, tau_s),
                           .fix = FixType::single});
        all.push_back({.name = "heights 2 m 30 s",
                       .white_m = 0.3,
                       .stated_m = 2.0,
                       .slow = slow(2.0, 30.0),
                       .fix = FixType::single,
                       .vertical = true});
        return all;
    }();
    return cells;
}

std::array<IntervalSummary, interval_lengths_s.size()> study_intervals(const IntervalCell& cell,
                                                                       std::int64_t runs,
                                                                       std::uint64_t seed,
                                                                       unsigned threads) {
    std::array<IntervalSummary, interval_lengths_s.size()> sums;
    for (const IntervalRuns& one : results_of(runs, threads, [&](std::int64_t i) {
             return certify_intervals(cell, seed * 1'000'003 + static_cast<std::uint64_t>(i));
         }))
        for (std::size_t i = 0; i < sums.size(); ++i) {
            IntervalSummary& sum = sums[i];
            ++sum.runs;
            if (!one[i].certified) continue;
            ++sum.certified;
            if (std::abs(one[i].error) <= one[i].expanded) ++sum.held;
            if (std::abs(one[i].error) <= one[i].by_noise) ++sum.held_by_noise;
            const auto n = static_cast<double>(sum.certified);
            sum.mean_error += (one[i].error - sum.mean_error) / n;
            sum.mean_expanded += (one[i].expanded - sum.mean_expanded) / n;
            sum.mean_slow += (one[i].slow - sum.mean_slow) / n;
            sum.mean_ideal += (one[i].ideal - sum.mean_ideal) / n;
        }
    return sums;
}

std::string interval_heading() {
    return fmt::format("{:<40} {:>5} {:>5} {:>5} {:>7} {:>7} {:>7} {:>7} {:>7} {:>7}\n",
                       "errors (speeds in mm/s)", "s", "runs", "cert", "held %", "wbjo %", "mean/U",
                       "U", "2 b", "ideal");
}

std::string interval_lines(
    const IntervalCell& cell,
    const std::array<IntervalSummary, interval_lengths_s.size()>& summaries) {
    std::string text;
    for (std::size_t i = 0; i < summaries.size(); ++i) {
        const IntervalSummary& s = summaries[i];
        text += fmt::format("{:<40} {:5g} {:5} {:5}", cell.name, interval_lengths_s[i], s.runs,
                            s.certified);
        if (s.certified > 0)
            text += fmt::format(
                " {:7.1f} {:7.1f} {:+7.3f} {:7.1f} {:7.1f} {:>7}", 100.0 * s.held_part(),
                100.0 * s.part(s.held_by_noise), s.mean_error / s.mean_expanded,
                1e3 * s.mean_expanded, 2e3 * s.mean_slow,
                s.mean_ideal > 0.0 ? fmt::format("{:.1f}", 1e3 * s.mean_ideal) : "-");
        text += "\n";
    }
    return text;
}

}  // namespace runcert
