#pragma once

#include <optional>
#include <string>

#include "core/geodesy.h"
#include "schemas/enu/enu.h"
#include "stages/enu/places.h"

namespace runcert {

/// Turns the rows of a recording, one by one, into those of the local frame.
///
/// WGS 84 positions become local east, north, up (m) at the origin of their place; stated
/// covariances and recorded velocities are rotated from the east-north-up of each position to that
/// of the origin. Engineering coordinates pass through unchanged and stay declared as not
/// georeferenced.
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

    /// To be called before the first row, where there is an origin.
    void set_places(std::vector<FramePlace> places);

    const std::optional<FrameOrigin>& origin() const { return origin_; }

    /// A position far from the origin keeps its place: whether it is an outlier is screening's to
    /// say.
    EnuEpoch operator()(const Observation& row);

    /// To be called after the last row. Failure where more than half of the positions, and all but
    /// few, lie more than 100 km from the origin.
    void finish() const;

  private:
    EnuEpoch from_the_earth(const Observation& row);

    bool vertical_;
    std::optional<FrameOrigin> origin_;
    std::optional<PlaceFrames> frames_;
    long positions_ = 0, far_ = 0;
    std::string first_far_;
    double first_far_m_ = 0.0;
};

/// A whole recording in the local frame, at `stated_origin` or else its first position. Failures as
/// above. Where heights were not measured, `up` and all that belongs to it are left empty. The
/// header is the caller's.
EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin);

}  // namespace runcert
