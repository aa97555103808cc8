#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/enu/enu.h"
#include "stages/window/best_window.h"

namespace runcert {

/// A surveyed line across the course, from its left end to its right end for one who looks along
/// the course (east, north; m).
struct SurveyedLine {
    Eigen::Vector2d left, right;
};

/// Where a track goes from one side of a gate to the other, between its ends.
struct Crossing {
    std::size_t series = 0;
    std::size_t after = 0;  ///< the last sample not after it
    ElapsedTime time;       ///< rounded to the nanosecond
    double fraction = 0.0;  ///< of the step after that sample, in [0, 1]; 0: at the sample
    bool forward = false;   ///< along the course
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north (m)
};

/// All crossings of a gate in order of time, by the first two axes of the positions, which are
/// interpolated linearly between samples. Linear in the samples.
///
/// A track crosses at a sample that lies on the line, the first of them where several do, if the
/// samples before and after these lie on different sides. So one that touches and goes back does
/// not cross, nor does one that is first seen, or last, on the line. Obstacles and bounds of the
/// series are not asked. Failure where the ends of the gate are the same.
std::vector<Crossing> crossings(const std::vector<SampleSeries>& series, const SurveyedLine& gate);

/// From the start line to the finish line in the course's direction.
struct Passage {
    Crossing start, finish;
    std::string refusal;  ///< empty where it is unambiguous, otherwise sentences
};

/// The passages in order of time: a forward crossing of the start line that, of all crossings of
/// both lines in the same series, is directly followed by a forward crossing of the finish line.
///
/// Where the start line was crossed forward before, with no crossing of the finish line between,
/// or the finish line is crossed forward again with none of the start line between, nobody can
/// tell which crossing counts: the passage is refused, with the times (s) of all of them. What is
/// crossed on the way back from the finish line to before the start line does not count. Where
/// both lines are crossed at once the finish comes first, so that one gate can be both, for laps
/// (to and fro over such a gate is then no refusal, since it is crossed as the other line, too).
std::vector<Passage> passages(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                              const SurveyedLine& finish);

/// Why there is no passage, as one sentence without a full stop; empty where there is one.
std::string why_no_passage(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                           const SurveyedLine& finish);

/// A surveyed course in the frame of a trajectory.
struct SurveyedCourse {
    SurveyedLine start, finish;
    double length_m = 0.0;
    double length_standard_uncertainty_m = 0.0;
};

/// The course in the frame with that origin (none: the recording's engineering CRS). Failure where
/// its points are in geodetic coordinates and the recording is not, or the reverse, where a line's
/// ends are the same, or where the lines' middles are not as far apart as the stated length, to 2 %
/// and 1 m.
SurveyedCourse surveyed_course(const Course& course, const std::optional<FrameOrigin>& origin);

/// The passages over the course as windows, fastest first, those that nobody can be sure of left
/// out. Speed is the stated length over the time between the crossings, with straight lines
/// between epochs.
std::vector<FoundWindow> course_windows(const std::vector<SampleSeries>& series,
                                        const SurveyedCourse& gates);

/// Why there is none: the track does not cross a line, or crosses it so often that nobody can tell
/// which crossing counts. Empty where there is a passage that is unambiguous.
std::string why_no_course_window(const std::vector<SampleSeries>& series,
                                 const SurveyedCourse& gates);

}  // namespace runcert
