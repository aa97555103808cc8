#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/angle.h"
#include "stages/import/earth.h"
#include "stages/import/row_collector.h"

namespace runcert {
namespace {

/// The height at which to put the positions of a recording that has none.
std::optional<double> set_heights(Observations& observations, const RowSummary& rows,
                                  const Receiver& receiver) {
    if (!rows.first_latitude_deg || rows.any_height) return std::nullopt;
    observations.facts.vertical_measured = false;
    if (!receiver.height_m)
        observations.notes.push_back(
            "Heights are not recorded: write height_m in the receiver, the course's height above "
            "the ellipsoid in metres; without it no position can be used.");
    else
        observations.notes.push_back(
            fmt::format("Heights are not recorded; every position is put at the attempt's {} m.",
                        *receiver.height_m));
    return receiver.height_m;
}

/// Says where the accuracy comes from, and where the recording states none, takes the attempt's.
void set_accuracy(Observations& observations, const RowSummary& rows, const Receiver& receiver,
                  RowChanges& changes) {
    observations.accuracy_source = rows.any_horizontal ? "recording" : "none";
    const auto& stated = receiver.accuracy;
    if (!rows.any_horizontal && stated && stated->horizontal_m) {
        observations.accuracy_source = "attempt";
        observations.notes.push_back(fmt::format(
            "The recording states no accuracy; the attempt's is used: {} m for each horizontal "
            "coordinate.",
            *stated->horizontal_m));
        changes.sigma_horizontal_m = stated->horizontal_m;
    }
    if (!rows.any_vertical && observations.facts.vertical_measured && stated &&
        stated->vertical_m) {
        observations.notes.push_back(
            fmt::format("The recording states no accuracy of height; the attempt's is used: {} m.",
                        *stated->vertical_m));
        changes.sigma_up_m = stated->vertical_m;
    }
    if (rows.any_horizontal && rows.without_horizontal > 0)
        observations.notes.push_back(
            fmt::format("{} of {} epochs state no usable horizontal accuracy.",
                        rows.without_horizontal, rows.rows));
    if (rows.any_horizontal && stated && stated->horizontal_m)
        observations.notes.push_back(
            "The recording states its own accuracy, which is used; the attempt's is not, where the "
            "recording has one.");
}

void note_speeds_alone(Observations& observations, const RowSummary& rows) {
    if (rows.speeds_alone > 0)
        observations.notes.push_back(
            fmt::format("{} of {} recorded velocities come without a course, and are used as "
                        "speeds.",
                        rows.speeds_alone, rows.with_velocity));
}

/// Says how accurate the recorded velocities are by the attempt's word.
void set_velocity_accuracy(Observations& observations, const RowSummary& rows,
                           const Receiver& receiver, RowChanges& changes) {
    if (!receiver.accuracy || !receiver.accuracy->velocity_m_s) return;
    if (rows.with_velocity == 0)
        observations.notes.push_back(
            "The attempt's accuracy of velocities is not used: no velocities are recorded.");
    else if (rows.velocity_unstated == 0)
        observations.notes.push_back(
            "The recording states how accurate its velocities are, which is used; the attempt's "
            "accuracy of velocities is not.");
    else
        observations.notes.push_back(fmt::format(
            "{} of {} recorded velocities state no accuracy; the attempt's is used: {} m/s.",
            rows.velocity_unstated, rows.with_velocity, *receiver.accuracy->velocity_m_s));
    changes.sigma_velocity_m_s = receiver.accuracy->velocity_m_s;
}

constexpr double moved_m = 100.0;
constexpr std::size_t least_rows = 30;
/// Of the way towards north: what goes further towards east does not go north.
constexpr double astray = 0.2;
constexpr double slowest_m_s = 0.1;
constexpr double slow_m_s = 1.5;
constexpr double same_direction = 1e-9;
constexpr std::array<std::string_view, 8> formats_with_course{"vbo", "nmea", "gpx", "gpsbabel",
                                                              "igc", "oao",  "sbp", "sbn"};

/// How far the positions reach towards east and north, m, on a sphere.
struct Extent {
    double east_m = 0.0, north_m = 0.0;
};

Extent extent_of(const std::vector<Observation>& rows) {
    constexpr double metres_per_degree = 6'371e3 * radians_per_degree;
    Extent extent;
    const Observation* first = nullptr;
    for (const Observation& row : rows) {
        if (!has_position(row)) continue;
        if (!first) first = &row;
        const bool plane = row.plane_east_m.has_value();
        const double east_m = plane ? *row.plane_east_m - *first->plane_east_m
                                    : (*row.longitude_deg - *first->longitude_deg) *
                                          metres_per_degree *
                                          std::cos(*first->latitude_deg * radians_per_degree);
        const double north_m = plane
                                   ? *row.plane_north_m - *first->plane_north_m
                                   : (*row.latitude_deg - *first->latitude_deg) * metres_per_degree;
        extent.east_m = std::max(extent.east_m, std::abs(east_m));
        extent.north_m = std::max(extent.north_m, std::abs(north_m));
    }
    return extent;
}

double speed_of(const RecordedVelocity& row) {
    return *horizontal_speed(row);
}

/// Leaves of a velocity its length.
void forget_course(RecordedVelocity& row) {
    RecordedVelocity speed;
    speed.recorded_speed_m_s = speed_of(row);
    if (has_velocity_accuracy(row))
        speed.sigma_recorded_speed_m_s =
            std::max(*row.sigma_recorded_velocity_east_m_s, *row.sigma_recorded_velocity_north_m_s);
    speed.recorded_velocity_up_m_s = row.recorded_velocity_up_m_s;
    speed.sigma_recorded_velocity_up_m_s = row.sigma_recorded_velocity_up_m_s;
    row = speed;
}

/// What all the velocities of a recording have in common.
struct Velocities {
    std::size_t count = 0, moving = 0, with_course = 0;
    bool all_north = true;
};

Velocities velocities_of(const std::vector<Observation>& rows) {
    Velocities all;
    for (const Observation& row : rows) {
        if (row.recorded_speed_m_s) ++all.moving;  // what is zero is a velocity
        if (!has_velocity(row)) continue;
        ++all.count;
        if (speed_of(row) == 0.0) continue;
        ++all.moving;
        ++all.with_course;
        all.all_north = all.all_north && *row.recorded_velocity_east_m_s == 0.0 &&
                        *row.recorded_velocity_north_m_s > 0.0;
    }
    return all;
}

bool is_same_direction(const RecordedVelocity& a, const RecordedVelocity& b) {
    const double cross = *a.recorded_velocity_east_m_s * *b.recorded_velocity_north_m_s -
                         *a.recorded_velocity_north_m_s * *b.recorded_velocity_east_m_s;
    return std::abs(cross) <= same_direction * speed_of(a) * speed_of(b);
}

/// Of courses that stand still, their number.
std::size_t forget_frozen_courses(std::vector<Observation>& rows) {
    std::size_t frozen = 0;
    RecordedVelocity before;
    for (Observation& row : rows) {
        if (!has_velocity(row)) continue;
        const RecordedVelocity velocity = row;
        const double speed = speed_of(velocity);
        if (speed > slowest_m_s && speed < slow_m_s && has_velocity(before) &&
            speed_of(before) > 0.0 && speed != speed_of(before) &&
            is_same_direction(velocity, before)) {
            forget_course(row);
            ++frozen;
        }
        if (speed > 0.0) before = velocity;
    }
    return frozen;
}

/// Takes out of a recording's velocities what its device did not measure, and notes it:
///
/// - velocities that are all zero while the positions move: the field was never filled;
/// - courses that are all north while the positions go elsewhere: the same of the course; the
///   speeds stay;
/// - a course that stands at its last value while the speed goes on changing below 1.5 m/s, as
///   devices write whose satellites no longer show it: that epoch's speed stays. Only of formats
///   that record a course.
void drop_unfilled_velocities(Observations& observations) {
    std::vector<Observation>& rows = observations.rows;
    const Velocities all = velocities_of(rows);
    const Extent extent = extent_of(rows);
    const bool moves = std::hypot(extent.east_m, extent.north_m) > moved_m;
    if (all.count >= least_rows && all.moving == 0 && moves) {
        for (Observation& row : rows)
            static_cast<RecordedVelocity&>(row) = {};
        observations.notes.push_back(
            "Every recorded velocity is zero while the positions move: velocities are not used.");
        return;
    }
    if (all.moving >= least_rows && all.all_north && all.with_course > 0 && moves &&
        extent.east_m > astray * extent.north_m) {
        for (Observation& row : rows)
            if (has_velocity(row) && speed_of(row) > 0.0) forget_course(row);
        observations.notes.push_back(
            "Every recorded course is north while the positions go elsewhere: courses are not "
            "used.");
        return;
    }
    if (std::find(formats_with_course.begin(), formats_with_course.end(), observations.format) ==
        formats_with_course.end())
        return;
    if (const std::size_t frozen = forget_frozen_courses(rows); frozen > 0)
        observations.notes.push_back(fmt::format(
            "{} recorded courses stand still below {} m/s, and are not used.", frozen, slow_m_s));
}

}  // namespace

void RowChanges::apply(Observation& row) const {
    if (height_m && row.latitude_deg) row.height_m = *height_m;
    if (sigma_velocity_m_s) set_component_accuracy(row, *sigma_velocity_m_s);
    if (!has_position(row)) return;
    if (sigma_horizontal_m) {
        row.sigma_east_m = row.sigma_north_m = *sigma_horizontal_m;
        // Of which no correlation is known.
        row.correlation_east_north.reset();
        row.correlation_east_up.reset();
        row.correlation_north_up.reset();
    }
    if (sigma_up_m) row.sigma_up_m = *sigma_up_m;
}

RowChanges apply_attempt(Observations& head, const RowSummary& rows, const Receiver& receiver,
                         bool start_is_used) {
    head.facts.receiver = receiver.id;
    RowChanges changes;
    changes.height_m = set_heights(head, rows, receiver);
    if (receiver.start_gps && !start_is_used)
        head.notes.push_back(
            "The attempt's start_gps is not used: the recording has times of its own.");
    set_accuracy(head, rows, receiver, changes);
    note_speeds_alone(head, rows);
    set_velocity_accuracy(head, rows, receiver, changes);
    return changes;
}

void apply_attempt(Observations& observations, const Receiver& receiver, bool start_is_used) {
    drop_unfilled_velocities(observations);
    RowSummary summary;
    for (const Observation& row : observations.rows)
        summary.add(row);
    const RowChanges changes = apply_attempt(observations, summary, receiver, start_is_used);
    for (Observation& row : observations.rows)
        changes.apply(row);
}

}  // namespace runcert
