#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

// What witnesses make of positions that drift, and of velocities that err in scale.

namespace runcert {

/// What is heard beside positions of 10 Hz of a land yacht at 45 to 60 m/s.
struct DriftWitnesses {
    bool gates = false;       ///< each 30 m along the fast stretch
    bool calibrated = false;  ///< a wheel with a scale of 0.2 % (k = 2)
    bool wheel = false;       ///< one without
    bool radar = false;       ///< a speed each 0.4 s in the fast stretch, 0.2 m/s (k = 2)
    bool velocities = false;  ///< of 0.05 m/s
    bool receiver = false;    ///< another one, without the drift
};

struct DriftCell {
    std::string name = {};
    DriftWitnesses heard = {};
    /// Of the positions, along the track, for 6 s in the fast stretch.
    double drift_m_s = 0.0;
    bool while_fast = false;  ///< instead, all the time in proportion to the speed
    double velocity_scale = 1.0;
    bool differenced = false;  ///< the velocities are differences of the positions
    double added_m_s = 0.0;    ///< white noise on these

    /// Whether one of the witnesses finds the drift with a probability of 0.8, by its own
    /// uncertainty. One in proportion to the speed looks like a scale of velocities, and of a wheel
    /// that has none; what is made from the positions finds nothing.
    bool is_seen() const;
};
const std::vector<DriftCell>& drift_cells();

/// The fastest 3 s of one run; speeds in m/s.
struct DriftRun {
    std::string refusal = {};  ///< its reason in the first words, empty if certified
    double error = 0.0;
    double expanded = 0.0;
    bool falsely_beaten = false;  ///< the outcome for a record of the true speed
};
DriftRun certify_drift(const DriftCell& cell, std::uint64_t seed);

/// Shares are of the runs that are certified.
struct DriftSummary {
    std::int64_t runs = 0, certified = 0;
    double held = 0.0, falsely_beaten = 0.0;
    double mean_error = 0.0, mean_expanded = 0.0;  ///< m/s
    std::map<std::string, std::int64_t> refusals = {};

    /// What is asked of a cell: beside sound positions 94 % held, at most 2.5 % falsely beaten and
    /// a mean error below 0.3 U; 90 % held where a drift can be seen. Empty where it has that.
    std::string misses(const DriftCell& cell) const;
};
DriftSummary study_drift(const DriftCell& cell, std::int64_t runs, std::uint64_t seed,
                         unsigned threads = 0);

std::string drift_heading();
/// A line, and one for each reason of a refusal.
std::string drift_lines(const DriftCell& cell, const DriftSummary& summary);

}  // namespace runcert
