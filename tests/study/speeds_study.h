#pragma once

#include <functional>
#include <string>
#include <vector>

#include "people_recording.h"

// What speeds of recorded velocities are worth.

namespace runcert {

/// How the positions beside recorded speeds come about.
enum class SpeedsPositions {
    independent,  ///< code positions that wander by half a metre
    integrated    ///< from the recorded velocities, and a little noise
};

/// A session of ten minutes whose velocities have white noise and a lasting error of 0.05 m/s (20 s)
/// along each axis, and state 0.5 m/s.
struct SpeedsCell {
    double rate_hz = 10.0;
    double white_m_s = 0.05;
    double filter_s = 0.0;  ///< time constant of a filter of the velocities; 0: none
    SpeedsPositions positions = SpeedsPositions::independent;
};

/// White noise of 0.05, 0.1 and 0.3 m/s at 10 Hz and at 1 Hz, 0.1 and 0.3 m/s filtered over 0.3 s,
/// and 0.1 m/s with positions that follow.
std::vector<SpeedsCell> speeds_cells();
std::string cell_name(const SpeedsCell& cell);

/// A certified window, m/s: its speed, the mean of the true ones at its samples, and U.
struct CertifiedSpeed {
    std::string rule;
    double speed = 0.0;
    double truth = 0.0;
    double expanded = 0.0;

    double error() const { return speed - truth; }
};

/// By the rules of 2 s and 10 s of recorded speeds; one for each that is certified.
std::vector<CertifiedSpeed> certify_speeds(const SpeedsCell& cell, std::uint64_t seed);

/// The same of what people's devices record.
std::vector<CertifiedSpeed> certify_speeds(const PeopleKind& kind, std::uint64_t seed);

/// Of many runs by one rule.
struct SpeedsSummary {
    std::string rule;
    std::int64_t certified = 0;
    double held = 0.0;  ///< share whose interval holds the truth
    double mean_error = 0.0, sd_error = 0.0, mean_expanded = 0.0;  ///< m/s
};

std::vector<SpeedsSummary> study_speeds(
    const std::function<std::vector<CertifiedSpeed>(std::uint64_t)>& certify, std::int64_t runs,
    std::uint64_t seed, unsigned threads = 0);

/// A line for each rule, km/h.
std::string speeds_lines(const std::string& name, const std::vector<SpeedsSummary>& rules);

}  // namespace runcert
