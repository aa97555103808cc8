#include "witness_study.h"

#include <fmt/format.h>

#include <cmath>

#include "core/parallel.h"

namespace runcert {
namespace {

constexpr double fault_probability = 0.002;  // the default of window.fault_probability

std::vector<StudyHeard> heard_of(const WitnessStudyOptions& options) {
    std::vector<StudyHeard> all;
    for (std::size_t i = 1; i < study_heard_names.size(); ++i)
        if (!options.only || static_cast<std::size_t>(*options.only) == i)
            all.push_back(static_cast<StudyHeard>(i));
    return all;
}

WitnessedRuns run_once(const WitnessCell& cell, const WitnessStudyOptions& options,
                       std::uint64_t seed, bool faulted) {
    WitnessedRuns runs;
    SimulatedAttempt run(cell, seed);
    runs[0] = run.judged(StudyHeard::nothing, 0.0);
    if (!run.best()) return runs;
    const SpeedEvidence evidence = run.best()->evidence.value();
    const double limit_m_s = 2.0 * evidence.position_standard_uncertainty_m_s;
    if (faulted) {
        RandomGenerator random(seed + 2);
        const std::size_t first = run.any_window(random);
        run.add_fault(first, evidence.fault_m_s * (2.0 * random.uniform() - 1.0));
    }
    runs[0] = run.judged(StudyHeard::nothing, limit_m_s);
    for (const StudyHeard heard : heard_of(options))
        runs[static_cast<std::size_t>(heard)] = run.judged(heard, limit_m_s);
    return runs;
}

}  // namespace

const std::vector<WitnessCell>& witness_cells() {
    static const std::vector<WitnessCell> cells{
        {.part = 0.1, .rivals = 1},  {.part = 1.0, .rivals = 1},  {.part = 0.1, .rivals = 20},
        {.part = 1.0, .rivals = 20}, {.part = 0.1, .rivals = 60}, {.part = 1.0, .rivals = 60}};
    return cells;
}

WitnessCellRuns study_witnesses(const WitnessCell& cell, const WitnessStudyOptions& options) {
    const auto runs = [&](std::int64_t count, bool faulted) {
        return results_of(count, options.threads, [&, faulted](std::int64_t i) {
            return run_once(cell, options,
                            options.seed * 1'000'003 + 4 * static_cast<std::uint64_t>(i), faulted);
        });
    };
    return {.clean = runs(options.runs, false), .faulted = runs(options.faults, true)};
}

WitnessLine witness_line(const WitnessCell& cell, const WitnessCellRuns& runs, StudyHeard heard) {
    constexpr double negligible_m_s = 0.05 / 3.6;
    WitnessLine line;
    const auto share = [](double count, double of) { return of > 0.0 ? count / of : 0.0; };
    const auto which = static_cast<std::size_t>(heard);
    double clean = 0.0, held = 0.0, widened = 0.0;
    for (const WitnessedRuns& run : runs.clean) {
        const WitnessedRun& one = run[which];
        if (!one.certified) continue;
        ++clean;
        line.expanded_m_s += one.expanded_m_s;
        line.probability += one.probability;
        line.tail_m_s += one.tail_m_s;
        held += std::abs(one.error_m_s) <= one.expanded_m_s ? 1.0 : 0.0;
        widened += one.expanded_m_s > run[0].expanded_m_s ? 1.0 : 0.0;
    }
    for (double* const sum : {&line.expanded_m_s, &line.probability, &line.tail_m_s})
        *sum = share(*sum, clean);
    line.held = share(held, clean);
    line.widened = share(widened, clean);
    line.refused = 1.0 - share(clean, static_cast<double>(runs.clean.size()));
    double faulted = 0.0, still_held = 0.0, off = 0.0;
    for (const WitnessedRuns& run : runs.faulted) {
        const WitnessedRun& one = run[which];
        if (!one.certified) continue;
        ++faulted;
        still_held += std::abs(one.error_m_s) <= one.expanded_m_s ? 1.0 : 0.0;
        off += std::abs(one.error_m_s) > one.expanded_m_s + negligible_m_s ? 1.0 : 0.0;
    }
    const auto all = static_cast<double>(runs.faulted.size());
    line.faults_held = share(still_held, faulted);
    line.faults_refused = 1.0 - share(faulted, all);
    line.faults_off = share(off, all);
    const double prior = 1.0 - std::pow(1.0 - fault_probability, cell.rivals);
    line.coverage = (1.0 - prior) * line.held + prior * line.faults_held;
    return line;
}

std::string witness_table(const WitnessCell& cell, const WitnessCellRuns& runs) {
    std::string text = fmt::format(
        "Lasting errors {:g} of what is stated, {} window{} as fast; {} runs without a fault, {} "
        "with one\n"
        "{:<16} {:>7} {:>8} {:>8} {:>8} {:>8} {:>8} | {:>8} {:>8} {:>8} | {:>8}\n",
        cell.part, cell.rivals, cell.rivals == 1 ? "" : "s", runs.clean.size(), runs.faulted.size(),
        "", "U km/h", "p", "1e-4", "widened", "refused", "held", "refused", "held", "off",
        "weighed");
    for (std::size_t i = 0; i < study_heard_names.size(); ++i) {
        const WitnessLine line = witness_line(cell, runs, static_cast<StudyHeard>(i));
        if (line.expanded_m_s == 0.0) continue;
        text += fmt::format(
            "{:<16} {:7.3f} {:8.4f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} | {:8.3f} {:8.3f} {:8.3f} | "
            "{:8.4f}\n",
            study_heard_names[i], 3.6 * line.expanded_m_s, line.probability, 3.6 * line.tail_m_s,
            line.widened, line.refused, line.held, line.faults_refused, line.faults_held,
            line.faults_off, line.coverage);
    }
    return text;
}

}  // namespace runcert
