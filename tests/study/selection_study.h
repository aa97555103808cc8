#pragma once

#include <cstdint>
#include <string>

namespace runcert {

/// Mean of the chosen window's stated speed less its true speed, over many runs, with its standard
/// error; without correction, and with the reported bias taken off (m/s).
struct SelectionStudy {
    double noise_m = 0.0;
    std::int64_t runs = 0;
    double mean_mps = 0.0;
    double standard_error_mps = 0.0;
    double corrected_mean_mps = 0.0;
    double corrected_standard_error_mps = 0.0;
};

/// Runs of [DHD22] at 10 Hz for 45 s, whose last 10 s are a plateau, through the whole of smoothing
/// and window search, under the rule for 3 s.
SelectionStudy study_selection(double noise_m, std::int64_t runs, std::uint64_t seed);

std::string selection_line(const SelectionStudy& study);

}  // namespace runcert
