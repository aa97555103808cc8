#pragma once

#include <cstdint>
#include <string>

#include "simulated_arc.h"

namespace runcert {

/// Mean of the chosen window's stated speed less its true speed, over many runs, with its standard
/// error (m/s).
struct MeanError {
    double mean_m_s = 0.0;
    double standard_error_m_s = 0.0;
};

/// What choosing the fastest window leaves in its speed: without correction, with the bias by the
/// errors as fitted taken off, and with the reported one, as it is certified; and how often the
/// measured speed is within its expanded uncertainty.
struct SelectionStudy {
    StudyRun run;
    std::int64_t runs = 0;
    MeanError uncorrected;
    MeanError fitted;
    MeanError reported;
    double half_range_m_s = 0.0;  ///< mean of what the certificate allows about the reported bias
    std::int64_t held = 0;
};

/// Runs of [DHD22] for 45 s, whose last 10 s are a plateau, with this white noise.
StudyRun selection_run(double noise_m, double rate_hz = 10.0, double jerk_density = 0.0);

/// Recordings of a run through the whole of smoothing and window search, under the rule for 3 s.
SelectionStudy study_selection(const StudyRun& run, std::int64_t runs, std::uint64_t seed);

std::string selection_line(const SelectionStudy& study);

}  // namespace runcert
