#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/timed_value.h"
#include "estimation/gate_witness.h"
#include "estimation/tables/track.h"
#include "estimation/wheel_motion.h"
#include "estimation/witnessed_spans.h"

namespace runcert {

/// A wheel's speed as a witness, and what was estimated of it beside the positions.
struct WheelWitness {
    WheelMotion motion;
    double scale = 1.0;  ///< that fits the positions of the whole recording best
    double sigma_scale = 0.0;
    double delay_s = 0.0;  ///< of its speeds behind the positions
    double sigma_delay_s = 0.0;
    bool made_from_positions = false;  ///< it has their errors (`keep_to_positions`, or as recorded
                                       ///< speeds that are differences of the positions)
};

/// Speeds of a wheel, m/s, and the scale that was stated for it.
struct WheelSpeeds {
    std::vector<TimedValue> m_s;
    std::optional<double> calibrated_scale = {};
    double sigma_calibrated = 0.0;  ///< relative standard uncertainty of that
};

/// The speed of a wheel along the direction of travel. Its delay (within a second either way) is
/// that with which its speeds fit those of the track best; its scale the calibrated one, or that of
/// other runs (`WheelMotion`); its errors are estimated beside the positions, as those of recorded
/// velocities are. A wrong scale of the positions that lasts it cannot see without a calibration.
/// Nothing where fewer than 30 epochs of the track have a speed of the wheel, or nothing bounds its
/// errors.
std::optional<WheelWitness> wheel_witness(const WheelSpeeds& speeds,
                                          std::span<const TimedPosition<2>> positions,
                                          const Track& track, double jerk_density);

/// Whether speeds (m/s), multiplied by the scale, are differences of these positions or filtered
/// ones (`are_filtered_positions`, `velocities::origin_of_speeds`). Their times are the positions'
/// own `delay_s` later. Integrated speeds are positions, too.
bool are_from_positions(std::span<const TimedValue> speeds,
                        std::span<const TimedPosition<2>> positions, double delay_s,
                        double scale = 1.0);

/// Timing gates as a witness; `passages` are times and distances (m). Gates that the track does not
/// pass in its arcs are left out; nothing where fewer than two are left.
std::optional<GateWitness> gate_witness(std::span<const TimedValue> passages,
                                        const GateErrors& errors, const Track& track);

/// Whether the ways between neighbouring gates are those between the recorded positions there,
/// taken linearly, more exactly than the white noise of these would let them be but once in a
/// hundred times.
bool are_between_positions(std::span<const TimedValue> passages,
                           std::span<const TimedPosition<2>> positions);

}  // namespace runcert
