#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "core/speed_unit.h"
#include "inertial/attitude.h"
#include "reports/certificate/plots.h"
#include "schemas/common/rows_by_epoch.h"

namespace runcert {
namespace {

using Known = std::vector<const AttitudeEpoch*>;

/// The epochs with an attitude around a window.
Known attitudes_around(const AttitudeTable& table, std::pair<double, double> span) {
    Known all;
    for (const AttitudeEpoch& row : table.rows)
        if (row.roll_deg && row.time.seconds() >= span.first && row.time.seconds() <= span.second)
            all.push_back(&row);
    return thinned(all);
}

/// A figure over the time around the window, of curves with these values.
Plot over_time(Plot plot, const WindowSpan& window, const Range& values,
               std::initializer_list<Curve> curves) {
    const auto span = around(window);
    for (const Curve& curve : curves)
        plot.add(curve);
    plot.x_label = time_label;
    plot.spans = {window_span(window)};
    plot.set_axes({span.first, span.second}, values);
    return plot;
}

Plot roll_and_pitch(const Known& rows, const WindowSpan& window) {
    Curve roll{"roll", "line", "blue"}, pitch{"pitch", "line", "vermilion"};
    Range angles;
    for (const AttitudeEpoch* row : rows) {
        roll.add(row->time.seconds(), *row->roll_deg, 2.0 * *row->sigma_roll_deg, angles);
        pitch.add(row->time.seconds(), *row->pitch_deg, 2.0 * *row->sigma_pitch_deg, angles);
    }
    return over_time({.kind = "attitude",
                      .title = "Roll and pitch of the craft",
                      .caption = "By IMU and positions, each with a band of twice its standard "
                                 "uncertainty. Roll: right side down; pitch: nose up.",
                      .y_label = "angle (°)"},
                     window, angles, {roll, pitch});
}

/// Angles about the first one's full turn, so that a curve does not jump at north.
double near_deg(double angle_deg, double reference_deg) {
    return reference_deg + std::remainder(angle_deg - reference_deg, 360.0);
}

Plot heading_and_course(const Known& rows, const WindowSpan& window) {
    Curve heading{"heading", "line", "blue"}, course{"course over ground", "dashed", "black"};
    Range angles;
    const double first_deg = *rows.front()->heading_deg;
    for (const AttitudeEpoch* row : rows) {
        const double time_s = row->time.seconds();
        heading.add(time_s, near_deg(*row->heading_deg, first_deg), 2.0 * *row->sigma_heading_deg,
                    angles);
        const double east = *row->reference_velocity_east_m_s;
        const double north = *row->reference_velocity_north_m_s;
        // Slower, its direction is that of noise.
        if (constexpr double least_m_s = 1.0; std::hypot(east, north) < least_m_s) continue;
        const double course_deg = near_deg(azimuth_deg(east, north), first_deg);
        course.add(time_s, course_deg);
        angles.widen(course_deg);
    }
    return over_time({.kind = "heading",
                      .title = "Heading and course of the craft",
                      .caption = "Heading with a band of twice its standard uncertainty, and the "
                                 "course of the reference point. Clockwise from north.",
                      .y_label = "azimuth (°)"},
                     window, angles, {heading, course});
}

/// Horizontal speeds of both points.
Plot two_points(const Known& rows, const TrajectoryTable& trajectory, const RuleView& rule) {
    const SpeedUnit& unit = rule.unit();
    Curve antenna{"antenna", "line", "orange"}, craft{"reference point", "line", "blue"};
    Range speeds;
    const RowsByEpoch by_epoch(trajectory.rows);
    for (const AttitudeEpoch* row : rows) {
        const Eigen::Vector2d velocity(*row->reference_velocity_east_m_s,
                                       *row->reference_velocity_north_m_s);
        const double speed = velocity.norm();
        const Eigen::Vector2d along =
            speed > 0.0 ? Eigen::Vector2d(velocity / speed) : Eigen::Vector2d::UnitX().eval();
        const double sigma = std::hypot(along.x() * *row->sigma_reference_velocity_east_m_s,
                                        along.y() * *row->sigma_reference_velocity_north_m_s);
        craft.add(row->time.seconds(), speed * unit.per_m_s, 2.0 * sigma * unit.per_m_s, speeds);
        const TrajectoryEpoch* const at = by_epoch.find(row->epoch);
        if (!at || !at->speed_m_s) continue;
        antenna.add(row->time.seconds(), *at->speed_m_s * unit.per_m_s);
        speeds.widen(*at->speed_m_s * unit.per_m_s);
    }
    return over_time({.kind = "points",
                      .title = "Antenna and reference point",
                      .caption = "Horizontal speed of the antenna by the positions, and of the "
                                 "craft's reference point by IMU and positions. Band: twice its "
                                 "standard uncertainty.",
                      .y_label = fmt::format("horizontal speed ({})", unit.name)},
                     *rule.verdict.window, speeds, {antenna, craft});
}

/// The craft at one instant, drawn in a vertical plane.
class CraftDrawing {
  public:
    CraftDrawing(const AttitudeTable& table, Plot& plot) : plot_(plot) {
        const Eigen::Vector3d reference = vector_of(table.reference_point.value_or(LeverArm{}));
        mast_ = vector_of(table.antenna.used) - reference;
    }

    double size_m() const { return std::max(mast_.norm(), 1.0); }

