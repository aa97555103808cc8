#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "core/speed_unit.h"
#include "reports/certificate/plots.h"
#include "witness/surface_input.h"

namespace runcert {
namespace {

constexpr std::size_t bins_of_a_plot = 250;

/// What a plane figure shows.
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
    if (origin && point.geodetic) return PlaceFrames(*origin).on_the_ground_m(*point.geodetic);
    if (!origin && point.plane_m) return Eigen::Vector2d(point.plane_m->data());
    return std::nullopt;
}

void add_gates(Plot& plot, Extent& extent, const Course& course,
               const std::optional<FrameOrigin>& origin) {
    for (const auto& [name, line] :
         {std::pair{"start line", &course.start}, std::pair{"finish line", &course.finish}}) {
        Curve gate{name, "outline", "black"};
        for (const CoursePoint* end : {&line->left, &line->right})
            if (const auto place = in_frame(*end, origin)) {
                extent.widen(place->x(), place->y());
                gate.add(place->x(), place->y());
            }
        if (gate.size() == 2) plot.add(std::move(gate));
    }
}

/// The track, and over it the windows, certified or else refused.
void add_track(Plot& plot, Extent& extent, const TrajectoryTable& table,
               const std::vector<PlotSpan>& windows) {
    Curve track{"track", "line", "blue"}, certified{"certified window", "line", "vermilion"},
        refused{"refused window", "line", "orange"};
    const auto in_a = [&](const char* kind, double time_s) {
        return std::ranges::any_of(windows, [&](const PlotSpan& window) {
            return window.kind == kind && time_s >= window.from - 1e-6 &&
                   time_s <= window.to + 1e-6;
        });
    };
    const TrajectoryEpoch *first = nullptr, *last = nullptr;
    const std::size_t every = thinning(table.rows.size());
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
        const TrajectoryEpoch& row = table.rows[i];
        const bool is_placed = row.arc && row.east_m && row.north_m;
        for (const auto& [curve, kind] :
             {std::pair{&certified, "window"}, std::pair{&refused, "refused"}})
            if (is_placed && in_a(kind, row.time.seconds()))
                curve->add(*row.east_m, *row.north_m);
            else
                curve->interrupt();
        if (!is_placed) continue;
        const bool begins = last == nullptr || last->arc != row.arc;
        if (begins) track.interrupt();
        if (begins || i % every == 0) track.add(*row.east_m, *row.north_m);
        extent.widen(*row.east_m, *row.north_m);
        if (first == nullptr) first = &row;
        last = &row;
    }
    for (Curve* curve : {&track, &refused, &certified})
        plot.add(std::move(*curve));
    if (first == nullptr) return;
    plot.marks.push_back({"start", *first->east_m, *first->north_m});
    plot.marks.push_back({"end", *last->east_m, *last->north_m});
}

/// An arrow towards north, in the corner that the track leaves most room in.
void add_north(Plot& plot) {
    const double width = plot.x_max - plot.x_min, height = plot.y_max - plot.y_min;
    const double length = 0.12 * std::max(height, 0.35 * width), wing = 0.13 * length;
    double x = 0.0, top = 0.0, room = -1.0;
    for (const double across : {0.96, 0.04})
        for (const double up : {0.96, 0.16}) {
            const double corner_x = plot.x_min + across * width;
            const double corner_y = plot.y_min + up * height;
            double nearest = width + height;
            for (const Curve& curve : plot.curves)
                for (std::size_t i = 0; i < curve.size(); ++i)
                    if (std::isfinite(curve.y[i]))
                        nearest = std::min(
                            nearest, std::hypot(curve.x[i] - corner_x, curve.y[i] - corner_y));
            if (nearest <= room) continue;
            room = nearest;
            x = corner_x;
            top = corner_y;
        }
    Curve arrow{"", "outline", "black"};
    arrow.add(x, top - length);
    for (const double side : {-wing, wing}) {
        arrow.add(x, top);
        arrow.add(x + side, top - 1.6 * wing);
    }
    plot.add(std::move(arrow));
}

/// Gathers values over some epochs, and adds their middle with the band that they take.
class Binned {
  public:
    Binned(Curve curve, std::size_t values) : curve_(std::move(curve)) {
        size_ = 1 + values / bins_of_a_plot;
    }

    void add(double time, double value, std::optional<std::int64_t> arc) {
        if (count_ > 0 && arc != arc_) flush();
        if (arc != arc_) curve_.interrupt();
        arc_ = arc;
        if (count_ == 0) begin_ = time;
        end_ = time;
        range_.widen(value);
        if (++count_ == size_) flush();
    }
    Curve finished() {
        if (count_ > 0) flush();
        return std::move(curve_);
    }
    /// " Each band spans the values of 20 epochs."; empty where it has one each.
    std::string words() const {
        return size_ > 1 ? fmt::format(" Each band spans the values of {} epochs.", size_) : "";
    }

