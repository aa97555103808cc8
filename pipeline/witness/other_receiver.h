#pragma once

#include <optional>

#include "witness/receiver_witness.h"
#include "witness/track.h"

namespace runcert {

/// Another receiver of the same craft as a witness of the positions of `own`. The vector between
/// the two antennas is taken to turn with the craft, which points along the other receiver's track,
/// to a hundredth and a half of a radian; of antennas more than 50 m apart as not to turn. Between
/// two epochs that are more than one and a half intervals apart nothing is known. Nothing where a
/// time is relative, only one of the two has a place on the Earth, or the other has no estimate.
template <int Axes>
std::optional<ReceiverWitness<Axes>> receiver_witness(const Track& other, const Track& own);

}  // namespace runcert
