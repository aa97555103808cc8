#pragma once

#include <string>
#include <vector>

#include "simulated_arc.h"

namespace runcert {

/// How often a 95 % interval held the true 3 s speed, and how wide it was.
struct Coverage {
    std::int64_t runs = 0;
    std::int64_t held = 0;
    double squares = 0.0;         ///< of the errors in standard uncertainties, their sum
    double half_width_m_s = 0.0;  ///< mean
    double largest_half_width_m_s = 0.0;

    double fraction() const { return static_cast<double>(held) / static_cast<double>(runs); }
    /// 1 where the standard uncertainties are those of the errors.
    double mean_square() const { return squares / static_cast<double>(runs); }
    Coverage& operator+=(const Coverage& other);
};

/// One kind of noise, by four ways to an interval.
struct CoverageCell {
    StudyRun run;
    Coverage white;   ///< white noise of the stated size, as a smoother without more has it
    Coverage known;   ///< the true parameters
    Coverage fitted;  ///< estimated from each recording
    Coverage bound;   ///< the certificate's
};

struct CoverageOptions {
    std::int64_t runs = 200;         ///< with fitted parameters, and the certificate
    std::int64_t runs_known = 2000;  ///< with those known
    double floor_m = 0.008;          ///< of the time-correlated error, in the certificate
    std::uint64_t seed = 1;
};

/// The cells of one rate and motion (m s^-2.5): white noise of 3, 10 and 30 mm, and 8 mm
/// Gauss-Markov with correlation times of 0.5, 2, 10 and 60 s on 3 mm white.
std::vector<CoverageCell> coverage_cells(double rate_hz, double jerk_density = 1.0);

/// Fills a cell: simulated recordings, the 3 s speed from 40 s on, intervals of 1.96 standard
/// uncertainties.
CoverageCell study_coverage(CoverageCell cell, const CoverageOptions& options);

/// The cells as a table, one line each.
std::string coverage_table(const std::vector<CoverageCell>& cells);

}  // namespace runcert
