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
    double distance_m = 0.0;  ///< from the first gate, along the course
    /// Of the craft there, by its positions: for the little that a window begins or ends beside the
    /// gate, and for the direction of the way between two.
    Eigen::Vector2d position_m = Eigen::Vector2d::Zero();
    double speed_m_s = 0.0;
    double acceleration_m_s2 = 0.0;  ///< in the direction of travel
    std::int64_t stretch = 0;        ///< nothing is known of the way between two
    /// What the distance is uncertain by beside the errors of all, from the stretch's first on: by
    /// what lasts, and by what does not.
    double lasting_sigma_m = 0.0;
    double variance_m2 = 0.0;
};

/// The craft at a time, as the passage of a gate at no distance; nothing where the track tells
/// nothing near it.
std::optional<GatePassage> passage_at(const Track& track, double time_s);

/// The ways between neighbouring passages of one stretch.
std::vector<Way> ways_between(const std::vector<GatePassage>& passages);

/// Of what changes the acceleration between two measurements (standard deviation).
inline constexpr double sigma_jerk_m_s3 = 4.0;

struct GateErrors {
    double sigma_distance_m = 0.0;  ///< of the distance between two gates
    double sigma_time_s = 0.0;      ///< of one passage
};

/// Surveyed timing gates on a straight course as a witness: the distance between the gates nearest
/// to both instants, a quarter of a second away at most, moved to the instants by speed and
/// acceleration. Across the course they say nothing.
class GateWitness final : public Witness<2> {
  public:
    /// Passages with increasing times.
    GateWitness(std::vector<GatePassage> passages, const GateErrors& errors);

    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    std::optional<double> path_between(double from_s, double to_s) const override;

    /// Whether the ways between neighbouring gates are those between the positions there, more
    /// exactly than the errors stated for the gates and the least that positions err by would let
    /// them be but once in a hundred times.
    bool agrees_too_well() const;

  private:
    const GatePassage* nearest(double time_s) const;

    std::vector<GatePassage> passages_;
    GateErrors errors_;
};

/// Timing gates as a witness; `passages` are times and distances (m). Gates that the track does not
/// pass in its arcs are left out; nothing where fewer than two are left.
std::optional<GateWitness> gate_witness(std::span<const TimedValue> passages,
                                        const GateErrors& errors, const Track& track);

}  // namespace runcert
