#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "schemas/attempt/attempt.h"
#include "schemas/enu/declared.h"
#include "stages/window/best_window.h"

namespace runcert {

/// A surveyed line across the course, from its left to its right end when looking along the course
/// (east, north; m).
struct SurveyedLine {
    Eigen::Vector2d left, right;
};

/// A track's transition from one side of a gate to the other, between the gate's ends.
struct Crossing {
    std::size_t series = 0;
    std::size_t after = 0;   ///< the last sample at or before it
    ElapsedTime time;        ///< rounded to the nanosecond
    double fraction = 0.0;   ///< of the step after that sample, in [0, 1]; 0 at the sample
    bool forward = false;    ///< in the direction of the course
    double speed_m_s = 0.0;  ///< across the line, from the sample before it to the one after
    Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< east, north (m)
};

/// All crossings of a gate in order of time, by the first two axes of the positions, which are
/// interpolated linearly between samples. The cost is linear in the samples.
///
/// A track crosses at a sample on the line, the first if there are several, if the samples before
/// and after them lie on different sides. A track that touches the line and goes back does not
/// cross. Nor does one that is first or last seen on the line. Obstacles and bounds of the series
/// are ignored. Failure if the ends of the gate coincide.
std::vector<Crossing> crossings(const std::vector<SampleSeries>& series, const SurveyedLine& gate);

/// A line that is crossed slower has no certain time of crossing.
inline constexpr double slowest_crossing_m_s = 0.05;

/// A passage from the start line to the finish line in the course's direction.
struct Passage {
    Crossing start, finish;
    std::string refusal;  ///< empty if its time is certain, otherwise sentences
};

/// The passages in order of time. A passage is a forward crossing of the start line directly
/// followed, among all crossings of both lines in the same series, by a forward crossing of the
/// finish line.
///
/// It is ambiguous which crossing counts if the start line was crossed forward before with no
/// crossing of the finish line in between. The same holds if the finish line is crossed forward
/// again with no crossing of the start line in between. The passage is then refused, with the times
/// (s) of all of them. So is a passage with a line crossed below `slowest_crossing_m_s`, where the
/// track runs along the line or stands on it. Crossings on the way back from the finish line to
/// before the start line do not count.
///
/// Where both lines are crossed at once the finish comes first, so that one gate can be both, for
/// laps. Going to and fro over such a gate is then no reason for refusal, because the other line is
/// crossed too.
std::vector<Passage> passages(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                              const SurveyedLine& finish);

/// The reason why there is no passage, as one sentence without a full stop. Empty if there is
/// one.
std::string why_no_passage(const std::vector<SampleSeries>& series, const SurveyedLine& start,
                           const SurveyedLine& finish);

/// A surveyed course in the frame of a trajectory.
struct SurveyedCourse {
    SurveyedLine start, finish;
    double length_m = 0.0;
    double length_standard_uncertainty_m = 0.0;
};

/// The course in the frame with that origin, or in the recording's engineering CRS without one.
/// Failure if its points have geodetic coordinates and the recording does not, or the reverse.
/// Failure also if a line's ends coincide, or the distance between the lines' middles differs
/// from the stated length by more than 1 m plus 2 %.
SurveyedCourse surveyed_course(const Course& course, const std::optional<FrameOrigin>& origin);

/// The unambiguous passages over the course as windows, fastest first. Speed is the stated length
/// over the time between the crossings, with straight lines between epochs.
std::vector<FoundWindow> course_windows(const std::vector<SampleSeries>& series,
                                        const SurveyedCourse& gates);

/// Why the first passage that is refused was, in sentences. Empty if none was.
std::string refused_passage(const std::vector<SampleSeries>& series, const SurveyedCourse& gates);

}  // namespace runcert
