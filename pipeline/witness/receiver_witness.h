#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "witness/track.h"
#include "witness/witness.h"

namespace runcert {

/// The motion of the craft's other receiver, by its own estimate, with the current vector between
/// the two antennas subtracted from its position.
template <int Axes>
struct OtherReceiverEpoch {
    double time_s = 0.0;  ///< on the time scale of the positions under test
    PositionVector<Axes> position_m = PositionVector<Axes>::Zero();
    PositionVector<Axes> velocity_m_s = PositionVector<Axes>::Zero();
    PositionVector<Axes> acceleration_m_s2 = PositionVector<Axes>::Zero();
    /// Includes the uncertainty of the vector between the antennas.
    PositionMatrix<Axes> covariance_m2 = PositionMatrix<Axes>::Identity();
    std::int64_t stretch = 0;  ///< epochs of different stretches are never joined
};

/// A second receiver as a witness of the first. Between its epochs, displacements use polynomials
/// of the fifth degree through position, velocity and acceleration.
///
/// It cannot see what disturbs both receivers: errors of the base station, the atmosphere, a wrong
/// frame.
template <int Axes>
class ReceiverWitness final : public Witness<Axes> {
  public:
    /// The times of the epochs must increase. Between two that are more than `longest_step_s`
    /// apart, the position is unknown.
    ReceiverWitness(std::vector<OtherReceiverEpoch<Axes>> epochs, double longest_step_s);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    /// Sum of the straight lines between epochs.
    std::optional<double> path_between(double from_s, double to_s) const override;

  private:
    /// The position at a time, with the epoch at or before it.
    struct InterpolatedPosition {
        std::size_t epoch = 0;
        PositionVector<Axes> position_m;
        PositionMatrix<Axes> covariance_m2;
    };
    std::optional<InterpolatedPosition> position_at(double time_s) const;

    std::vector<OtherReceiverEpoch<Axes>> epochs_;
    double longest_step_s_;
};

/// Another receiver of the same craft as a witness of the positions of `own`. The vector between
/// the antennas is assumed to turn with the craft, which points along the other receiver's track to
/// 0.015 rad. With antennas more than 50 m apart it is assumed not to turn. Nothing is known
/// between two epochs more than one and a half intervals apart. Empty if a time is relative,
/// only one of the two has geodetic coordinates, or the other has no estimate.
template <int Axes>
std::optional<ReceiverWitness<Axes>> receiver_witness(const Track& other, const Track& own);

}  // namespace runcert
