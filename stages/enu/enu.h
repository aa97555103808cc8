#pragma once

#include <optional>

#include "schemas/enu/enu.h"

namespace runcert {

/// WGS 84 positions to local east, north, up (m) at an origin; stated covariances and recorded
/// velocities are rotated from the east-north-up of each position to that of the origin.
///
/// The origin is `stated_origin`, else the first position of the best kind of solution there is.
/// Local-plane coordinates pass through unchanged and stay declared as not georeferenced; with
/// them a stated origin is a Failure, as is an origin more than 100 km from a position. Where
/// heights were not measured, `up` and all that belongs to it are left empty. The header is the
/// caller's.
EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin);

}  // namespace runcert
