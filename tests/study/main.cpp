#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <fstream>
#include <map>

#include "alignment_study.h"
#include "coverage.h"
#include "drift_study.h"
#include "false_records.h"
#include "identification_study.h"
#include "interval_study.h"
#include "motion_study.h"
#include "people_study.h"
#include "selection_study.h"
#include "speeds_study.h"
#include "usefulness_study.h"
#include "witness_study.h"

using namespace runcert;

namespace {

void print_coverage(const CoverageOptions& options, const std::vector<double>& rates_hz,
                    double jerk_density) {
    std::vector<CoverageCell> cells;
    for (const double rate_hz : rates_hz)
        for (const CoverageCell& cell : coverage_cells(rate_hz, jerk_density)) {
            cells.push_back(study_coverage(cell, options));
            fmt::print(stderr, "{} of {} cells\n", cells.size(), 7 * rates_hz.size());
        }
    fmt::print("{}", coverage_table(cells));
}

void print_screening(const ScreeningStudyOptions& options) {
    for (const StudyRun& cell : screening_cells()) {
        fmt::print("{}", power_table(cell, study_power(cell, options)));
        const Share clean = study_clean(cell, options);
        fmt::print("{}: {} of {} clean runs of {} epochs without a mark\n\n", cell_name(cell),
                   clean.count, clean.of, options.clean_epochs);
        std::vector<Identification> lines;
        for (const ErrorScenario& scenario : error_scenarios(cell.rate_hz))
            lines.push_back(study_identification(cell, scenario, options));
        fmt::print("{}\n", identification_table(cell, lines));
        std::fflush(stdout);
    }
}

void print_motion(const MotionStudyOptions& options, const std::string& only, bool budget,
                  double rate_hz) {
    fmt::print("{}", motion_header());
    for (const MotionCell& cell : motion_cells(rate_hz)) {
        if ((cell.motion + ", " + cell.errors).find(only) == std::string::npos) continue;
        const auto results = study_motion(cell, options);
        fmt::print("{}", motion_line(cell, summarise(results)));
        if (budget) {
            std::map<std::string, double> rows;
            double bias = 0.0;
            for (const MotionResult& one : results) {
                bias += one.bias_m_s;
                for (const BudgetRow& row : one.budget)
                    rows[row.symbol] += row.contribution_m_s;
            }
            const auto n = static_cast<double>(results.size());
            fmt::print("    bias {:.4f} km/h;", 3.6 * bias / n);
            for (const auto& [symbol, sum] : rows)
                fmt::print(" {} {:.4f}", symbol, 3.6 * sum / n);
            fmt::print("\n");
        }
        for (const MotionResult& one : results)
            if (!one.failure.empty()) fmt::print("    {}\n", one.failure);
        std::fflush(stdout);
    }
}

void print_people(const PeopleStudyOptions& options, bool faults, const std::string& only,
                  double length_s, const std::string& csv_file) {
    // Each run is one thread's, so that its processor time is what it takes on one core.
    setenv("RUNCERT_THREADS", "1", 1);
    std::vector<PeopleResult> results;
    if (faults) results = study_people_faults(options);
    for (PeopleKind kind : people_kinds()) {
        if (length_s > 0.0) kind.shortest_s = kind.longest_s = length_s;
        if (faults || kind.name.find(only) == std::string::npos) continue;
        std::vector<PeopleResult> of_kind = study_people(kind, options);
        fmt::print(stderr, "{}", people_table(of_kind));
        std::ranges::move(of_kind, std::back_inserter(results));
    }
    fmt::print("{}", faults ? people_faults_table(results) : people_table(results));
    if (!csv_file.empty()) std::ofstream(csv_file) << people_csv(results);
}

struct CellOptions {
    std::int64_t runs = 100;
    std::uint64_t seed = 1;
    unsigned threads = 2;
    std::string only = {};
};

void add_cell_options(CLI::App& command, CellOptions& options) {
    command.add_option("--runs", options.runs, "a cell")->capture_default_str();
    command.add_option("--seed", options.seed)->capture_default_str();
    command.add_option("--threads", options.threads, "0: as many as there are")
        ->capture_default_str();
    command.add_option("--only", options.only, "cells whose name holds this");
}

void print_speeds(const CellOptions& options, bool people) {
    setenv("RUNCERT_THREADS", "1", 1);
    std::string missed;
    const auto print = [&](const std::string& name, const auto& of) {
        if (name.find(options.only) == std::string::npos) return;
        const auto rules = study_speeds([&](std::uint64_t one) { return certify_speeds(of, one); },
                                        options.runs, options.seed, options.threads);
        fmt::print("{}", speeds_lines(name, rules));
        std::fflush(stdout);
        for (const SpeedsSummary& one : rules)
            if (const std::string misses = one.misses(); !misses.empty())
                missed += fmt::format("{}, {}: {}\n", name, one.rule, misses);
    };
    fmt::print("{}", speeds_heading());
    for (const SpeedsCell& cell : speeds_cells())
        print(cell.name, cell);
    for (const PeopleKind& kind : people_kinds())
        if (people && kind.velocities == PeopleVelocities::stated)
            print("people, " + kind.name, kind);
    fmt::print("Below 94 % inside, above 2.5 % falsely beaten, or a mean error above 0.3 U:\n{}",
               missed);
}

void print_intervals(const CellOptions& options) {
    setenv("RUNCERT_THREADS", "1", 1);
    fmt::print("{}", interval_heading());
    for (const IntervalCell& cell : interval_cells()) {
        if (cell.name.find(options.only) == std::string::npos) continue;
        fmt::print("{}", interval_lines(cell, study_intervals(cell, options.runs, options.seed,
                                                              options.threads)));
        std::fflush(stdout);
    }
}

void print_drifts(const CellOptions& options) {
    setenv("RUNCERT_THREADS", "1", 1);
    std::string missed;
    fmt::print("{}", drift_heading());
    for (const DriftCell& cell : drift_cells()) {
        if (cell.name.find(options.only) == std::string::npos) continue;
        const DriftSummary summary = study_drift(cell, options.runs, options.seed, options.threads);
        fmt::print("{}", drift_lines(cell, summary));
        std::fflush(stdout);
        if (const std::string misses = summary.misses(cell); !misses.empty())
            missed += fmt::format("{}: {}\n", cell.name, misses);
    }
    fmt::print(
        "Below 94 % inside, above 2.5 % falsely beaten, or a mean error above 0.3 U; below "
        "90 % inside beside a drift that a witness can see:\n{}",
        missed);
}

void print_witnesses(WitnessStudyOptions options, const std::vector<int>& rivals,
                     const std::vector<double>& parts, const std::string& only) {
    setenv("RUNCERT_THREADS", "1", 1);
    if (const auto named = std::ranges::find(study_heard_names, only);
        named != study_heard_names.end())
        options.only = static_cast<StudyHeard>(named - study_heard_names.begin());
    for (const WitnessCell& cell : witness_cells()) {
        if (std::ranges::find(rivals, cell.rivals) == rivals.end() ||
            std::ranges::find(parts, cell.part) == parts.end())
            continue;
        fmt::print("{}\n", witness_table(cell, study_witnesses(cell, options)));
        std::fflush(stdout);
    }
}

void print_alignment(const AlignmentOptions& options) {
    std::vector<AlignmentStudy> studies;
    for (const AlignmentCell& cell : alignment_cells())
        studies.push_back(study_alignment(cell, options));
    std::vector<SurfaceAccuracy> surfaces;
    for (const auto& [vertex_m, velocity_m_s] : {std::pair(0.0, 0.03), std::pair(0.02, 0.03),
                                                 std::pair(0.05, 0.03), std::pair(0.10, 0.30)})
        surfaces.push_back(study_surface(vertex_m, velocity_m_s, options.starts, options.seed));
    fmt::print("{}\n{}\n{}\n{}", alignment_table_1(studies), alignment_table_2(surfaces),
               alignment_table_3(studies), alignment_figures(studies));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app{"Seeded studies of what the stated uncertainty is worth, and of screening"};
    app.require_subcommand(1);
    CoverageOptions options;
    CLI::App* coverage =
        app.add_subcommand("coverage", "How often the 95 % intervals hold the true speed");
    coverage->add_option("--runs", options.runs, "recordings a cell, with fitted parameters")
        ->capture_default_str();
    coverage->add_option("--runs-known", options.runs_known, "the same with those known")
        ->capture_default_str();
    coverage->add_option("--seed", options.seed)->capture_default_str();
    std::vector<double> rates_hz{10.0, 20.0};
    double jerk_density = 1.0;
    coverage->add_option("--rates", rates_hz, "Hz")->capture_default_str();
    coverage->add_option("--jerk-density", jerk_density, "of the motion, m s^-2.5")
        ->capture_default_str();

    std::int64_t runs = 500;
    std::uint64_t seed = 1;
    CLI::App* selection =
        app.add_subcommand("selection", "The bias of choosing the fastest of many windows");
    selection->add_option("--runs", runs)->capture_default_str();
    selection->add_option("--seed", seed)->capture_default_str();
    std::vector<double> selection_rates_hz{10.0};
    double selection_jerk_density = 0.0;
    selection->add_option("--rates", selection_rates_hz, "Hz")->capture_default_str();
    selection
        ->add_option("--jerk-density", selection_jerk_density,
                     "of a random motion on the run, m s^-2.5")
        ->capture_default_str();

    ScreeningStudyOptions study;
    CLI::App* screening =
        app.add_subcommand("screening", "Which errors of positions screening finds");
    screening->add_option("--recordings", study.recordings, "a cell, for the power")
        ->capture_default_str();
    screening->add_option("--screened", study.screened, "of these, screened with the errors too")
        ->capture_default_str();
    screening
        ->add_option("--scenario-recordings", study.scenario_recordings,
                     "for each kind and size of error")
        ->capture_default_str();
    screening->add_option("--clean-runs", study.clean_runs, "a cell, without an error")
        ->capture_default_str();
    screening->add_option("--seed", study.seed)->capture_default_str();
    screening->add_option("--threads", study.threads, "0: as many as there are")
        ->capture_default_str();

    FalseRecordOptions records;
    CLI::App* false_records =
        app.add_subcommand("false-records", "Certified windows that miss the true speed");
    false_records->add_option("--runs", records.runs)->capture_default_str();
    false_records->add_option("--velocity-noise", records.witness.velocity_noise_m_s,
                              "m/s; the receiver records velocities too, with this noise");
    false_records->add_flag("--phases", records.witness.phases, "its raw phases are recorded");
    false_records->add_flag("--second-receiver", records.witness.receiver,
                            "another receiver records too");
    false_records->add_option("--seed", records.seed)->capture_default_str();
    false_records->add_option("--only", records.only, "the run of this seed, as the table has it");
    false_records->add_option("--threads", records.threads, "0: as many as there are")
        ->capture_default_str();

    WitnessStudyOptions witness_options;
    CLI::App* witness = app.add_subcommand(
        "witness", "What witnesses make of intervals and probabilities, faults included");
    witness->add_option("--runs", witness_options.runs, "without a fault, a cell")
        ->capture_default_str();
    witness->add_option("--faults", witness_options.faults, "with one, a cell")
        ->capture_default_str();
    witness->add_option("--seed", witness_options.seed)->capture_default_str();
    witness->add_option("--threads", witness_options.threads, "0: as many as there are")
        ->capture_default_str();
    std::vector<int> witness_rivals{1, 20, 60};
    std::vector<double> witness_parts{0.1, 1.0};
    witness
        ->add_option("--parts", witness_parts, "cells with errors of this part of what is stated")
        ->capture_default_str();
    witness->add_option("--rivals", witness_rivals, "cells with so many windows as fast")
        ->capture_default_str();
    std::string witness_heard;
    witness->add_option("--only", witness_heard, "the witness of this name alone, beside none");

    MotionStudyOptions motion_options;
    std::string only;
    bool budget = false;
    CLI::App* motion = app.add_subcommand("motion", "Measured speeds of honest motions");
    motion->add_option("--runs", motion_options.runs, "recordings a cell")->capture_default_str();
    motion->add_option("--seed", motion_options.seed)->capture_default_str();
    motion->add_option("--threads", motion_options.threads, "0: as many as there are")
        ->capture_default_str();
    motion->add_flag("--budget", budget, "print each cell's mean budget, km/h");
    double motion_rate_hz = 10.0;
    motion->add_option("--rate", motion_rate_hz, "Hz")->capture_default_str();
    motion->add_option("--only", only, "cells whose name holds this");

    PeopleStudyOptions people_options;
    bool faults = false;
    std::string people_only;
    std::string csv_file;
    CLI::App* people =
        app.add_subcommand("people", "What people's own devices record, certified or refused");
    people->add_option("--runs", people_options.runs, "a kind; with --faults, altogether")
        ->capture_default_str();
    people->add_option("--seed", people_options.seed)->capture_default_str();
    people->add_option("--threads", people_options.threads, "0: as many as there are")
        ->capture_default_str();
    people->add_flag("--faults", faults, "with steps, spikes, ramps and multipath");
    people->add_option("--only", people_only, "kinds whose name holds this");
    double people_length_s = 0.0;
    people->add_option("--length", people_length_s, "s, of every recording; 0: as of its kind")
        ->capture_default_str();
    people->add_option("--csv", csv_file, "a file for a line a run, with its budget");
    CellOptions speeds_options;
    CLI::App* speeds = app.add_subcommand("speeds", "Speeds of recorded velocities");
    add_cell_options(*speeds, speeds_options);
    bool speeds_people = false;
    speeds->add_flag("--people", speeds_people, "what people's devices record, too");
    CellOptions interval_options;
    CLI::App* intervals = app.add_subcommand(
        "intervals", "Whether certificates by positions hold the true speed, by kinds of errors");
    add_cell_options(*intervals, interval_options);

    CellOptions drift_options{.runs = 60};
    CLI::App* drifts = app.add_subcommand(
        "drifts", "Positions that drift, and velocities of a wrong scale, beside witnesses");
    add_cell_options(*drifts, drift_options);
    std::int64_t usefulness_runs = 100;
    std::uint64_t usefulness_seed = 1;
    CLI::App* usefulness = app.add_subcommand(
        "usefulness", "What certificates state, row by row, beside what could be stated");
    usefulness->add_option("--runs", usefulness_runs, "a cell")->capture_default_str();
    usefulness->add_option("--seed", usefulness_seed)->capture_default_str();
    AlignmentOptions alignment_options;
    CLI::App* alignment = app.add_subcommand(
        "alignment", "How soon an IMU's attitude is right, beside the tables of [FHB03]");
    alignment->add_option("--starts", alignment_options.starts, "a method and an error, each cell")
        ->capture_default_str()
        ->check(CLI::PositiveNumber);
    alignment->add_option("--seed", alignment_options.seed)->capture_default_str();
    alignment->add_option("--threads", alignment_options.threads, "0: as many as there are")
        ->capture_default_str();
    CLI11_PARSE(app, argc, argv);

    if (alignment->parsed()) print_alignment(alignment_options);

    if (speeds->parsed()) print_speeds(speeds_options, speeds_people);

    if (intervals->parsed()) print_intervals(interval_options);
    if (drifts->parsed()) print_drifts(drift_options);

    if (usefulness->parsed())
        for (const WitnessCell& cell : {WitnessCell{.part = 0.1}, WitnessCell{.part = 1.0}})
            fmt::print("{}\n", usefulness_table(cell, study_usefulness(cell, usefulness_runs,
                                                                       usefulness_seed, 0)));
    if (coverage->parsed()) print_coverage(options, rates_hz, jerk_density);
    if (witness->parsed())
        print_witnesses(witness_options, witness_rivals, witness_parts, witness_heard);
    if (people->parsed())
        print_people(people_options, faults, people_only, people_length_s, csv_file);
    if (motion->parsed()) print_motion(motion_options, only, budget, motion_rate_hz);
    if (selection->parsed())
        for (const double rate_hz : selection_rates_hz)
            for (const double noise_m : {0.010, 0.030}) {
                fmt::print("{}", selection_line(study_selection(
                                     selection_run(noise_m, rate_hz, selection_jerk_density), runs,
                                     seed)));
                std::fflush(stdout);
            }
    if (screening->parsed()) print_screening(study);
    if (false_records->parsed()) {
        const auto certified = study_false_records(records);
        if (records.only) fmt::print("{}", run_line(certified.front()));
        fmt::print("{}", false_records_table(certified));
    }
}
