#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geodesy.h"
#include "schemas/common/codec.h"
#include "schemas/common/table.h"

namespace runcert {

/// A part of a recording with an origin of its own: its coordinates are those of the plane that
/// touches the ellipsoid there, moved by where that origin lies in the frame. It ends where the
/// next begins.
struct FramePlace {
    ElapsedTime from;
    Geodetic position;
    double east_m = 0.0;
    double north_m = 0.0;
};

/// The origin of the local frame, in geodetic coordinates.
struct FrameOrigin {
    Geodetic position;
    std::string source;                   ///< "attempt" or "first_epoch"
    std::vector<FramePlace> places = {};  ///< far from it, in order of time

    /// Which place holds at a time: 0 before the first, where it is the origin itself.
    std::size_t number_at(ElapsedTime time) const;
    FramePlace place(std::size_t number) const;
    FramePlace place_at(ElapsedTime time) const { return place(number_at(time)); }
};

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

template <>
nlohmann::ordered_json members_json(const FrameOrigin& origin);
template <>
FrameOrigin read_members(const YamlValue& origin);

}  // namespace runcert
