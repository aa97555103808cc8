#pragma once

#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "schemas/enu/enu.h"

namespace runcert {

/// m; a plane of no more is what a local frame serves.
inline constexpr double far_m = 100'000.0;

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

    /// Those beside the origin's own, in order of time: one that is near to another found before
    /// has its origin.
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

/// Whether a row says where the receiver was.
bool is_located(const Observation& row);

/// Where it says.
Geodetic position_of(const Observation& row);

}  // namespace runcert
