#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/geodesy.h"
#include "core/rounding.h"
#include "reports/certificate/curve.h"
#include "reports/certificate/json_figures.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

struct Extent {
    Range east, north;

    void widen(double east_m, double north_m) {
        east.widen(east_m);
        north.widen(north_m);
    }
};

/// Where a point of the course is in the frame of the trajectory.
std::optional<Eigen::Vector2d> in_frame(const CoursePoint& point,
                                        const std::optional<FrameOrigin>& origin) {
    if (!origin && point.plane_m) return Eigen::Vector2d(point.plane_m->data());
    if (!origin) return std::nullopt;
    if (!point.geodetic) return std::nullopt;
    return PlaceFrames(*origin).on_the_ground_m(*point.geodetic);
}

Json segment(const std::string& name, const std::vector<Eigen::Vector2d>& points) {
    Json json{{"segment_name", name}, {"x", Json::array()}, {"y", Json::array()}};
    for (const Eigen::Vector2d& point : points) {
        json["x"].push_back(rounded(point.x(), 3));
        json["y"].push_back(rounded(point.y(), 3));
    }
    return json;
}

void add_gates(Json& figure, Extent& extent, const Course& course,
               const std::optional<FrameOrigin>& origin) {
    for (const auto& [name, line] :
         {std::pair{"start line", &course.start}, std::pair{"finish line", &course.finish}}) {
        const auto left = in_frame(line->left, origin);
        const auto right = in_frame(line->right, origin);
        if (!left || !right) continue;
        extent.widen(left->x(), left->y());
        extent.widen(right->x(), right->y());
        figure["segments"].push_back(segment(name, {*left, *right}));
    }
}

Json mark(const char* name, const TrajectoryEpoch& row) {
    return {{"mark_name", name}, {"x", rounded(*row.east_m, 3)}, {"y", rounded(*row.north_m, 3)}};
}

bool in_a_window(double time_s, const Json& profiles) {
    const auto inside = [&](const Json& window) {
        const double start = window["start_time_s"].get<double>();
        return time_s >= start - 1e-6 &&
               time_s <= start + window["duration_s"].get<double>() + 1e-6;
    };
    return std::any_of(profiles.begin(), profiles.end(), [&](const Json& profile) {
        if (!profile.contains("window")) return false;
        const Json& window = profile["window"];
        return inside(window) ||
               (window.contains("further") &&
                std::any_of(window["further"].begin(), window["further"].end(), inside));
    });
}

void add_track(Json& figure, Extent& extent, const TrajectoryTable& table, const Json& profiles) {
    Curve track({"track", "line", "blue"});
    Curve windows({"certified window", "line", "vermilion"});
    const TrajectoryEpoch* first = nullptr;
    const TrajectoryEpoch* last = nullptr;
    const std::size_t every = thinning(table.rows.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const TrajectoryEpoch& row = table.rows[i];
        if (!row.arc || !row.east_m || !row.north_m) {
            windows.interrupt();
            continue;
        }
        const bool begins = last == nullptr || last->arc != row.arc;
        if (begins) track.interrupt();
        if (begins || i % every == 0) track.add(*row.east_m, *row.north_m);
        if (in_a_window(row.time.seconds(), profiles))
            windows.add(*row.east_m, *row.north_m);
        else
            windows.interrupt();
        extent.widen(*row.east_m, *row.north_m);
        if (first == nullptr) first = &row;
        last = &row;
    }
    figure["curves"].push_back(track.json());
    if (!windows.empty()) figure["curves"].push_back(windows.json());
    if (first == nullptr) return;
    figure["marks"].push_back(mark("start", *first));
    figure["marks"].push_back(mark("end", *last));
}

/// An arrow towards north, in the upper right corner of what the figure shows.
void add_north(Json& figure, bool georeferenced) {
    const double width = figure["x_max"].get<double>() - figure["x_min"].get<double>();
    const double height = figure["y_max"].get<double>() - figure["y_min"].get<double>();
    const double length = 0.12 * std::max(height, 0.35 * width);
    const double x = figure["x_max"].get<double>() - 0.04 * width;
    const double top = figure["y_max"].get<double>() - 0.04 * height;
    const double wing = 0.22 * length;
    figure["segments"].push_back(segment(georeferenced ? "north" : "second axis of the plane",
                                         {{x, top - length},
                                          {x, top},
                                          {x - 0.6 * wing, top - wing},
                                          {x, top},
                                          {x + 0.6 * wing, top - wing}}));
}

}  // namespace

Json track_figure(const ReportInputs& inputs, const Json& profiles) {
    const TrajectoryTable& table = inputs.receivers.front().trajectory;
    const bool georeferenced = table.facts.georeferenced;
    const std::string plane = georeferenced ? ", from the origin." : " of the recording's plane.";
    Json figure =
        empty_figure("track", "The track in the plane",
                     "Smoothed positions on axes of equal scale" + plane +
                         (georeferenced ? " The arrow points to the north of the origin." : "") +
                         (inputs.attempt.course ? " Across it: the lines of the course." : "") +
                         thinning_words(thinning(table.rows.size())),
                     georeferenced ? "east of the origin (m)" : "first plane coordinate (m)",
                     georeferenced ? "north of the origin (m)" : "second plane coordinate (m)");
    figure["equal_scale"] = true;
    Extent extent;
    add_track(figure, extent, table, profiles);
    if (inputs.attempt.course) add_gates(figure, extent, *inputs.attempt.course, table.origin);
    // Neither a stick nor a point: a track along one axis still has a plane around it.
    const double large = std::max({extent.east.span(), extent.north.span(), 1.0});
    const auto half = [&](const Range& range, double least) {
        return 0.55 * std::max(range.span(), least * large);
    };
    const auto middle = [](const Range& range) { return 0.5 * (*range.least + *range.most); };
    const double half_east = half(extent.east, 0.9);
    const double half_north = half(extent.north, 0.35);
    set_axes(figure, middle(extent.east) - half_east, middle(extent.east) + half_east,
             middle(extent.north) - half_north, middle(extent.north) + half_north);
    add_north(figure, georeferenced);
    return figure;
}

}  // namespace runcert
