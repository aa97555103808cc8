#include "satellites/troposphere.h"

#include <algorithm>
#include <cmath>

namespace runcert {

double troposphere_m(double height_m, double sine_of_elevation) {
    const double height = std::clamp(height_m, -1000.0, 30'000.0);
    const double zenith_m = 2.3 * std::exp(-height / 8400.0) + 0.1 * std::exp(-height / 2500.0);
    return zenith_m * 1.001 / std::sqrt(0.002001 + sine_of_elevation * sine_of_elevation);
}

}  // namespace runcert
