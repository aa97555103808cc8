#pragma once

#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/enu/enu.h"
#include "stages/window/best_window.h"
#include "stages/window/crossings.h"

namespace runcert {

/// A surveyed course in the frame of a trajectory.
struct CourseGates {
    Gate start, finish;
    double length_m = 0.0;
    double length_standard_uncertainty_m = 0.0;
};

/// The course in the frame with that origin (none: the recording's engineering CRS). Failure where
/// its points are in geodetic coordinates and the recording is not, or the reverse, where a line's
/// ends are the same, or where the lines' middles are not as far apart as the stated length, to 2 %
/// and 1 m.
CourseGates course_gates(const Course& course, const std::optional<FrameOrigin>& origin);

/// The passages over the course as windows, fastest first, those that nobody can be sure of left
/// out. Speed is the stated length over the time between the crossings, with straight lines
/// between epochs.
std::vector<FoundWindow> course_windows(const std::vector<SampleSeries>& series,
                                        const CourseGates& gates);

/// Why there is none: the track does not cross a line, or crosses it so often that nobody can tell
/// which crossing counts. Empty where there is a passage that is unambiguous.
std::string why_no_course_window(const std::vector<SampleSeries>& series, const CourseGates& gates);

}  // namespace runcert
