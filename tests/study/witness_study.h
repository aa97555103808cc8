#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace runcert {

/// The run of examples/salt_lake, many times, with raw phases beside it and an error that positions
/// and phases share, as of multipath: first-order Gauss-Markov, each axis.
struct WitnessStudyOptions {
    std::int64_t runs = 500;
    std::uint64_t seed = 1;
    unsigned threads = 0;
    double common_m = 0.005;
    double common_time_s = 20.0;
};

/// The fastest 3 s of one run, as certified.
struct WitnessedRun {
    double error_m_s = 0.0;     ///< measured speed less the true one of the same window
    double expanded_m_s = 0.0;  ///< expanded uncertainty, coverage factor 2
};

/// One run by positions alone, and with its phases.
struct WitnessStudyRun {
    WitnessedRun alone, beside;
    bool refused = false;  ///< the phases contradicted the positions
};

std::vector<WitnessStudyRun> study_witness(const WitnessStudyOptions& options);

/// Coverage and mean expanded uncertainty of both.
std::string witness_table(const WitnessStudyOptions& options,
                          const std::vector<WitnessStudyRun>& runs);

}  // namespace runcert
