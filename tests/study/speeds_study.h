#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "people_recording.h"
#include "speeds_recording.h"

// What speeds of recorded velocities are worth.

namespace runcert {

/// Honest errors at 1 to 20 Hz, stated too small, of scale, filtered, in bursts and single samples;
/// beside positions that follow the velocities, and made from them; and of equal legs.
const std::vector<SpeedsCell>& speeds_cells();

/// By one rule. A certified window, m/s: its speed, the mean of the true ones at its samples, and
/// U.
struct CertifiedSpeed {
    std::string rule;
    std::string refusal = {};  ///< its reason in the first words, empty if certified
    double speed = 0.0;
    double truth = 0.0;
    double truth_before = 0.0;  ///< the same of the time by which the device's filter is late
    double expanded = 0.0;
    bool falsely_beaten = false;  ///< the outcome for a record of the true speed

    bool certified() const { return refusal.empty(); }
    double error() const { return speed - truth; }
};

/// By the rules of 2 s and 10 s of recorded speeds.
std::vector<CertifiedSpeed> certify_speeds(const SpeedsCell& cell, std::uint64_t seed);

/// The same of what people's devices record.
std::vector<CertifiedSpeed> certify_speeds(const PeopleKind& kind, std::uint64_t seed);

/// Of many runs by one rule. Shares are of those certified.
struct SpeedsSummary {
    std::string rule;
    std::int64_t runs = 0, certified = 0;
    double held = 0.0;                        ///< share whose interval holds the truth
    double falsely_beaten = 0.0;              ///< share
    double mean_error = 0.0, sd_error = 0.0;  ///< m/s
    double mean_error_before = 0.0;           ///< m/s, against the truth of before
    double mean_expanded = 0.0;               ///< m/s
    std::map<std::string, std::int64_t> refusals = {};

    /// What is asked of a cell: 94 % held, at most 2.5 % falsely beaten, and a mean error below
    /// 0.3 U. Empty where it has that.
    std::string misses() const;
};

std::vector<SpeedsSummary> study_speeds(
    const std::function<std::vector<CertifiedSpeed>(std::uint64_t)>& certify, std::int64_t runs,
    std::uint64_t seed, unsigned threads = 0);

/// A line for each rule, and for each reason of a refusal.
std::string speeds_lines(const std::string& name, const std::vector<SpeedsSummary>& rules);
std::string speeds_heading();

}  // namespace runcert
