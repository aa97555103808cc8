#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/geodesy.h"
#include "schemas/enu/declared.h"

namespace runcert {

/// The local frames of an origin and of its places.
class PlaceFrames {
  public:
    explicit PlaceFrames(const FrameOrigin& origin);

    /// The frame whose axes the coordinates at a time have.
    const LocalFrame& at(ElapsedTime time) const { return frames_[origin_.number_at(time)]; }
    Eigen::Vector3d enu_m(ElapsedTime time, const Geodetic& position) const;
    Geodetic geodetic(ElapsedTime time, const Eigen::Vector3d& enu_m) const;
    Ecef ecef(ElapsedTime time, const Eigen::Vector3d& enu_m) const;

    /// East and north of a point of the ground, whose height nobody states: that of the origin
    /// which is nearest.
    Eigen::Vector2d on_the_ground_m(Geodetic point) const;

  private:
    Eigen::Vector3d offset_m(std::size_t number) const;

    FrameOrigin origin_;
    std::vector<LocalFrame> frames_;
};

/// How far (m) the ellipsoid lies below the plane that touches it at the place of a time; 0 where
/// there is no origin.
double fall_at_m(const std::optional<FrameOrigin>& origin, ElapsedTime time, double east_m,
                 double north_m);

}  // namespace runcert
