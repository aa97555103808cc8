#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "core/rounding.h"
#include "reports/certificate/json_figures.h"
#include "witness/surface_input.h"

namespace runcert {
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

bool in_a_window(double time_s, const std::vector<RuleView>& rules) {
    const auto inside = [&](const WindowSpan& window) {
        const double start = window.start.seconds();
        return time_s >= start - 1e-6 && time_s <= start + window.duration.seconds() + 1e-6;
    };
    return std::ranges::any_of(rules, [&](const RuleView& rule) {
        if (!rule.verdict.window) return false;
        return inside(*rule.verdict.window) ||
               (rule.best() != nullptr &&
                std::ranges::any_of(rule.windows->further, inside, &FurtherWindow::span));
    });
}

void add_track(Json& figure, Extent& extent, const TrajectoryTable& table,
               const std::vector<RuleView>& rules) {
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
        if (in_a_window(row.time.seconds(), rules))
            windows.add(*row.east_m, *row.north_m);
        else
            windows.interrupt();
        extent.widen(*row.east_m, *row.north_m);
        if (first == nullptr) first = &row;
        last = &row;
    }
    figure["curves"].push_back(track.json());
    windows.add_to(figure);
    if (first == nullptr) return;
    add_mark(figure, "start", *first->east_m, *first->north_m);
    add_mark(figure, "end", *last->east_m, *last->north_m);
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

constexpr std::size_t bins_of_a_figure = 250;
constexpr std::size_t rejections_shown = 400;
constexpr double largest_ratio_shown = 5.0;

/// Gathers values over some epochs, and adds their middle with the band that they take.
class Binned {
  public:
    Binned(const CurveStyle& style, std::size_t epochs_of_a_bin)
        : curve_(style), size_(epochs_of_a_bin) {}

    void add(double time, double value, std::optional<std::int64_t> arc) {
        if (count_ > 0 && arc != arc_) flush();
        if (arc != arc_) curve_.interrupt();
        arc_ = arc;
        if (count_ == 0) begin_ = time;
        end_ = time;
        range_.widen(value);
        if (++count_ == size_) flush();
    }
    const Curve& finished() {
        if (count_ > 0) flush();
        return curve_;
    }

  private:
    void flush() {
        curve_.add(0.5 * (begin_ + end_), 0.5 * (*range_.least + *range_.most), *range_.least,
                   *range_.most);
        range_ = {};
        count_ = 0;
    }

    Curve curve_;
    std::size_t size_;
    std::size_t count_ = 0;
    double begin_ = 0.0, end_ = 0.0;
    Range range_;
    std::optional<std::int64_t> arc_;
};

struct Residual {
    double time = 0.0;
    std::optional<std::int64_t> arc;
    double east_m = 0.0, north_m = 0.0;
    double bound_m = 0.0;  ///< twice the standard deviation of a coordinate, as used
};

std::vector<Residual> residuals_of(const ReceiverResults& results) {
    const double factor = std::sqrt(results.trajectory.estimation.variance_factor_applied);
    std::vector<Residual> residuals;
    const auto& rows = results.trajectory.rows;
    const auto& screened = results.screened.rows;
    for (std::size_t i = 0; i < std::min(rows.size(), screened.size()); ++i) {
        const ScreenedEpoch& measured = screened[i];
        const TrajectoryEpoch& row = rows[i];
        if (!measured.usable || !row.arc || !row.east_m || !measured.east_m) continue;
        const double stated = std::sqrt(0.5 * (std::pow(measured.sigma_east_m.value_or(0.0), 2) +
                                               std::pow(measured.sigma_north_m.value_or(0.0), 2)));
        residuals.push_back({.time = row.time.seconds(),
                             .arc = row.arc,
                             .east_m = *measured.east_m - *row.east_m,
                             .north_m = *measured.north_m - *row.north_m,
                             .bound_m = 2.0 * factor * stated});
    }
    return residuals;
}

/// The two lines of the bounds.
void add_bounds(Json& figure, const std::vector<Residual>& residuals) {
    const std::size_t every = 1 + residuals.size() / bins_of_a_figure;
    for (const double sign : {1.0, -1.0}) {
        Curve bound({sign > 0 ? "+ 2 standard deviations" : "- 2 standard deviations", "dashed",
                     "black", 3, 5});
        for (std::size_t i = 0; i < residuals.size(); i += every) {
            if (i > 0 && residuals[i].arc != residuals[i - every].arc) bound.interrupt();
            bound.add(residuals[i].time, sign * residuals[i].bound_m);
        }
        figure["curves"].push_back(bound.json());
    }
}

}  // namespace

Json segment(const std::string& name, const std::vector<Eigen::Vector2d>& points) {
    Json json{{"segment_name", name}, {"x", Json::array()}, {"y", Json::array()}};
    for (const Eigen::Vector2d& point : points) {
        json["x"].push_back(rounded(point.x(), 3));
        json["y"].push_back(rounded(point.y(), 3));
    }
    return json;
}

