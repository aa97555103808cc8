#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/timed_value.h"
#include "witness/copies.h"
#include "witness/track.h"
#include "witness/witness.h"

namespace runcert {

/// The passage of a timing gate.
struct GatePassage {
    double time_s = 0.0;      ///< on the time scale of the positions
    double distance_m = 0.0;  ///< along the course from the first gate
    /// Position and motion of the craft there, from its positions. They extend the way from the
    /// gate to a nearby instant, and give its direction.
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;  ///< in the direction of travel
    std::int64_t stretch = 0;        ///< between different stretches the way is unknown
    /// Uncertainty of the distance beyond the errors common to all passages, accumulated since the
    /// stretch's first: a lasting part and a variance of independent parts.
    double lasting_sigma_m = 0.0;
    double variance_m2 = 0.0;
};

/// The craft's passage at a time, with distance 0. Empty if the track has no epoch near it.
std::optional<GatePassage> passage_at(const Track& track, double time_s);

/// The ways between neighbouring passages of the same stretch.
std::vector<Way> ways_between(const std::vector<GatePassage>& passages);

/// Standard deviation of the jerk that changes the acceleration between two measurements.
inline constexpr double sigma_jerk_m_s3 = 4.0;

/// Standard uncertainties of timing gates.
struct GateErrors {
    double sigma_distance_m = 0.0;  ///< of the distance between two gates
    double sigma_time_s = 0.0;      ///< of one passage
};

/// Surveyed timing gates on a straight course as a witness. The displacement is the distance
/// between the gates nearest to the two instants, at most a quarter of a second away. Speed and
/// acceleration extend it to the instants. Between other instants the passages that enclose them
/// are known. Gates say nothing about motion across the course.
class GateWitness final : public Witness<2> {
  public:
    /// The times of the passages must increase.
    GateWitness(std::vector<GatePassage> passages, const GateErrors& errors);

    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    std::optional<TimeSpan> enclosing(double from_s, double to_s) const override;
    std::optional<double> path_between(double from_s, double to_s) const override;

    /// Whether the distances between neighbouring gates match those between the positions there too
    /// closely. That is so where chance would allow it only once in a hundred times, given the
    /// errors stated for the gates and the least errors of positions.
    bool agrees_too_well() const;

  private:
    const GatePassage* nearest(double time_s) const;

    std::vector<GatePassage> passages_;
    GateErrors errors_;
};

/// Timing gates as a witness. `passages` are times and distances (m). Gates outside the arcs of the
/// track are left out. Empty if fewer than two are left.
std::optional<GateWitness> gate_witness(std::span<const TimedValue> passages,
                                        const GateErrors& errors, const Track& track);

}  // namespace runcert