  private:
    void flush() {
        if (range_.least)
            curve_.add(0.5 * (begin_ + end_), 0.5 * (*range_.least + *range_.most), *range_.least,
                       *range_.most);
        range_ = {};
        count_ = 0;
    }

    Curve curve_;
    std::size_t size_ = 1, count_ = 0;
    double begin_ = 0.0, end_ = 0.0;
    Range range_;
    std::optional<std::int64_t> arc_;
};

/// Stretches of epochs that were not used, those that cannot be told apart as one.
void add_unused(Plot& plot, const std::vector<ScreenedEpoch>& rows, double length_s) {
    constexpr double stretches = 400.0;
    const double width = std::max(length_s, 1e-9) / stretches;
    const std::size_t before = plot.spans.size();
    for (const ScreenedEpoch& row : rows) {
        if (row.usable) continue;
        const double time = row.time.seconds();
        if (plot.spans.size() == before || time > plot.spans.back().to + width)
            plot.spans.push_back({"epochs not used", "unusable", time, time + 0.5 * width});
        plot.spans.back().to = std::max(plot.spans.back().to, time);
    }
}

}  // namespace

Plots track_plot(const ReportInputs& inputs) {
    const TrajectoryTable& table = inputs.receivers.front().trajectory;
    const bool georeferenced = table.facts.georeferenced;
    Plot plot{.kind = "track",
              .title = "The track in the plane",
              .caption = georeferenced ? "Smoothed positions from the origin. The arrow points "
                                         "to the north of the origin."
                                       : "Smoothed positions of the recording's plane. The "
                                         "arrow points along the second axis.",
              .x_label = georeferenced ? "east of the origin (m)" : "first plane coordinate (m)",
              .y_label = georeferenced ? "north of the origin (m)" : "second plane coordinate (m)",
              .equal_scale = true};
    plot.caption += thinning_words(thinning(table.rows.size()));
    Extent extent;
    add_track(plot, extent, table, window_spans(rule_views(inputs)));
    if (!extent.east.least) return {};
    if (inputs.attempt.course) add_gates(plot, extent, *inputs.attempt.course, table.origin);
    // A track along one axis still gets some room across it.
    const double large = std::max({extent.east.span(), extent.north.span(), 1.0});
    for (const auto& [range, least] :
         {std::pair{&extent.east, 0.9}, std::pair{&extent.north, 0.35}}) {
        const double middle = 0.5 * (*range->least + *range->most);
        const double half = 0.55 * std::max(range->span(), least * large);
        range->widen(middle - half);
        range->widen(middle + half);
    }
    plot.set_axes(extent.east, extent.north);
    add_north(plot);
    return {std::move(plot)};
}

Plots place_plot(const ReportInputs& inputs) {
    Plots plots = track_plot(inputs);
    for (Plot& plot : plots) {
        plot.kind = "place";
        plot.title = "Track and window";
        plot.caption.clear();
    }
    return plots;
}

Plots ground_plot(const ReportInputs& inputs) {
    const ReceiverResults& judged = inputs.receivers.front();
    if (!inputs.surface) return {};
    Plot plot{.kind = "ground",
              .title = "The track on its surface",
              .caption =
                  "Along the track: the surface below it, and the antenna by the "
                  "smoothed positions less its stated height above the ground.",
              .x_label = "length of the track (m)",
              .y_label = "height in the frame of the origin (m)"};
    Curve ground{"surface", "line", "green", 2}, track{"lowered antenna", "line", "blue", 2};
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
        for (const auto& [curve, up_m] : {std::pair{&ground, below ? below->up_m : 0.0},
                                          std::pair{&track, place.z() - antenna_height_m}}) {
            if (!below) {
                curve->interrupt();
                continue;
            }
            curve->add(length_m, up_m);
            lengths.widen(length_m);
            heights.widen(up_m);
        }
    }
    if (ground.size() < 2) return {};
    plot.add(std::move(ground));
    plot.add(std::move(track));
    plot.set_axes(lengths, heights);
    return {std::move(plot)};
}

