#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/angle.h"
#include "inertial/attitude.h"
#include "reports/certificate/json_figures.h"
#include "schemas/common/rows_by_epoch.h"

namespace runcert {
namespace {

constexpr std::size_t points_of_an_attitude = 400;

using Known = std::vector<const AttitudeEpoch*>;

/// The epochs with an attitude around a window, half of its length or a second on either side.
struct AroundWindow {
    double from_s = 0.0;
    double to_s = 0.0;
    Known rows;
};

AroundWindow attitudes_around(const AttitudeTable& table, const WindowSpan& window) {
    const double start_s = window.start.seconds();
    const double length_s = window.duration.seconds();
    const double pad_s = std::max(0.5 * length_s, 1.0);
    AroundWindow around{.from_s = start_s - pad_s, .to_s = start_s + length_s + pad_s, .rows = {}};
    Known all;
    for (const AttitudeEpoch& row : table.rows)
        if (row.roll_deg && row.time.seconds() >= around.from_s &&
            row.time.seconds() <= around.to_s)
            all.push_back(&row);
    const std::size_t every = 1 + all.size() / points_of_an_attitude;
    for (std::size_t i = 0; i < all.size(); i += every)
        around.rows.push_back(all[i]);
    return around;
}

Json with_window(Json figure, const AroundWindow& around, const Range& values,
                 const WindowSpan& window) {
    add_window_span(figure["spans"], window, "window", "window");
    set_axes(figure, around.from_s, around.to_s, values.least.value_or(0.0),
             values.most.value_or(0.0));
    return figure;
}

Json roll_and_pitch(const AroundWindow& around, const WindowSpan& window) {
    Json figure = empty_figure("attitude", "Roll and pitch of the craft",
                               "By IMU and positions, each with a band of twice its standard "
                               "uncertainty. Roll: right side down; pitch: nose up. Shaded: the "
                               "window.",
                               time_label, "angle (°)");
    Curve roll({"roll", "line", "blue"}), pitch({"pitch", "line", "vermilion"});
    Range angles;
    for (const AttitudeEpoch* row : around.rows) {
        const double time_s = row->time.seconds();
        roll.add(time_s, *row->roll_deg, 2.0 * *row->sigma_roll_deg, angles);
        pitch.add(time_s, *row->pitch_deg, 2.0 * *row->sigma_pitch_deg, angles);
    }
    roll.add_to(figure);
    pitch.add_to(figure);
    return with_window(std::move(figure), around, angles, window);
}

/// Angles about the first one's full turn, so that a curve does not jump at north.
double near_deg(double angle_deg, double reference_deg) {
    return reference_deg + std::remainder(angle_deg - reference_deg, 360.0);
}

Json heading_and_course(const AroundWindow& around, const WindowSpan& window) {
    Json figure = empty_figure("heading", "Heading and course of the craft",
                               "Heading with a band of twice its standard uncertainty; dashed: "
                               "the course of the reference point over ground. Clockwise from "
                               "north. Shaded: the window.",
                               time_label, "azimuth (°)");
    Curve heading({"heading", "line", "blue"}), course({"course", "dashed", "black"});
    Range angles;
    const double first_deg = *around.rows.front()->heading_deg;
    for (const AttitudeEpoch* row : around.rows) {
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
    heading.add_to(figure);
    course.add_to(figure);
    return with_window(std::move(figure), around, angles, window);
}

/// Horizontal speeds of both points.
Json two_points(const AroundWindow& around, const TrajectoryTable& trajectory,
                const RuleView& rule) {
    const SpeedUnit& unit = rule.unit();
    Json figure = empty_figure(
        "points", "Antenna and reference point",
        "Horizontal speed of the antenna by the positions, and of the craft's reference point by "
        "IMU and positions. Band: twice its standard uncertainty. Shaded: the window.",
        time_label, fmt::format("horizontal speed ({})", unit.name));
    Curve antenna({"antenna", "line", "orange"}), craft({"reference point", "line", "blue"});
    Range speeds;
    const RowsByEpoch by_epoch(trajectory.rows);
    for (const AttitudeEpoch* row : around.rows) {
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
    antenna.add_to(figure);
    craft.add_to(figure);
    return with_window(std::move(figure), around, speeds, *rule.verdict.window);
}

/// The craft at one instant, drawn in a vertical plane.
class CraftDrawing {
  public:
    CraftDrawing(const AttitudeTable& table, Json& figure) : figure_(figure) {
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
        line("craft, " + name, {drawn(-half), drawn(half)});
        line("to the antenna, " + name, {drawn(Eigen::Vector3d::Zero()), drawn(mast_)});
        const Eigen::Vector2d antenna = drawn(mast_);
        add_mark(figure_, "antenna, " + name, antenna.x(), antenna.y());
    }

    void line(const std::string& name, const std::vector<Eigen::Vector2d>& points) {
        for (const Eigen::Vector2d& point : points) {
            across_.widen(point.x());
            up_.widen(point.y());
        }
        figure_["segments"].push_back(segment(name, points));
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
            line("level, " + name, {{at_m - half_m, 0.0}, {at_m + half_m, 0.0}});
        else
            line("surface, " + name, ground);
    }

    void finish() {
        const double room = 0.1 * size_m();
        set_axes(figure_, *across_.least - room, *across_.most + room, *up_.least - room,
                 *up_.most + room);
    }

  private:
    Json& figure_;
    Eigen::Vector3d mast_;
    Range across_, up_;
};

/// The craft to scale where the window begins and where it ends, from the side or from behind.
Json craft_to_scale(const ReportInputs& inputs, const AttitudeEpoch& start,
                    const AttitudeEpoch& end, bool from_behind) {
    Json figure = empty_figure(
        from_behind ? "craft_behind" : "craft",
        from_behind ? "The craft from behind" : "The craft from its right side",
        fmt::format("To scale, at the beginning of the window (left) and at its end: craft, the "
                    "line from its reference point to the antenna, and the surface, or else the "
                    "level. {}",
                    from_behind ? "Its right is to the right." : "It goes towards the right."),
        from_behind ? "across the course (m)" : "along the course (m)",
        "above the reference point (m)");
    figure["equal_scale"] = true;
    const Triangulation* const surface = inputs.surface ? &*inputs.surface : nullptr;
    CraftDrawing drawing(*inputs.receivers.front().attitude, figure);
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
    return figure;
}

}  // namespace

std::vector<Json> attitude_figures(const ReportInputs& inputs, const RuleView& rule) {
    const ReceiverResults& results = inputs.receivers.front();
    if (!results.attitude) return {};
    const AttitudeTable& table = *results.attitude;
    const TrajectoryTable& trajectory = results.trajectory;
    const WindowSpan& window = *rule.verdict.window;
    const AroundWindow around = attitudes_around(table, window);
    constexpr std::size_t least_epochs = 2;
    if (around.rows.size() < least_epochs) return {};
    std::vector<Json> figures{roll_and_pitch(around, window), heading_and_course(around, window),
                              two_points(around, trajectory, rule)};
    const auto nearest = [&](double time_s) {
        return *std::ranges::min_element(around.rows, {}, [&](const AttitudeEpoch* row) {
            return std::abs(row->time.seconds() - time_s);
        });
    };
    const AttitudeEpoch& start = *nearest(window.start.seconds());
    const AttitudeEpoch& end = *nearest(window.start.seconds() + window.duration.seconds());
    for (const bool from_behind : {false, true})
        figures.push_back(craft_to_scale(inputs, start, end, from_behind));
    return figures;
}

}  // namespace runcert
