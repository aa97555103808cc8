#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "inertial/inertial_smoother.h"
#include "schemas/attempt/attempt.h"
#include "witness/track.h"
#include "witness/witness.h"
#include "witness/witnessed_spans.h"

// A wheel, a gate and a radar gun measure the craft. Positions, phases and another receiver are
// those of an antenna, which a rolling and pitching craft swings.

namespace runcert {

/// What is known of the antenna's motion against the craft's reference point. If nothing is, the
/// antenna is assumed to move as the craft does.
struct AntennaSwing {
    /// Null where it is not consistent with the positions.
    std::shared_ptr<const InertialSolution> solution = nullptr;
    std::optional<AntennaMotion> bound = std::nullopt;  ///< used where there is no solution

    bool is_known() const { return solution != nullptr || bound.has_value(); }
};

/// The most (m/s) that an antenna at a height on a craft that rolls and pitches may add to a speed
/// of the craft over `duration_s`: first order in pitch, in roll only as far as the craft does not
/// head where it goes. A path, or a mean of speeds, also has what the antenna swings across.
double swing_bound_m_s(const AntennaMotion& motion, double speed_m_s, double duration_s,
                       bool by_path);

/// The track of the reference point by the solution, without epochs that it does not reach. Without
/// a solution it is the antenna's.
Track track_of_craft(const Track& track, const AntennaSwing& swing);

/// The reference point at the times of these positions, without those that the solution does not
/// reach. Without a solution they are the antenna's, as uncertain as the bound says.
std::vector<TimedPosition<2>> positions_of_craft(std::span<const TimedPosition<2>> positions,
                                                 const AntennaSwing& swing);

/// A sentence on how a witness of the craft's motion was compared with the antenna's.
std::string swing_text(std::string_view witness, const AntennaSwing& swing);

/// A witness of the craft's motion as one of the antenna's. The solution adds by how much farther
/// the antenna moved, with its covariance; nothing is said where that is not known. A bound makes
/// the displacement that much less certain (rectangular).
class WitnessOfCraft final : public Witness<2> {
  public:
    WitnessOfCraft(std::shared_ptr<const Witness<2>> craft, AntennaSwing swing)
        : craft_(std::move(craft)), swing_(std::move(swing)) {}

    std::optional<WitnessedMotion<2>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override { return craft_->covered(); }
    std::optional<TimeSpan> enclosing(double from_s, double to_s) const override {
        return craft_->enclosing(from_s, to_s);
    }
    std::optional<double> path_between(double from_s, double to_s) const override;

  private:
    std::shared_ptr<const Witness<2>> craft_;
    AntennaSwing swing_;
};

}  // namespace runcert
