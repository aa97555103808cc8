#pragma once

namespace runcert {

/// Speed through the water over a surveyed course: distance over elapsed time, less the current
/// along the course (positive where it carries the craft on), in m/s. Reproduces the 500 m and
/// nautical mile speeds that the WSSRC printed. Failure (at "course") for numbers that are not
/// finite, or a distance or time not above 0.
double course_speed_m_s(double distance_m, double elapsed_s, double current_m_s);

}  // namespace runcert
