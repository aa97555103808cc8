#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "witness/track.h"
#include "witness/witness.h"

namespace runcert {

/// Where another receiver of the craft was, as its own estimate has it, less the vector between the
/// two antennas as it lies then.
template <int Axes>
struct OtherReceiverEpoch {
    double time_s = 0.0;  ///< on the time scale of the positions that it witnesses
    PositionVector<Axes> position_m = PositionVector<Axes>::Zero();
    PositionVector<Axes> velocity_m_s = PositionVector<Axes>::Zero();
    PositionVector<Axes> acceleration_m_s2 = PositionVector<Axes>::Zero();
    /// Of the position, and of what is not known of the vector between the antennas.
    PositionMatrix<Axes> covariance_m2 = PositionMatrix<Axes>::Identity();
    std::int64_t stretch = 0;  ///< epochs of different ones are never joined
};

/// A second receiver as a witness of the first: its displacement between two instants, between its
/// epochs by polynomials of the fifth degree through position, velocity and acceleration.
///
/// It cannot see what disturbs both: the base station's errors, the atmosphere, a wrong frame.
template <int Axes>
class ReceiverWitness final : public Witness<Axes> {
  public:
    /// Epochs with increasing times. Between two that are further apart than `longest_step_s` it
    /// does not know where the craft was.
    ReceiverWitness(std::vector<OtherReceiverEpoch<Axes>> epochs, double longest_step_s);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    /// Sum of the straight lines between its epochs.
    std::optional<double> path_between(double from_s, double to_s) const override;

  private:
    /// The position at a time, with the epoch at or before it.
    struct Place {
        std::size_t epoch = 0;
        PositionVector<Axes> position_m;
        PositionMatrix<Axes> covariance_m2;
    };
    std::optional<Place> place_of(double time_s) const;

    std::vector<OtherReceiverEpoch<Axes>> epochs_;
    double longest_step_s_;
};

/// Another receiver of the same craft as a witness of the positions of `own`. The vector between
/// the two antennas is taken to turn with the craft, which points along the other receiver's track,
/// to a hundredth and a half of a radian; of antennas more than 50 m apart as not to turn. Between
/// two epochs that are more than one and a half intervals apart nothing is known. Nothing where a
/// time is relative, only one of the two has a place on the Earth, or the other has no estimate.
template <int Axes>
std::optional<ReceiverWitness<Axes>> receiver_witness(const Track& other, const Track& own);

}  // namespace runcert
