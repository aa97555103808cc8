#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "simulated_attempt.h"

namespace runcert {

const std::vector<WitnessCell>& witness_cells();

/// By witness, in the order of `StudyHeard`.
using WitnessedRuns = std::array<WitnessedRun, study_heard_names.size()>;

struct WitnessStudyOptions {
    std::int64_t runs = 2000;   ///< without a fault, a cell
    std::int64_t faults = 500;  ///< with one, a cell
    std::uint64_t seed = 1;
    unsigned threads = 0;
    std::optional<StudyHeard> only = std::nullopt;  ///< beside none
};

/// All runs of a cell. A fault is a drift of 3 s, along the track, in one of the windows; as fast
/// as anything up to what screening leaves with the power stated for it.
struct WitnessCellRuns {
    std::vector<WitnessedRuns> clean, faulted;
};
WitnessCellRuns study_witnesses(const WitnessCell& cell, const WitnessStudyOptions& options);

/// Of one witness. Shares are of the runs that are certified.
struct WitnessLine {
    double expanded_m_s = 0.0;  ///< mean, without a fault
    double probability = 0.0;   ///< mean, without a fault
    double tail_m_s = 0.0;      ///< mean, without a fault
    double widened = 0.0;       ///< clean runs whose interval is wider than without a witness
    double refused = 0.0;       ///< of clean runs
    double held = 0.0;          ///< of clean runs
    double faults_refused = 0.0;
    double faults_held = 0.0;
    double faults_off = 0.0;  ///< beyond the interval by more than 0.05 km/h, of all faulted
    double coverage = 0.0;    ///< clean and faulted, weighed by the prior
};
WitnessLine witness_line(const WitnessCell& cell, const WitnessCellRuns& runs, StudyHeard heard);

std::string witness_table(const WitnessCell& cell, const WitnessCellRuns& runs);

}  // namespace runcert
