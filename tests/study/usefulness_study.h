#pragma once

#include <map>
#include <string>
#include <vector>

#include "simulated_attempt.h"

namespace runcert {

/// What certificates state of runs beside what could be stated of them.
struct Usefulness {
    std::int64_t runs = 0;
    std::map<std::string, double> rows_m_s;  ///< of the budget without a witness: mean, by symbol
    double bias_limit_m_s = 0.0;             ///< mean, without a witness
    /// Mean of what an optimal estimator states that knows the sizes of the positions' errors.
    SimulatedAttempt::Optimum optimum;
    std::vector<double> expanded_m_s;  ///< k = 2, mean, by witness in the order of `StudyHeard`
    std::vector<double> rms_m_s;       ///< of the errors of the stated speeds, by witness
};
Usefulness study_usefulness(const WitnessCell& cell, std::int64_t runs, std::uint64_t seed,
                            unsigned threads);

/// Row by row, then by witness, km/h.
std::string usefulness_table(const WitnessCell& cell, const Usefulness& found);

}  // namespace runcert
