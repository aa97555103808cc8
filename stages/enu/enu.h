#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "schemas/enu/frame_origin.h"

namespace runcert {

/// Finds the origin where none is stated, in one pass over a recording: the first fixed position
/// of the place where most of it was recorded, else the first of any kind there.
///
/// A first position that is wrong by half the earth is outvoted: a place that more than half of
/// the positions share is found by the majority vote of [BM91] in constant memory.
class FirstPosition {
  public:
    /// Takes in the next row.
    void see(const Observation& row);
    const std::optional<Geodetic>& position() const { return fixed_ ? fixed_ : any_; }

  private:
    std::optional<LocalFrame> place_;
    long votes_ = 0;
    std::optional<Geodetic> fixed_, any_;
};

/// Finds the places of a recording, in one pass over it: where the craft stayed for 30 positions,
/// more than 100 km from the origin of the place before, or more than 20 km from where it was
/// before an interruption of a minute. Fewer positions so far away are outliers.
class Places {
  public:
    explicit Places(const Geodetic& origin);
    void see(const Observation& row);

    /// The places other than the origin's, in order of time. One near a place found before takes
    /// over its origin.
    std::vector<FramePlace> found() const;

  private:
    /// A place, or what may become one.
    struct Stay {
        ElapsedTime from;
        Geodetic origin;
        Eigen::Vector3d origin_m;  ///< Earth-centred
        int positions = 0;
    };
    bool is_elsewhere(ElapsedTime time, const Eigen::Vector3d& ecef_m) const;
    void begin_place();

    Stay home_, here_;
    std::optional<Stay> elsewhere_;
    std::optional<ElapsedTime> seen_;  ///< here, at
    Eigen::Vector3d seen_m_ = Eigen::Vector3d::Zero();
    std::vector<Stay> places_;
};

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
    void set_receiver_positions(std::vector<FramePlace> places);

    const std::optional<FrameOrigin>& origin() const { return origin_; }

    /// A position far from the origin keeps its place: whether it is an outlier is screening's to
    /// say.
    EnuEpoch operator()(const Observation& row);

    /// To be called after the last row. Failure if more than half of the positions, and all but
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
