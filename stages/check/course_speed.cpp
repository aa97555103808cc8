#include <fmt/format.h>

#include <cmath>

#include "core/failure.h"
#include "stages/check/requirements.h"

namespace runcert {

double course_speed_m_s(double distance_m, double elapsed_s, double current_m_s) {
    if (!(distance_m > 0.0 && elapsed_s > 0.0 && std::isfinite(distance_m) &&
          std::isfinite(elapsed_s) && std::isfinite(current_m_s)))
        throw Failure("course",
                      fmt::format("{} m in {} s with a current of {} m/s", distance_m, elapsed_s,
                                  current_m_s),
                      "Give a distance and a time above 0 and a finite current");
    return distance_m / elapsed_s - current_m_s;
}

}  // namespace runcert
