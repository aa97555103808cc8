#pragma once

#include <string_view>

namespace runcert {

/// Metres per second in one of "km/h", "m/s", "kn", "mph" (exact: knot 1852 m/h, mile 1609.344 m).
/// Failure for any other text.
double metres_per_second(std::string_view unit);

}  // namespace runcert