Json track_figure(const ReportInputs& inputs) {
    const TrajectoryTable& table = inputs.receivers.front().trajectory;
    const bool georeferenced = table.facts.georeferenced;
    const std::string plane = georeferenced ? ", from the origin." : " of the recording's plane.";
    Json figure =
        empty_figure("track", "The track in the plane",
                     "Smoothed positions on axes of equal scale" + plane +
                         (georeferenced ? " The arrow points to the north of the origin."
                                        : " The arrow points along the second axis.") +
                         (inputs.attempt.course ? " Across it: the lines of the course." : "") +
                         thinning_words(thinning(table.rows.size())),
                     georeferenced ? "east of the origin (m)" : "first plane coordinate (m)",
                     georeferenced ? "north of the origin (m)" : "second plane coordinate (m)");
    figure["equal_scale"] = true;
    Extent extent;
    add_track(figure, extent, table, rule_views(inputs));
    if (inputs.attempt.course) add_gates(figure, extent, *inputs.attempt.course, table.origin);
    // A track along one axis still gets some room across it.
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

Json place_figure(const ReportInputs& inputs) {
    Json figure = track_figure(inputs);
    figure["figure"] = "place";
    figure["figure_title"] = "Track and window";
    figure["caption"] = "Blue: the track, north up where that is known; orange: the window.";
    return figure;
}

Json ground_figure(const ReportInputs& inputs) {
    const ReceiverResults& judged = inputs.receivers.front();
    if (!inputs.surface) return nullptr;
    Json figure = empty_figure(
        "ground", "The track on its surface",
        "Along the track: the surface below it, and the antenna by the smoothed positions less its "
        "stated height above the ground.",
        "length of the track (m)", "height in the frame of the origin (m)");
    Curve ground({"surface", "line", "green", 2, 3}),
        track({"antenna, lowered", "line", "blue", 2, 3});
    const double antenna_height_m = inputs.attempt.receivers.front().antenna_height_m.value_or(0.0);
    const auto& rows = judged.trajectory.rows;
    const std::size_t every = thinning(rows.size());
    Range lengths, heights;
    std::optional<Eigen::Vector3d> before;
    double length_m = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const TrajectoryEpoch& row = rows[i];
        if (!row.arc || !row.east_m || !row.north_m || !row.up_m) continue;
        const Eigen::Vector3d place = in_frame_of_origin(judged.trajectory.origin, row.time,
                                                         {*row.east_m, *row.north_m, *row.up_m});
        if (before) length_m += (place - *before).head<2>().norm();
        before = place;
        if (i % every != 0) continue;
        const auto below = inputs.surface->at(place.head<2>());
        if (!below) {
            ground.interrupt();
            track.interrupt();
            continue;
        }
        const double lowered_m = place.z() - antenna_height_m;
        ground.add(length_m, below->up_m);
        track.add(length_m, lowered_m);
        lengths.widen(length_m);
        heights.widen(below->up_m);
        heights.widen(lowered_m);
    }
    if (ground.size() < 2) return nullptr;
    ground.add_to(figure);
    track.add_to(figure);
    set_axes(figure, *lengths.least, *lengths.most, *heights.least, *heights.most);
    return figure;
}

Json residual_figure(const ReceiverResults& results) {
    const std::vector<Residual> residuals = residuals_of(results);
    if (residuals.empty()) return nullptr;
    const std::size_t bin = 1 + residuals.size() / bins_of_a_figure;
    Json figure = empty_figure(
        "residuals", "Residuals: measured less smoothed positions",
        std::string("Of the epochs used. Dashed: twice the standard deviation of a coordinate, as "
                    "the estimate uses it.") +
            (bin > 1 ? fmt::format(" Each band spans the residuals of {} epochs.", bin) : ""),
        time_label, "residual (m)");
    Binned east({"east", "line", "blue", 3, 5}, bin);
    Binned north({"north", "line", "orange", 3, 5}, bin);
    Range times, values;
    for (const Residual& residual : residuals) {
        east.add(residual.time, residual.east_m, residual.arc);
        north.add(residual.time, residual.north_m, residual.arc);
        times.widen(residual.time);
        for (const double value : {residual.east_m, residual.north_m, residual.bound_m})
            values.widen(std::abs(value));
    }
    figure["curves"].push_back(east.finished().json());
    figure["curves"].push_back(north.finished().json());
    add_bounds(figure, residuals);
    set_axes(figure, *times.least, *times.most, -*values.most, *values.most);
    return figure;
}

Json test_figure(const ScreenedTable& table) {
    std::vector<const ScreenedEpoch*> tested;
    for (const ScreenedEpoch& row : table.rows)
        if (row.statistic && row.threshold && *row.threshold > 0.0) tested.push_back(&row);
    if (tested.size() < 2) return nullptr;
    const std::size_t bin = 1 + tested.size() / bins_of_a_figure;
    Json figure = empty_figure(
        "innovations", "Tests of screening",
        fmt::format("Statistic of the best supported error over its threshold, from the "
                    "innovations: above 1 the error is decided for, and the epoch left out or the "
                    "stretch ended. A ratio above {0:g} is drawn at {0:g}.{1}",
                    largest_ratio_shown,
                    bin > 1 ? fmt::format(" Each band spans {} epochs.", bin) : ""),
        time_label, "statistic over threshold");
    Binned kept({"epochs kept", "line", "blue", 3, 4}, bin);
    Curve decided({"decided for an error", "points", "vermilion", 3, 4});
    Range times, ratios;
    ratios.widen(1.2);
    for (const ScreenedEpoch* row : tested) {
        const double time = row->time.seconds();
        const double ratio = std::min(*row->statistic / *row->threshold, largest_ratio_shown);
        times.widen(time);
        ratios.widen(ratio);
        if (ratio <= 1.0)
            kept.add(time, ratio, row->arc);
        else if (decided.size() < rejections_shown)
            decided.add(time, ratio);
    }
    kept.finished().add_to(figure);
    decided.add_to(figure);
    add_level(figure, "threshold", 1.0);
    set_axes(figure, *times.least, *times.most, 0.0, *ratios.most);
    return figure;
}

}  // namespace runcert
