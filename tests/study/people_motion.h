#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/random.h"

namespace runcert {

/// What a craft truly did in the plane, every 10 ms from time 0 on.
struct TruePath {
    static constexpr double step_s = 0.01;
    std::vector<Eigen::Vector2d> positions_m;
    std::vector<Eigen::Vector2d> velocities_m_s;

    double length_s() const { return static_cast<double>(positions_m.size() - 1) * step_s; }
    /// At the step nearest to a time; of a time outside the path, at its nearer end.
    const Eigen::Vector2d& position(double time_s) const { return positions_m[index(time_s)]; }
    const Eigen::Vector2d& velocity(double time_s) const { return velocities_m_s[index(time_s)]; }
    /// Displacement from one time to a later one over the time between them, m/s.
    double speed_m_s(double from_s, double to_s) const;
    /// The largest displacement over time of all stretches of that duration that begin at a
    /// multiple of the interval, m/s.
    double fastest_m_s(double lasting_s, double interval_s) const;

  private:
    std::size_t index(double time_s) const;
};

/// A session of somebody on a board: rests, runs of 6 to 18 m/s with gusts and a wandering course,
/// and turns of 120 to 180 degrees between them. A crash ends the last run within a second, 20 to
/// 60 s before the end.
TruePath random_session(double length_s, bool crash, RandomGenerator& random);

}  // namespace runcert
