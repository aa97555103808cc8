#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "motion_script.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// The position errors of a study's recording.
struct StudyNoise {
    double white_m = 0.003;      ///< standard deviation of white noise, also what is stated
    double error_sigma_m = 0.0;  ///< of a steady Gauss-Markov error beside it
    double error_tau_s = 1.0;
    bool error_along_only = false;  ///< that error has no part across the direction of travel
    FixType fix = FixType::fixed;
};

/// What a study records: the run of [DHD22] towards north-east, and on it random motion of a known
/// jerk density.
struct StudyRun {
    double rate_hz = 10.0;
    double length_s = 60.0;
    double jerk_density = 1.0;  ///< m s^-2.5; 0 for the run of the paper alone
    /// Time constant, s, with which the random motion returns to the run (critically damped);
    /// infinite where it does not: over a minute it then leaves what any craft can do.
    double return_time_s = std::numeric_limits<double>::infinity();
    /// Not the run once, but forth and back for ever: 45 s of it, the same as braking, and back.
    bool shuttle = false;
    /// In place of that run: what the craft does, length_s and the speeds with it.
    std::shared_ptr<const MotionScript> script = nullptr;
    StudyNoise noise = {};
};

/// A recording and its truth.
struct SimulatedRecording {
    ScreenedTable screened;                     ///< all epochs usable, in one arc
    std::vector<Eigen::Vector2d> truth;         ///< m, one for each row
    std::vector<Eigen::Vector2d> velocity;      ///< m/s
    std::vector<Eigen::Vector2d> acceleration;  ///< m/s^2
};

SimulatedRecording simulate_recording(const StudyRun& run, std::uint64_t seed);

}  // namespace runcert
