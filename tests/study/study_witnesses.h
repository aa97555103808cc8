#pragma once

#include <string>
#include <vector>

#include "core/random.h"
#include "core/timed_value.h"
#include "schemas/enu/declared.h"
#include "simulated_arc.h"
#include "witness/roster.h"

// What witnesses record of a simulated run.

namespace runcert {

/// First-order Gauss-Markov, two axes, from one epoch to the next at a rate.
class SlowError {
  public:
    SlowError(double sigma, double tau_s, double rate_hz, RandomGenerator& random);
    Eigen::Vector2d next();

  private:
    Eigen::Vector2d normals();

    double decay_, sigma_;
    RandomGenerator& random_;
    Eigen::Vector2d now_;
};

/// Speeds with white noise, m/s, at all epochs.
std::vector<TimedValue> wheel_of(const SimulatedRecording& run, double scale, double noise_m_s,
                                 RandomGenerator& random);

/// Standard uncertainties of gates: of the distance between two, and of a passage.
inline constexpr double study_gate_m = 0.003, study_gate_s = 1e-4;

/// Passages of gates so far apart, while the craft is at least so fast; values are distances.
std::vector<TimedValue> gates_of(const SimulatedRecording& run, double apart_m,
                                 double least_speed_m_s, RandomGenerator& random);

/// Velocities with white noise and a Gauss-Markov error of 20 s, m/s.
void record_velocities(const SimulatedRecording& run, double slow_m_s, double noise_m_s,
                       RandomGenerator& random, EnuTable& table);

/// Standard deviation of the white noise of positions, m.
inline constexpr double study_white_m = 0.008;

/// What a receiver 0.9 m behind the first records, with a Gauss-Markov error of 5 s, m.
EnuTable second_receiver_of(const SimulatedRecording& run, const EnuTable& first, double slow_m,
                            RandomGenerator& random);

/// The direction of all motion in a study's recording.
Eigen::Vector2d study_direction();

void hand_in(const std::string& key, const std::vector<TimedValue>& values, HandedIn& given);

}  // namespace runcert
