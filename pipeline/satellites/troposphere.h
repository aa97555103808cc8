#pragma once

namespace runcert {

/// Delay (m) of a satellite's signal in the troposphere, at a height (m) above the ellipsoid, by
/// the sine of the satellite's elevation: dry and wet part with scale heights of 8.4 and 2.5 km,
/// mapped as [DO229] A.4.2.4. Good to some centimetres above 15 degrees; what a displacement sees
/// of that is below 0.1 mm.
double troposphere_m(double height_m, double sine_of_elevation);

}  // namespace runcert
