#pragma once

#include <cmath>
#include <compare>
#include <numbers>

namespace runcert {

/// One radian in degrees, 180 / pi.
inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;
inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

/// The azimuth of a direction in the plane, in degrees clockwise from north, 0 to below 360. Of no
/// direction at all: 0.
inline double azimuth_deg(double east, double north) {
    const double degrees = std::atan2(east, north) * degrees_per_radian;
    return degrees < 0.0 ? degrees + 360.0 : degrees;
}

/// A plane angle. Its factory functions name the unit, so that degrees and radians cannot be
/// confused.
///
/// Stored in degrees, the unit in which positions are recorded. A latitude of 90 degrees, or one
/// read from text, keeps its exact value. Radians are rounded once, to within 1 ulp.
class Angle {
  public:
    /// The zero angle.
    constexpr Angle() = default;

    /// An angle from radians. The range is not checked, and nothing is reduced to one turn.
    static constexpr Angle from_radians(double radians) {
        return Angle(radians * degrees_per_radian);
    }

    /// An angle from degrees, stored unchanged.
    static constexpr Angle from_degrees(double degrees) { return Angle(degrees); }

    /// An angle from non-negative `degrees`, `minutes` and `seconds` of arc. A negative `sign`
    /// means south or west. The sign is a separate argument because -0 degrees 30 minutes would
    /// lose it.
    static constexpr Angle from_dms(int sign, double degrees, double minutes, double seconds) {
        const double magnitude = degrees + (minutes + seconds / 60.0) / 60.0;
        return Angle(sign < 0 ? -magnitude : magnitude);
    }

    /// The angle in radians, not reduced to one turn.
    constexpr double radians() const { return degrees_ * radians_per_degree; }
    /// The angle in degrees, as stored.
    constexpr double degrees() const { return degrees_; }

    friend constexpr bool operator==(Angle, Angle) = default;
    friend constexpr auto operator<=>(Angle, Angle) = default;

  private:
    explicit constexpr Angle(double degrees) : degrees_(degrees) {}

    double degrees_ = 0.0;
};

static_assert(Angle::from_radians(std::numbers::pi / 2).degrees() == 90.0);
static_assert(Angle::from_degrees(180.0).radians() == std::numbers::pi);
static_assert(Angle::from_dms(-1, 0.0, 30.0, 0.0) == Angle::from_degrees(-0.5));

}  // namespace runcert
