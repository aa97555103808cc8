#pragma once

#include <optional>

#include "core/geodesy.h"
#include "schemas/enu/enu.h"

namespace runcert {

/// Finds the origin where none is stated: the first fixed position, else the first of any kind,
/// because one taken from a solution without a fix could be far away.
class FirstPosition {
  public:
    /// Takes in the next row; false where no later one can change the result.
    bool see(const Observation& row);
    const std::optional<Geodetic>& position() const { return fixed_ ? fixed_ : any_; }

  private:
    std::optional<Geodetic> fixed_, any_;
};

/// Turns the rows of a recording, one by one, into those of the local frame.
///
/// WGS 84 positions become local east, north, up (m) at an origin; stated covariances and recorded
/// velocities are rotated from the east-north-up of each position to that of the origin.
/// Engineering coordinates pass through unchanged and stay declared as not georeferenced.
class ToLocalFrame {
  public:
    /// `stated` is the attempt's origin; where there is none, `first` is the recording's first
    /// position. Failure for engineering coordinates with a stated origin, and for others without
    /// any.
    ToLocalFrame(const RecordingFacts& facts, const std::optional<Geodetic>& stated,
                 const std::optional<Geodetic>& first);

    /// Whether the first position must be looked for.
    static bool needs_first_position(const RecordingFacts& facts,
                                     const std::optional<Geodetic>& stated) {
        return facts.georeferenced && !stated;
    }

    const std::optional<FrameOrigin>& origin() const { return origin_; }

    /// Failure for a position more than 100 km from the origin.
    EnuEpoch operator()(const Observation& row) const;

  private:
    bool vertical_;
    std::optional<FrameOrigin> origin_;
    std::optional<LocalFrame> frame_;
};

/// A whole recording in the local frame, at `stated_origin` or else its first position. Failures as
/// above. Where heights were not measured, `up` and all that belongs to it are left empty. The
/// header is the caller's.
EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin);

}  // namespace runcert