Plots speed_plot(const ReportInputs& inputs) {
    const ReceiverResults& judged = inputs.receivers.front();
    const std::vector<RuleView> rules = rule_views(inputs);
    const SpeedUnit& unit = rules.front().unit();
    const std::size_t every = thinning(judged.trajectory.rows.size());
    Plot plot{.kind = "speed",
              .title = "Horizontal speed over the whole run",
              .caption =
                  "Smoothed speed; the line is broken where the recording is. A refused "
                  "window is the fastest of the raw positions." +
                  thinning_words(every),
              .x_label = time_label,
              .y_label = fmt::format("horizontal speed ({})", unit.name),
              .spans = window_spans(rules)};
    Curve curve{"smoothed speed", "line", "blue"};
    Range times, speeds;
    speeds.widen(0.0);
    std::optional<std::int64_t> arc;
    for (std::size_t i = 0; i < judged.trajectory.rows.size(); ++i) {
        const TrajectoryEpoch& row = judged.trajectory.rows[i];
        if (!row.arc || !row.speed_m_s) continue;
        const bool begins = row.arc != arc;
        arc = row.arc;
        speeds.widen(*row.speed_m_s * unit.per_m_s);
        if (begins) curve.interrupt();
        if (begins || i % every == 0) curve.add(row.time.seconds(), *row.speed_m_s * unit.per_m_s);
    }
    if (curve.size() < 2) return {};
    plot.add(std::move(curve));
    for (const RuleView& rule : rules)
        if (rule.profile.dimension == Dimension::horizontal) add_required_speed(plot, speeds, rule);
    for (const auto& row : judged.screened.rows)
        times.widen(row.time.seconds());
    add_unused(plot, judged.screened.rows, times.span());
    plot.set_axes(times, speeds);
    return {std::move(plot)};
}

Plots residual_plot(const ReceiverResults& results) {
    const double factor = std::sqrt(results.trajectory.estimation.variance_factor_applied);
    const auto& rows = results.trajectory.rows;
    const auto& screened = results.screened.rows;
    Binned east({"east", "line", "blue", 3, 5}, rows.size());
    Binned north({"north", "line", "orange", 3, 5}, rows.size());
    Binned above({"", "thin", "grey", 3, 5}, rows.size());
    Binned below({"", "thin", "grey", 3, 5}, rows.size());
    Range times, values;
    for (std::size_t i = 0; i < std::min(rows.size(), screened.size()); ++i) {
        const ScreenedEpoch& measured = screened[i];
        const TrajectoryEpoch& row = rows[i];
        if (!measured.usable || !row.arc || !row.east_m || !measured.east_m) continue;
        const double bound_m = 2.0 * factor *
                               std::sqrt(0.5 * (std::pow(measured.sigma_east_m.value_or(0.0), 2) +
                                                std::pow(measured.sigma_north_m.value_or(0.0), 2)));
        const double time = row.time.seconds();
        times.widen(time);
        for (const auto& [bins, value] :
             {std::pair{&east, *measured.east_m - *row.east_m},
              std::pair{&north, *measured.north_m - *row.north_m}, std::pair{&above, bound_m},
              std::pair{&below, -bound_m}}) {
            bins->add(time, value, row.arc);
            values.widen(value);
            values.widen(-value);
        }
    }
    Plot plot{.kind = "residuals",
              .title = "Residuals: measured less smoothed positions",
              .caption =
                  "Of the epochs used. Grey: twice the standard deviation of a "
                  "coordinate, as the estimate uses it." +
                  east.words(),
              .x_label = time_label,
              .y_label = "residual (m)"};
    for (Binned* bins : {&east, &north, &above, &below})
        plot.add(bins->finished());
    plot.set_axes(times, values);
    return plot.curves.empty() ? Plots{} : Plots{std::move(plot)};
}

Plots test_plot(const ScreenedTable& table) {
    constexpr std::size_t rejections_shown = 400;
    constexpr double largest_ratio_shown = 5.0;
    Binned kept({"epochs kept", "line", "blue", 3, 4}, table.rows.size());
    Curve decided{"decided for an error", "points", "vermilion", 3, 4};
    Range times, ratios;
    ratios.widen(0.0);
    ratios.widen(1.2);
    for (const ScreenedEpoch& row : table.rows) {
        if (!row.statistic || !row.threshold || !(*row.threshold > 0.0)) continue;
        const double ratio = std::min(*row.statistic / *row.threshold, largest_ratio_shown);
        times.widen(row.time.seconds());
        ratios.widen(ratio);
        if (ratio <= 1.0)
            kept.add(row.time.seconds(), ratio, row.arc);
        else if (decided.size() < rejections_shown)
            decided.add(row.time.seconds(), ratio);
    }
    if (!(times.span() > 0.0)) return {};
    Plot plot{.kind = "innovations",
              .title = "Tests of screening",
              .caption =
                  fmt::format("Statistic of the best supported error over its threshold, from the "
                              "innovations: above 1 the error is decided for, and the epoch left "
                              "out or the stretch ended. A ratio above {0:g} is drawn at {0:g}.{1}",
                              largest_ratio_shown, kept.words()),
              .x_label = time_label,
              .y_label = "statistic over threshold",
              .levels = {{"threshold", 1.0}}};
    plot.add(kept.finished());
    plot.add(std::move(decided));
    plot.set_axes(times, ratios);
    return {std::move(plot)};
}

}  // namespace runcert
