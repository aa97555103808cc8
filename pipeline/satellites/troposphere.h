#pragma once

namespace runcert {

/// Tropospheric delay (m) of a satellite's signal at an ellipsoidal height (m), by the sine of the
/// satellite's elevation. Dry and wet parts have scale heights of 8.4 and 2.5 km and are mapped as
/// in [DO229] A.4.2.4. Accurate to some centimetres above 15 degrees; the effect on a displacement
/// is below 0.1 mm.
double troposphere_m(double height_m, double sine_of_elevation);

}  // namespace runcert
