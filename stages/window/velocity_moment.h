#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"
#include "stages/window/best_window.h"
#include "witness/certifiable.h"
#include "witness/window_speed.h"

// Positions at the moments of recorded velocities, which may be delayed relative to them.

namespace runcert {

/// A position on a track between samples, and the velocity there.
struct TrackPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

/// The smoothed track of an arc along the axes that a rule counts; the samples are the arc's rows.
class SmoothedTrack {
  public:
    SmoothedTrack(const TrajectoryTable& trajectory, const ArcRows& arc, Dimension dimension)
        : trajectory_(trajectory), arc_(arc), axes_(axes_of_speed(dimension)) {}

    const TrajectoryEpoch& row(std::size_t k) const { return trajectory_.rows[arc_.rows[k]]; }
    double time_s(std::size_t k) const { return row(k).time.seconds(); }

    Eigen::Vector3d position(std::size_t k) const;
    Eigen::Vector3d velocity(std::size_t k) const;

    /// The track at a time, on the cubic through both neighbouring samples. Before the first
    /// sample and after the last one, it is that sample.
    TrackPoint at(double time_s) const;

  private:
    const TrajectoryTable& trajectory_;
    const ArcRows& arc_;
    Eigen::Vector3d axes_;
};

/// The delay of the recorded velocities relative to the positions, as far as screening determined
/// it, otherwise 0.
double delay_of_velocities(const ScreenedTable& screened);

/// Standard uncertainty of that delay, s. For an undetermined delay it covers the whole search
/// range.
double sigma_of_delay(const ScreenedTable& screened);

/// Moves the positions of a series of recorded speeds to the moments of these speeds, one delay
/// earlier, by cubics between samples. No window may begin or end where the series has no position
/// for it.
void move_to_moments(SampleSeries& series, double delay_s);

/// A recorded speed and the smoothed track at the same moment.
struct ComparedSpeed {
    double time_s = 0.0;
    double recorded_m_s = 0.0;
    double smoothed_m_s = 0.0;
    double recorded_m = 0.0;  ///< distance by integrating recorded speeds, from an arbitrary start
    double smoothed_m = 0.0;  ///< distance along the smoothed track
    TrackPoint track = {};
    std::optional<double> stated_m_s = std::nullopt;  ///< stated standard uncertainty
    std::int64_t stretch = 0;  ///< samples of different stretches are not compared
};

/// The compared speeds of all usable epochs whose speed belongs to their own moment, in order of
/// time. A stretch ends with its arc, at an epoch that is left out, and at a step longer than a
/// second and than one and a half intervals.
std::vector<ComparedSpeed> compared_speeds(const ScreenedTable& screened,
                                           const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs, Dimension dimension);

/// The speed by the rule's definition from the smoothed positions at the moments of a window's
/// recorded speeds. A path follows the cubics through positions and velocities, so that turns
/// between epochs are not cut short. Its excess over the chords is a bound on its error.
///
/// The uncertainty is that of both ends, or that of the velocities if it is smaller, and always for
/// means of speeds. It includes the rule's floor for time-correlated errors at either end, and the
/// change of the speed within the uncertainty of the delay. `window` are its compared speeds.
SpeedEstimate track_speed(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                          const ArcRows& arc, const Profile& profile, const FoundWindow& found,
                          std::span<const ComparedSpeed> window);

}  // namespace runcert
