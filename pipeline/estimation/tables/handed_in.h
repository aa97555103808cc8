#pragma once

#include <optional>
#include <vector>

#include "estimation/gate_witness.h"
#include "estimation/tables/recorded_velocities.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// A measured value at a time (s) from the recording's first epoch.
struct TimedValue {
    double time_s = 0.0;
    double value = 0.0;
};

/// A wheel's speed as a witness, and what was estimated of it beside the positions.
struct WheelWitness {
    VelocityWitness<2> motion;
    double scale = 1.0;  ///< that its speeds are multiplied by
    double sigma_scale = 0.0;
    double delay_s = 0.0;  ///< of its speeds behind the positions
    double sigma_delay_s = 0.0;
};

/// The speed of a wheel along the direction of travel. Its delay (within a second either way) and
/// its scale are those with which its speeds fit the smoothed ones best; its errors are estimated
/// as those of recorded velocities are. A wrong scale that lasts it cannot see. Nothing where fewer
/// than 30 smoothed epochs have a speed of the wheel, or nothing bounds its errors.
std::optional<WheelWitness> wheel_witness(const std::vector<TimedValue>& speeds_m_s,
                                          const ScreenedTable& screened,
                                          const TrajectoryTable& trajectory, double jerk_density);

/// Timing gates as a witness; `passages` are times and distances (m). Gates that the trajectory
/// does not pass in its arcs are left out; nothing where fewer than two are left.
std::optional<GateWitness> gate_witness(const std::vector<TimedValue>& passages,
                                        const GateErrors& errors,
                                        const TrajectoryTable& trajectory);

}  // namespace runcert
