#include "stages/window/course_windows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>

#include "core/failure.h"
#include "core/geodesy.h"

namespace runcert {

namespace {

Eigen::Vector2d in_frame(const CoursePoint& point, const Course& course,
                         const std::optional<FrameOrigin>& origin) {
    if (point.geodetic.has_value() != origin.has_value())
        throw Failure(
            course.place,
            origin
                ? "the course is in engineering coordinates, the recording in geodetic coordinates"
                : "the course is in geodetic coordinates, the recording in engineering coordinates",
            origin ? "Give latitude_deg and longitude_deg of the course's points"
                   : "Give east_m and north_m of the course's points");
    if (!origin) return Eigen::Vector2d(point.plane_m->data());
    return PlaceFrames(*origin).on_the_ground_m(*point.geodetic);
}

SurveyedLine gate_of(const CourseLine& line, const Course& course,
                     const std::optional<FrameOrigin>& origin) {
    const SurveyedLine gate{.left = in_frame(line.left, course, origin),
                            .right = in_frame(line.right, course, origin)};
    constexpr double shortest_m = 0.1;
    if ((gate.right - gate.left).norm() < shortest_m)
        throw Failure(course.place, "the two ends of a line of the course are the same point",
                      "Correct the coordinates of its left and right ends");
    return gate;
}

}  // namespace

SurveyedCourse surveyed_course(const Course& course, const std::optional<FrameOrigin>& origin) {
    SurveyedCourse gates{
        .start = gate_of(course.start, course, origin),
        .finish = gate_of(course.finish, course, origin),
        .length_m = course.length_m,
        .length_standard_uncertainty_m = 0.5 * course.length_expanded_uncertainty_m};
    const Eigen::Vector2d from = 0.5 * (gates.start.left + gates.start.right);
    const Eigen::Vector2d to = 0.5 * (gates.finish.left + gates.finish.right);
    const double apart_m = (to - from).norm();
    if (std::abs(apart_m - course.length_m) > 1.0 + 0.02 * course.length_m)
        throw Failure(course.place,
                      fmt::format("the course is stated to be {:.2f} m long, but the middles of "
                                  "its lines are {:.2f} m apart",
                                  course.length_m, apart_m),
                      "Correct length_m or the coordinates of the lines");
    return gates;
}

std::vector<FoundWindow> course_windows(const std::vector<SampleSeries>& series,
                                        const SurveyedCourse& gates) {
    std::vector<FoundWindow> windows;
    for (const Passage& passage : passages(series, gates.start, gates.finish)) {
        if (!passage.refusal.empty()) continue;
        const Crossing& start = passage.start;
        const Crossing& finish = passage.finish;
        FoundWindow window{.series = start.series,
                           .first = start.after,
                           .last = finish.after + (finish.fraction > 0.0 ? 1 : 0),
                           .start = start.time,
                           .end = finish.time,
                           .length_m = gates.length_m};
        if (!window_allowed(series[window.series], window.first, window.last)) continue;
        window.speed_m_s = gates.length_m / window.duration_s();
        windows.push_back(window);
    }
    std::ranges::stable_sort(windows, preferred);
    return windows;
}

std::string refused_passage(const std::vector<SampleSeries>& series, const SurveyedCourse& gates) {
    for (const Passage& passage : passages(series, gates.start, gates.finish))
        if (!passage.refusal.empty()) return passage.refusal;
    return {};
}

namespace {

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}

/// Signed distance of a position beyond the line through the gate, times the gate's length (m^2).
/// Negative before the line.
double beyond(const SurveyedLine& gate, const Eigen::Vector2d& position) {
    return cross(gate.right - gate.left, position - gate.left);
}

bool between_ends(const SurveyedLine& gate, const Eigen::Vector2d& position) {
    const Eigen::Vector2d across = gate.right - gate.left;
    const double along_m2 = across.dot(position - gate.left);
    return along_m2 >= 0.0 && along_m2 <= across.squaredNorm();
}

/// The crossing within the step after a sample, given the signed distances `before` and `after` of
/// its two ends. It is at the sample itself if `before` is 0.
Crossing crossing_in(const SampleSeries& series, std::size_t sample, double before, double after) {
    Crossing crossing;
    crossing.after = sample;
    crossing.time = series.times[sample];
    crossing.position = series.positions[sample].head<2>();
    if (before == 0.0) return crossing;
    const Eigen::Vector2d next = series.positions[sample + 1].head<2>();
    const auto step_ns = static_cast<double>(series.times[sample + 1].nanoseconds -
                                             series.times[sample].nanoseconds);
    crossing.fraction = before / (before - after);
    crossing.time.nanoseconds += std::llround(crossing.fraction * step_ns);
    crossing.position += crossing.fraction * (next - crossing.position);
    return crossing;
}

void add_crossings(const SampleSeries& series, std::size_t index, const SurveyedLine& gate,
                   std::vector<Crossing>& found) {
    std::optional<std::size_t> off_line;  // the last sample that is not on the line
    double side_before = 0.0;
    for (std::size_t k = 0; k < series.times.size(); ++k) {
        const double side = beyond(gate, series.positions[k].head<2>());
        if (side == 0.0) continue;
        if (off_line && (side > 0.0) != (side_before > 0.0)) {
            const bool at_sample = *off_line + 1 < k;
            Crossing crossing = at_sample ? crossing_in(series, *off_line + 1, 0.0, side)
                                          : crossing_in(series, *off_line, side_before, side);
            crossing.series = index;
            crossing.forward = side > 0.0;
            crossing.speed_m_s = std::abs(side - side_before) / (gate.right - gate.left).norm() /
                                 (series.times[k].seconds() - series.times[*off_line].seconds());
            if (between_ends(gate, crossing.position)) found.push_back(crossing);
        }
        off_line = k;
        side_before = side;
    }
}

}  // namespace

std::vector<Crossing> crossings(const std::vector<SampleSeries>& series, const SurveyedLine& gate) {
    if (gate.left == gate.right)
        throw Failure("a gate of the course", "its left end is where its right end is",
                      "State the surveyed positions of both ends of the line");
    std::vector<Crossing> found;
    for (std::size_t k = 0; k < series.size(); ++k) {
        assert(series[k].positions.size() == series[k].times.size());
        add_crossings(series[k], k, gate, found);
    }
    return found;
}

}  // namespace runcert
