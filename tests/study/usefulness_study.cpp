#include "usefulness_study.h"

#include <fmt/format.h>

#include <cmath>

#include "core/parallel.h"

namespace runcert {
namespace {

struct OneRun {
    std::map<std::string, double> rows_m_s;
    double bias_limit_m_s = 0.0;
    SimulatedAttempt::Optimum optimum;
    std::array<WitnessedRun, study_heard_names.size()> judged;
};

OneRun run_once(const WitnessCell& cell, std::uint64_t seed) {
    SimulatedAttempt attempt(cell, seed);
    OneRun run;
    run.judged[0] = attempt.judged(StudyHeard::nothing, 0.0);
    for (const BudgetRow& row : attempt.best()->budget)
        run.rows_m_s[row.symbol] += row.contribution_m_s;
    run.bias_limit_m_s = attempt.best()->bias_limit_m_s;
    run.optimum = attempt.optimum();
    for (std::size_t i = 1; i < study_heard_names.size(); ++i)
        run.judged[i] = attempt.judged(static_cast<StudyHeard>(i), 0.0);
    return run;
}

}  // namespace

Usefulness study_usefulness(const WitnessCell& cell, std::int64_t runs, std::uint64_t seed,
                            unsigned threads) {
    Usefulness found;
    found.runs = runs;
    found.expanded_m_s.assign(study_heard_names.size(), 0.0);
    found.rms_m_s.assign(study_heard_names.size(), 0.0);
    const auto n = static_cast<double>(runs);
    for (const OneRun& run : results_of(runs, threads, [&](std::int64_t i) {
             return run_once(cell, seed * 1'000'003 + 4 * static_cast<std::uint64_t>(i));
         })) {
        for (const auto& [symbol, contribution] : run.rows_m_s)
            found.rows_m_s[symbol] += contribution / n;
        found.bias_limit_m_s += run.bias_limit_m_s / n;
        found.optimum.white_m_s += run.optimum.white_m_s / n;
        found.optimum.slow_m_s += run.optimum.slow_m_s / n;
        found.optimum.motion_m_s += run.optimum.motion_m_s / n;
        for (std::size_t i = 0; i < run.judged.size(); ++i) {
            found.expanded_m_s[i] += run.judged[i].expanded_m_s / n;
            found.rms_m_s[i] += run.judged[i].error_m_s * run.judged[i].error_m_s / n;
        }
    }
    for (double& square : found.rms_m_s)
        square = std::sqrt(square);
    return found;
}

std::string usefulness_table(const WitnessCell& cell, const Usefulness& found) {
    std::string text = fmt::format(
        "Lasting errors {:g} of what is stated; {} runs; km/h\n"
        "row       stated    optimal\n",
        cell.part, found.runs);
    for (const auto& [symbol, stated_m_s] : found.rows_m_s) {
        // What the simulation does not have, whoever knows it states as nothing.
        const double optimal_m_s = symbol == "w"   ? found.optimum.white_m_s
                                   : symbol == "b" ? found.optimum.slow_m_s
                                   : symbol == "j" ? found.optimum.motion_m_s
                                                   : 0.0;
        text += fmt::format("{:<8} {:8.4f} {:8.4f}\n", symbol, 3.6 * stated_m_s, 3.6 * optimal_m_s);
    }
    text += fmt::format("limit    {:8.4f} {:8.4f}\n\nwitness             U, k = 2   2 rms\n",
                        3.6 * found.bias_limit_m_s, 0.0);
    for (std::size_t i = 0; i < found.expanded_m_s.size(); ++i)
        text += fmt::format("{:<18} {:9.4f} {:7.4f}\n", study_heard_names[i],
                            3.6 * found.expanded_m_s[i], 7.2 * found.rms_m_s[i]);
    return text;
}

}  // namespace runcert
