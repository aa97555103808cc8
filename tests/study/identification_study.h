#pragma once

#include <string>
#include <vector>

#include "core/random.h"
#include "power_study.h"

namespace runcert {

/// One kind and size of error, so many of them in a recording.
struct ErrorScenario {
    Hypothesis kind = Hypothesis::outlier;
    std::size_t epochs = 1;  ///< of a burst
    double size = 0.0;  ///< standard deviations of the cell's noise; m/s of a ramp; s of a shift
    std::int64_t errors = 1;
};

/// Outliers and bursts of 2 to 20 epochs of 3 to 100 standard deviations; one, two and five steps
/// of 3 to 300; ramps; shifts of one sample and of 20 ms.
std::vector<ErrorScenario> error_scenarios(double rate_hz);

/// How often errors of a scenario were found, dated within one epoch, and called what they are; how
/// many good epochs were left out, of all recordings.
struct Identification {
    ErrorScenario scenario;
    std::int64_t recordings = 0;
    Share found;
    Share dated;
    Share named;
    std::int64_t left_out = 0;
    std::int64_t spoilt = 0;  ///< recordings of which good epochs were left out
};

/// Errors at random times and in random directions in recordings of a minute.
Identification study_identification(const StudyRun& cell, const ErrorScenario& scenario,
                                    const ScreeningStudyOptions& options);

/// A heading and a line for each.
std::string identification_table(const StudyRun& cell, const std::vector<Identification>& lines);

/// An error of that kind and size (as of `ErrorScenario`) in a random direction.
SupposedError random_error(const ErrorScenario& scenario, const StudyNoise& noise,
                           std::size_t first, RandomGenerator& random);

}  // namespace runcert