    /// The plane is spanned by an axis and up; `at_m` is where the reference point is drawn.
    void draw(const AttitudeEpoch& row, const Eigen::Vector3d& axis,
              const Eigen::Vector3d& hull_axis, double at_m, const std::string& name) {
        const Eigen::Matrix3d turned =
            rotation_of({.roll = *row.roll_deg * radians_per_degree,
                         .pitch = *row.pitch_deg * radians_per_degree,
                         .heading = *row.heading_deg * radians_per_degree});
        const auto drawn = [&](const Eigen::Vector3d& on_craft) {
            const Eigen::Vector3d place = turned * on_craft;
            return Eigen::Vector2d(at_m + axis.dot(place), place.z());
        };
        const Eigen::Vector3d half = 0.2 * size_m() * hull_axis;
        line("craft, " + name, "black", {drawn(-half), drawn(half)});
        line("to the antenna, " + name, "orange", {drawn(Eigen::Vector3d::Zero()), drawn(mast_)});
        const Eigen::Vector2d antenna = drawn(mast_);
        plot_.marks.push_back({"antenna, " + name, antenna.x(), antenna.y()});
    }

    /// The surface in the plane, `half_m` to either side of the reference point. Without one there,
    /// a level line.
    void draw_ground(const AttitudeEpoch& row, const Triangulation* surface,
                     const Eigen::Vector3d& axis, double at_m, const std::string& name) {
        const double half_m = 0.5 * size_m();
        const Eigen::Vector2d place(*row.reference_east_m, *row.reference_north_m);
        constexpr int steps = 20;
        std::vector<Eigen::Vector2d> ground;
        for (int i = 0; surface != nullptr && i <= steps; ++i) {
            const double across_m = half_m * (2.0 * i / steps - 1.0);
            if (const auto below = surface->at(place + across_m * axis.head<2>()))
                ground.emplace_back(at_m + across_m, below->up_m - *row.reference_up_m);
        }
        if (ground.size() < 2)
            line("level, " + name, "grey", {{at_m - half_m, 0.0}, {at_m + half_m, 0.0}});
        else
            line("surface, " + name, "green", ground);
    }

    void finish() {
        const double room = 0.1 * size_m();
        for (Range* range : {&across_, &up_}) {
            range->widen(*range->least - room);
            range->widen(*range->most + room);
        }
        plot_.set_axes(across_, up_);
    }

  private:
    void line(const std::string& name, const char* colour,
              const std::vector<Eigen::Vector2d>& points) {
        Curve curve{name, "outline", colour};
        for (const Eigen::Vector2d& point : points) {
            curve.add(point.x(), point.y());
            across_.widen(point.x());
            up_.widen(point.y());
        }
        plot_.add(std::move(curve));
    }

    Plot& plot_;
    Eigen::Vector3d mast_;
    Range across_, up_;
};

/// The craft to scale where the window begins and where it ends, from the side or from behind.
Plot craft_to_scale(const ReportInputs& inputs, const AttitudeEpoch& start,
                    const AttitudeEpoch& end, bool from_behind) {
    Plot plot{
        .kind = from_behind ? "craft_behind" : "craft",
        .title = from_behind ? "The craft from behind" : "The craft from its right side",
        .caption = std::string("To scale, at the beginning of the window (left) and at its end: "
                               "craft, the line from its reference point to the antenna, and the "
                               "surface, or else the level. ") +
                   (from_behind ? "Its right is to the right." : "It goes towards the right."),
        .x_label = from_behind ? "across the course (m)" : "along the course (m)",
        .y_label = "above the reference point (m)",
        .equal_scale = true};
    const Triangulation* const surface = inputs.surface ? &*inputs.surface : nullptr;
    CraftDrawing drawing(*inputs.receivers.front().attitude, plot);
    double at_m = 0.0;
    for (const auto& [row, name] : {std::pair{&start, "begin"}, std::pair{&end, "end"}}) {
        const Eigen::Vector3d along = Eigen::Vector3d(*row->reference_velocity_east_m_s,
                                                      *row->reference_velocity_north_m_s, 0.0)
                                          .normalized();
        const Eigen::Vector3d right(along.y(), -along.x(), 0.0);
        drawing.draw(*row, from_behind ? right : along,
                     from_behind ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX(), at_m, name);
        drawing.draw_ground(*row, surface, from_behind ? right : along, at_m, name);
        at_m += 1.5 * drawing.size_m();
    }
    drawing.finish();
    return plot;
}

}  // namespace

Plots attitude_plots(const ReportInputs& inputs) {
    const ReceiverResults& results = inputs.receivers.front();
    const std::vector<RuleView> rules = rule_views(inputs);
    const RuleView* const rule = first_certified(rules);
    if (!results.attitude || rule == nullptr) return {};
    const WindowSpan& window = *rule->verdict.window;
    const Known rows = attitudes_around(*results.attitude, around(window));
    constexpr std::size_t least_epochs = 2;
    if (rows.size() < least_epochs) return {};
    const auto nearest = [&](double time_s) {
        return *std::ranges::min_element(rows, {}, [&](const AttitudeEpoch* row) {
            return std::abs(row->time.seconds() - time_s);
        });
    };
    const AttitudeEpoch& start = *nearest(window.start.seconds());
    const AttitudeEpoch& end = *nearest(window.start.seconds() + window.duration.seconds());
    return {roll_and_pitch(rows, window), heading_and_course(rows, window),
            two_points(rows, results.trajectory, *rule), craft_to_scale(inputs, start, end, false),
            craft_to_scale(inputs, start, end, true)};
}

}  // namespace runcert
