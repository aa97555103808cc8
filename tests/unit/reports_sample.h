#pragma once

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "core/random.h"
#include "reports/certificate/report_data.h"
#include "reports_sample_rules.h"
#include "reports_sample_screening.h"
#include "reports_sample_verdict.h"
#include "store/atomic_file.h"
#include "store/document_schema.h"
#include "store/program.h"
#include "store/sha256.h"

// A made-up run: the logistic run of [DHD22], 451 epochs at 10 Hz, with what the stages would have
// said of it.

namespace runcert::sample {

struct Options {
    int epochs = 451;
    double interval_s = 0.1;
    bool certified = true;  ///< false: no window, everything after 17 s unusable
    bool vertical = true;
    bool georeferenced = true;
    bool second_receiver = false;
    int gap_every_s = 0;  ///< 20 epochs are lost so often
    std::string craft = "Salt Runner";
    std::string place = "dry lake";
};

struct Run {
    ReportInputs inputs;
    std::map<std::string, std::string> files;  ///< name in the run folder -> contents
};

inline double truth_speed(double t) {
    const double t0 = 15.0, top = 60.0, rate = std::log(top / 0.01 - 1.0) / t0;
    return top / (1.0 + std::exp(-rate * (t - t0)));
}

inline double truth_distance(double t) {
    const double t0 = 15.0, top = 60.0, rate = std::log(top / 0.01 - 1.0) / t0;
    const double c = std::exp(rate * t0);
    return top * (t + std::log((1.0 + c * std::exp(-rate * t)) / (1.0 + c)) / rate);
}

inline ElapsedTime elapsed(double seconds) {
    return {std::llround(seconds * 1e9)};
}

inline GpsTime first_epoch() {
    return GpsTime::from_calendar({.year = 2022,
                                   .month = 3,
                                   .day = 18,
                                   .hour = 8,
                                   .minute = 51,
                                   .second = 22,
                                   .nanosecond = 300'000'000});
}

inline Header header(const std::string& stage, nlohmann::ordered_json parameters) {
    return {.schema_name = {},
            .schema_version = {},
            .stage = stage,
            .program_version = program_version(),
            .source_revision = source_revision(),
            .programs = {},
            .inputs = {},
            .parameters = std::move(parameters)};
}

inline RecordingFacts facts(const Options& options, const std::string& receiver) {
    RecordingFacts facts{.receiver = receiver,
                         .first_epoch = std::nullopt,
                         .georeferenced = options.georeferenced,
                         .vertical_measured = options.vertical,
                         .nominal_interval_s = options.interval_s};
    if (options.georeferenced) facts.first_epoch = first_epoch();
    return facts;
}

inline std::optional<FrameOrigin> origin(const Options& options) {
    if (!options.georeferenced) return std::nullopt;
    return FrameOrigin{{Angle::from_degrees(-31.4), Angle::from_degrees(137.25), 87.5}, "attempt"};
}

inline WindowSpan span(const Options& options, double start, double duration) {
    WindowSpan span{
        .first_epoch = static_cast<std::int64_t>(start / options.interval_s) + 1,
        .last_epoch = static_cast<std::int64_t>((start + duration) / options.interval_s) + 1,
        .start = elapsed(start),
        .duration = elapsed(duration),
        .start_gps = std::nullopt};
    if (options.georeferenced)
        span.start_gps = first_epoch().plus_nanoseconds(span.start.nanoseconds);
    return span;
}

/// The rows combine to 0.002551 m/s; half of them contribute nothing.
inline std::vector<BudgetRow> budget() {
    using enum RowScope;
    return {
        {"w", "white noise of the positions", 0.0, "m / s", 0.0013, "A", "normal", 739.64, 1.0,
         0.0013, source, "", "the data show 0.952 times the stated size"},
        {"b", "time-correlated error of the positions", 0.0, "m / s", 0.0017, "B", "normal",
         std::nullopt, 1.0, 0.0017, slow, "", "standard deviation 0.0100 m (stated)"},
        {"j", "motion between the measurements", 0.0, "m / s", 0.000917, "A", "normal", 149.15, 1.0,
         0.000917, source, "", "jerk density 0.4300 m s^-2.5"},
        {"t", "time stamps of the window's ends", 3.0, "s", 0.00002, "B", "rectangular",
         std::nullopt, -20.000806, 0.0004, source, "", "stamps are irregular"},
        {"r", "resolution of the recorded coordinates", 0.0, "m", 0.0, "B", "rectangular",
         std::nullopt, 0.333333, 0.0, source, "", "not known of this recording"},
        {"m", "engineering CRS against the ground", 1.0, "1", 0.0, "B", "rectangular", std::nullopt,
         60.002417, 0.0, window, "", "0.0 km from the origin at most"},
        {"a", "antenna against the craft's reference point", 0.0, "m", 0.0, "B", "rectangular",
         std::nullopt, 0.333333, 0.0, antenna, "",
         "no lever arm stated: the speed is the antenna's"},
        {"d", "undetected step or outlier", 0.0, "m / s", 0.0004, "B", "rectangular", std::nullopt,
         1.0, 0.0004, fault, "", "an undetected step of 0.035 m before epoch 396"},
        {"f", "choice of the fastest of many windows", 0.0, "m / s", 0.000876, "A", "normal",
         std::nullopt, 1.0, 0.000876, window, "", "bias over 118 windows, not subtracted"}};
}

inline void fill_uncertainty(CertifiableWindow& best) {
    best.detection_power = 0.8;
    best.reliability = reliability();
    best.effective_degrees_of_freedom = 4008.14;
    best.fitted = FittedSpeed{60.002553, 0.001959, 11};
    best.bound = ErrorBound{.tau_min_s = 0.5,
                            .tau_max_s = 10.0,
                            .sigma_m = 0.01,
                            .fitted_m = 0.0,
                            .stated_m = 0.009517,
                            .floor_m = 0.01,
                            .floor_fix = FixType::fixed,
                            .decided_by = BoundSource::floor,
                            .standard_uncertainty_m_s = 0.002361};
    best.robust = RobustSpeed{60.002551, -0.00004, 0.003745, true, 6};
    best.selection = SelectionBias{.candidates = 118,
                                   .chosen_mean_m_s = 60.001541,
                                   .chosen_sd_m_s = 0.000935,
                                   .best_mean_m_s = 60.001991,
                                   .best_sd_m_s = 0.000414,
                                   .bias_m_s = 0.000876,
                                   .bias_uncertainty_m_s = 0.000079,
                                   .treatment = SelectionTreatment::covered,
                                   .samples = 500,
                                   .seed = 1};
    best.budget = budget();
    best.monte_carlo = MonteCarloCheck{.seed = 1,
                                       .trials = 110000,
                                       .mean_m_s = 60.002419,
                                       .standard_uncertainty_m_s = 0.002549,
                                       .lower_m_s = 59.997421,
                                       .upper_m_s = 60.007415,
                                       .tolerance_m_s = 0.00005,
                                       .converged = true};
}

inline AxesEstimation axes(bool vertical) {
    AxesEstimation axes;
    NoiseSummary& noise = axes.noise;
    noise.status = NoiseBasis::fitted;
    noise.epochs = 443;
    noise.epochs_needed = 30;
    noise.stated_sigma_m = vertical ? 0.02 : 0.01;
    noise.tau_min_s = 0.5;
    noise.tau_max_s = 10.0;
    noise.jerk_density = {0.430047, 0.0579, false};
    noise.measurement_scale = {0.951671, 0.026, false};
    noise.white_scale = 0.951671;
    noise.passes = 98.4;
    noise.converged = true;
    if (vertical) {
        noise.correlated_error_detected = true;
        noise.error_gain = 12.5;
        noise.error_diffusion = NoiseParameter{0.0123, 0.11, false};
        noise.error_sigma_m = NoiseParameter{0.0271, 1.2, false};
        noise.error_tau_s = NoiseParameter{10.0, std::nullopt, true};
    }
    noise.posterior = {{1.0, 0.43, std::nullopt, 0.951671, 0.0, 1.0}};
    axes.health = {.innovations = 880,
                   .mean_statistic = 1.0041,
                   .lower = 0.9095,
                   .upper = 1.0947,
                   .spans = 8,
                   .spans_outside = 1,
                   .spans_allowed = 1,
                   .consistent = true,
                   .autocorrelation_stated = -0.1138,
                   .autocorrelation = -0.0294,
                   .white = true,
                   .largest_condition = 25.3,
                   .largest_asymmetry = 9.750097e-12};
    return axes;
}

inline void fill_tables(const Options& options, ScreenedTable& screened,
                        TrajectoryTable& trajectory) {
    RandomGenerator random(1);
    std::int64_t arc = 1;
    bool was_lost = false;
    for (int i = 0; i < options.epochs; ++i) {
        const double t = i * options.interval_s;
        const int second = static_cast<int>(t);
        if (options.gap_every_s > 0 && second % options.gap_every_s == 0 && second > 0 &&
            t - second < 0.5) {
            was_lost = true;
            continue;
        }
        arc += was_lost ? 1 : 0;
        const bool bad = (i > 100 && i % 97 < 2) || (!options.certified && t > 17.0);
        ScreenedEpoch epoch;
        epoch.epoch = i + 1;
        epoch.time = elapsed(t);
        epoch.east_m = 1000.0 + truth_distance(t) * std::sqrt(0.5) + 0.01 * random.normal();
        epoch.north_m = 1000.0 + truth_distance(t) * std::sqrt(0.5) + 0.01 * random.normal();
        if (options.vertical) epoch.up_m = 0.02 * random.normal();
        epoch.sigma_east_m = epoch.sigma_north_m = 0.01;
        epoch.usable = !bad;
        epoch.reason =
            !bad ? Reason::none : (!options.certified ? Reason::float_ambiguities : Reason::burst);
        if (epoch.reason == Reason::burst) epoch.hypothesis = Hypothesis::burst;
        epoch.statistic = bad ? 61.2 : 1.7;
        epoch.threshold = 27.6;
        const bool outside = !options.certified && t > 17.0;
        if (!outside) epoch.arc = arc;
        if (was_lost || i == 0) epoch.break_before = i == 0 ? ArcBreak::start : ArcBreak::gap;
        was_lost = false;
        screened.rows.push_back(epoch);

        TrajectoryEpoch row;
        row.epoch = epoch.epoch;
        row.time = epoch.time;
        if (!outside) {
            const double v = truth_speed(t);
            row.east_m = 1000.0 + truth_distance(t) * std::sqrt(0.5);
            row.north_m = row.east_m;
            if (options.vertical) row.up_m = 0.0;
            row.speed_m_s = v + 0.004 * std::sin(2.1 * t);
            row.sigma_speed_m_s = 0.012;
            row.velocity_east_m_s = row.velocity_north_m_s = *row.speed_m_s * std::sqrt(0.5);
            row.speed_batch_m_s = row.speed_m_s;
            if (i % 50 > 1) row.speed_v1_m_s = v + 0.0627 * random.normal();
            if (i % 50 > 2) row.speed_v2_m_s = v + 0.0303 * random.normal();
            row.speed_kalman_m_s = truth_speed(t - 0.4) + 0.02 * random.normal();
            row.arc = arc;
            row.usable = !bad;
        }
        trajectory.rows.push_back(row);
    }
    trajectory.estimation = {.arcs = arc,
                             .degrees_of_freedom = 890,
                             .variance_factor = 0.9713,
                             .variance_factor_applied = 1.0,
                             .largest_position_difference_m = 4.1e-9,
                             .largest_velocity_difference_m_s = 2.2e-8};
    screened.variance_factor = 1.04;
    screened.basis = basis(options.vertical);
    trajectory.estimation.batch_stretches = arc;
    trajectory.estimation.robust_downweighted = 12;
    trajectory.estimation.horizontal = axes(false);
    if (options.vertical) trajectory.estimation.vertical = axes(true);
}

inline ReceiverResults receiver(const Options& options, const std::string& id) {
    ReceiverResults results;
    const RecordingFacts recording = facts(options, id);
    results.observations = {.header = header("import", {{"format", "auto"}}),
                            .facts = recording,
                            .format = "rtklib-pos",
                            .frame = options.georeferenced ? "geodetic" : "local_plane",
                            .time_scale = options.georeferenced ? "gps" : "relative",
                            .accuracy_source = "recording",
                            .notes = {"The recording gives 3 decimals of a second."},
                            .rows = {}};
    results.enu.header = header("enu", nlohmann::ordered_json::object());
    results.screened.header = header("screen", {{"allowed_fixes", {"fixed", "unknown"}},
                                                {"accuracy_min_m", 0.0001},
                                                {"accuracy_max_m", 10},
                                                {"gap_factor", 1.5},
                                                {"false_alarm_rate", 1e-6},
                                                {"restart_after", 3},
                                                {"min_arc_epochs", 6},
                                                {"jerk_density", 0.6}});
    results.trajectory.header =
        header("smooth", {{"jerk_density", 0.9}, {"dhd22_acceleration_sigma", 0.1}});
    results.screened.facts = results.trajectory.facts = recording;
    results.screened.origin = results.trajectory.origin = origin(options);
    fill_tables(options, results.screened, results.trajectory);
    results.windows = {.header = header("window", {{"duration_tolerance_s", 0.001}}),
                       .receiver = id,
                       .first_epoch = recording.first_epoch,
                       .georeferenced = options.georeferenced,
                       .profiles = {}};
    for (const double duration : {3.0, 2.0}) {
        ProfileWindows windows{
            .profile = duration > 2.5 ? "nalsa" : "fisly",
            .rule = {.duration_s = duration, .definition = SpeedDefinition::displacement},
            .candidates = options.certified ? 421 : 0,
            .best = std::nullopt,
            .indicated = std::nullopt};
        if (options.certified)
            windows.best = CertifiableWindow{
                .span = span(options, 40.2, duration),
                .arc = 1,
                .speed_m_s = 60.002417,
                .standard_uncertainty_m_s = 0.002551,
                .displacement_m = 60.002417 * duration,
                .position_r95_m = 0.0144,
                .definitions = {60.002417, 60.002424, 60.002402, 60.002405},
                .methods = {60.002402, 60.002402, 60.0068, std::nullopt, 59.9954}};
        if (options.certified) fill_uncertainty(*windows.best);
        windows.indicated = IndicatedWindow{.span = span(options, 35.1, duration),
                                            .speed_m_s = 60.0871,
                                            .refusals = {"The jump at epoch 353 is inside it."}};
        results.windows.profiles.push_back(windows);
    }
    return results;
}

inline std::vector<Requirement> requirements(const Profile& profile, bool certified) {
    std::vector<Requirement> list;
    for (const Clause& clause : profile.clauses) {
        Requirement entry{.clause = clause.id,
                          .status = RequirementStatus::met,
                          .text = clause.text,
                          .source = clause.source,
                          .edition = clause.edition,
                          .where = clause.where,
                          .looked_at = profile.looked_at,
                          .certainty = clause.certainty,
                          .decided_by = clause.decided_by};
        if (clause.decided_by == Computation::attest) entry.status = RequirementStatus::attest;
        if (clause.decided_by == Computation::window_complete)
            entry.evidence = certified
                                 ? "The window of 3.000 s holds 31 usable epochs in one "
                                   "stretch."
                                 : "No stretch of the rule's length holds usable epochs only.";
        if (clause.decided_by == Computation::window_complete && !certified)
            entry.status = RequirementStatus::not_met;
        if (clause.decided_by == Computation::accuracy)
            entry.evidence = "Expanded uncertainty 0.0184 km/h (k = 2), limit 0.8 km/h.";
        if (entry.evidence.empty()) entry.evidence = "Not decided by the data.";
        list.push_back(entry);
    }
    return list;
}

inline Verdict verdict(const Options& options, const std::vector<Profile>& profiles) {
    Verdict verdict{.header = header("check", nlohmann::ordered_json::object()),
                    .attempt = "logistic-run",
                    .receiver = "primary",
                    .georeferenced = options.georeferenced,
                    .record = RecordToBeat{202.9, "km/h", "published figure of 2009", 202.9 / 3.6},
                    .statements = {"The uncertainty is the combination of the sources in the "
                                   "budget, one row each.",
                                   "An error that screening should have found is not in it."},
                    .profiles = {}};
    for (const Profile& profile : profiles) {
        ProfileVerdict entry{
            .profile = profile.id,
            .rule = {.sha256 = std::string(64, 'a'), .origin = RuleOrigin::built_in},
            .body = profile.body,
            .title = profile.title,
            .outcome = options.certified ? Outcome::beaten : Outcome::not_certifiable,
            .reason = options.certified ? "216.009 km/h less 0.018 km/h reaches the 204.51 km/h "
                                          "that the rule asks for."
                                        : "There is no stretch of the rule's length in which "
                                          "every epoch is usable.",
            .definition = profile.definition,
            .coverage_factor = 2.0,
            .speed_m_s = std::nullopt,
            .expanded_uncertainty_m_s = std::nullopt,
            .required_speed_m_s = 204.509344 / 3.6,
            .window = std::nullopt,
            .requirements = requirements(profile, options.certified),
            .indicated = std::nullopt};
        if (options.certified) {
            entry.speed_m_s = 60.002417;
            entry.expanded_uncertainty_m_s = 0.005102;
            entry.window = span(options, 40.2, profile.duration_s);
        }
        entry.indicated = RefusedWindow{span(options, 35.1, profile.duration_s),
                                        60.0871,
                                        {"The jump at epoch 353 is inside it."}};
        fill_verdict(entry, *verdict.record,
                     span(options, 0.0, (options.epochs - 1) * options.interval_s));
        verdict.profiles.push_back(entry);
    }
    return verdict;
}

inline void add_file(Run& run, const std::string& role, const std::string& name,
                     std::string contents) {
    const FileDigest digest = digest_of(contents);
    run.inputs.files.push_back({role, name, digest.sha256, static_cast<std::int64_t>(digest.bytes),
                                role == "recording" ? "rover track.pos" : ""});
    run.files[name] = std::move(contents);
}

inline Attempt attempt(const Options& options) {
    std::string text =
        "schema: attempt/1.0\nid: logistic-run\n"
        "craft: {name: placeholder, class: land-yacht}\ndate: \"2022-03-18\"\n"
        "officials: [{role: measurer}, {role: observer, name: appointed by the club}]\n"
        "receivers:\n  - {id: primary, recording: data/rover.pos, antenna_height_m: 1.15}\n";
    if (options.second_receiver) text += "  - {id: secondary, recording: data/second.pos}\n";
    text +=
        "record: {speed: 202.9, unit: km/h, source: published figure of 2009}\n"
        "profiles: [nalsa, fisly]\n";
    Attempt attempt = read_attempt(text, "attempt.yaml");
    attempt.resolved = YamlValue(parse_yaml("parameters: {smooth: {jerk_density: 0.9}}", "f"), "f");
    attempt.overrides = {"smooth.jerk_density"};
    attempt.craft.name = options.craft;
    attempt.place = options.place;
    return attempt;
}

inline Run make_run(const Options& options = {}) {
    Run run;
    run.inputs.attempt = attempt(options);
    for (const char* name : {"nalsa", "fisly"})
        run.inputs.profiles.push_back(read_profile(rule(name), name));
    run.inputs.receivers.push_back(receiver(options, "primary"));
    if (options.second_receiver) run.inputs.receivers.push_back(receiver(options, "secondary"));
    run.inputs.verdict = verdict(options, run.inputs.profiles);
    const ReceiverResults& judged = run.inputs.receivers.front();
    add_file(run, "attempt", "attempt.yaml", "id: logistic-run\n");
    add_file(run, "recording", "0-recording.pos", "% recording\n");
    add_file(run, "profile", "profile.nalsa.yaml", std::string(rule("nalsa")));
    add_file(run, "observations", "1-observations.ecsv", write_observations(judged.observations));
    add_file(run, "screened", "3-screened.ecsv", write_screened(judged.screened));
    add_file(run, "trajectory", "4-trajectory.ecsv", write_trajectory(judged.trajectory));
    add_file(run, "windows", "5-windows.yaml", write_windows(judged.windows));
    add_file(run, "verdict", "6-verdict.yaml", write_verdict(run.inputs.verdict));
    return run;
}

/// The run as claimed under only the first of its rules.
inline Run with_one_rule(Run run) {
    run.inputs.attempt.profiles.resize(1);
    run.inputs.profiles.resize(1);
    run.inputs.verdict.profiles.resize(1);
    for (ReceiverResults& results : run.inputs.receivers)
        results.windows.profiles.resize(1);
    return run;
}

}  // namespace runcert::sample
