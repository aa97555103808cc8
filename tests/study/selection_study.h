#pragma once

#include <cstdint>
#include <string>

#include "simulated_arc.h"

namespace runcert {

/// Mean of the chosen window's stated speed less its true speed, over many runs, with its standard
/// error; without correction, and with the reported bias taken off, as it is certified (m/s); and
/// how often the certified speed is within its expanded uncertainty.
struct SelectionStudy {
    StudyRun run;
    std::int64_t runs = 0;
    double mean_mps = 0.0;
    double standard_error_mps = 0.0;
    double corrected_mean_mps = 0.0;
    double corrected_standard_error_mps = 0.0;
    std::int64_t held = 0;
};

/// Runs of [DHD22] for 45 s, whose last 10 s are a plateau, with this white noise.
StudyRun selection_run(double noise_m, double rate_hz = 10.0, double jerk_density = 0.0);

/// Recordings of a run through the whole of smoothing and window search, under the rule for 3 s.
SelectionStudy study_selection(const StudyRun& run, std::int64_t runs, std::uint64_t seed);

std::string selection_line(const SelectionStudy& study);

}  // namespace runcert
