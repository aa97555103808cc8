#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>

#include "core/random.h"
#include "simulation/inertial_run.h"

namespace runcert {

/// The simulator's steps of time.
inline constexpr int ticks_hz = 400;
inline constexpr double tick_s = 1.0 / ticks_hz;

/// Velocity and attitude of a craft, and the ground that it is on, in east, north, up.
struct CraftState {
    Eigen::Vector3d velocity_m_s;
    Eigen::Matrix3d enu_from_body;
    Eigen::Vector3d ground_normal;
};

/// The simulated oval: one lap, and how far along it (m) a turn is: 0 on a straight, 1 in full.
inline constexpr double oval_lap_m = 2.0 * (600.0 + 320.0 * std::numbers::pi + 150.0);
double oval_bend(double way_m);
/// How far its ground leans to the left there (rad).
double oval_bank(double way_m);

/// Velocity and attitude of the craft of a spec, tick by tick.
class CraftMotion {
  public:
    /// The phases of its swings are drawn. The spec must outlive it.
    CraftMotion(const InertialRunSpec& spec, RandomGenerator& random);

    /// Those at a tick; to be asked for in order, since the way along an oval is summed.
    CraftState at(std::int64_t tick);

  private:
    double roll(double time_s) const;
    double pitch(double time_s) const;
    double swinging(double speed_m_s) const;
    CraftState on_the_lake(double time_s) const;
    CraftState on_the_oval(double time_s);

    const InertialRunSpec& spec_;
    double phases_[8] = {};
    double way_m_;
    double course_;  ///< rad, clockwise from north
};

}  // namespace runcert
