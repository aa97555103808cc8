#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "schemas/windows/windows.h"

// Whether whole certificates by positions hold the true speed, by kinds of time-correlated errors.

namespace runcert {

/// A stationary error of an axis. Its correlation times take turns, with the size kept.
struct StudySlowError {
    double sigma_m = 0.0;
    std::vector<double> tau_s = {1.0};
    double turn_s = std::numeric_limits<double>::infinity();  ///< how long each of them lasts
};

/// A straight run at 10 Hz, 14 s of it at 50 m/s, and the errors of its positions.
struct IntervalCell {
    std::string name = {};
    double white_m = 0.003;
    double stated_m = 0.003;
    std::vector<StudySlowError> slow = {};   ///< added, of both axes
    std::vector<StudySlowError> north = {};  ///< instead, of north; empty: as of both
    double wave_m = 0.0;       ///< amplitude of a wave along the track, from a random phase on
    double wave_s = 6.0;       ///< its period
    bool square_wave = false;  ///< it jumps
    FixType fix = FixType::fixed;
    bool floats = false;    ///< float ambiguities from half of the fast stretch on
    bool vertical = false;  ///< a fall, by heights alone
};
const std::vector<IntervalCell>& interval_cells();

/// Lengths of the windows, s.
inline constexpr std::array interval_lengths_s{2.0, 3.0, 5.0, 10.0};

/// The fastest windows of one length in the runs of a cell. Speeds in m/s.
struct IntervalSummary {
    std::int64_t runs = 0, certified = 0, held = 0;
    std::int64_t held_by_noise = 0;  ///< by rows w, b, j and o alone, and the limit of the bias
    double mean_error = 0.0, mean_expanded = 0.0;
    double mean_slow = 0.0;   ///< row b
    double mean_ideal = 0.0;  ///< twice the uncertainty of the smoother that knows the noise; 0
                              ///< where the noise is none that it can know

    double held_part() const { return part(held); }
    double part(std::int64_t count) const {
        return static_cast<double>(count) / static_cast<double>(certified);
    }
};
std::array<IntervalSummary, interval_lengths_s.size()> study_intervals(const IntervalCell& cell,
                                                                       std::int64_t runs,
                                                                       std::uint64_t seed,
                                                                       unsigned threads = 0);

std::string interval_heading();
/// A line for each length.
std::string interval_lines(const IntervalCell& cell,
                           const std::array<IntervalSummary, interval_lengths_s.size()>& summaries);

}  // namespace runcert
