#include "stages/import/raw_track.h"

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "stages/import/inspect.h"
#include "stages/import/row_collector.h"

namespace runcert {
namespace {

Geodetic geodetic_of(const Observation& row) {
    return {.latitude = Angle::from_degrees(*row.latitude_deg),
            .longitude = Angle::from_degrees(*row.longitude_deg),
            .height_m = row.height_m.value_or(0.0)};
}

/// East and north of a position from another one.
Eigen::Vector2d plane_from(const Observation& first, const Observation& row) {
    if (!row.latitude_deg || !first.latitude_deg)
        return {row.plane_east_m.value_or(0.0) - first.plane_east_m.value_or(0.0),
                row.plane_north_m.value_or(0.0) - first.plane_north_m.value_or(0.0)};
    const Geodetic origin = geodetic_of(first);
    const Eigen::Vector3d chord =
        ecef_from_geodetic(geodetic_of(row)).m - ecef_from_geodetic(origin).m;
    return (rotation_enu_from_ecef(origin.latitude, origin.longitude) * chord).head<2>();
}

std::optional<double> horizontal_sigma(const Observation& row) {
    if (!row.sigma_east_m || !row.sigma_north_m) return std::nullopt;
    return std::hypot(*row.sigma_east_m, *row.sigma_north_m);
}

}  // namespace

RawTrack raw_track(const Observations& observations) {
    std::vector<const Observation*> rows;
    for (const Observation& row : observations.rows)
        rows.push_back(&row);
    std::ranges::stable_sort(rows, {}, [](const Observation* row) { return row->time; });
    const double gap_s = gap_factor * observations.facts.nominal_interval_s;
    const auto first =
        std::ranges::find_if(rows, [](const Observation* row) { return has_position(*row); });
    RawTrack track;
    for (const Observation* row : rows) {
        const double time_s = row->time.seconds();
        const double step_s = track.time_s.empty() ? 0.0 : time_s - track.time_s.back();
        if (step_s > gap_s) track.gaps.emplace_back(track.time_s.back(), time_s);
        std::optional<double> east, north, speed;
        if (has_position(*row)) {
            const Eigen::Vector2d at = plane_from(**first, *row);
            east = at.x();
            north = at.y();
            if (step_s > 0.0 && step_s <= gap_s && track.east_m.back())
                speed = std::hypot(*east - *track.east_m.back(), *north - *track.north_m.back()) /
                        step_s;
        }
        track.time_s.push_back(time_s);
        track.east_m.push_back(east);
        track.north_m.push_back(north);
        track.height_m.push_back(row->height_m);
        track.recorded_speed_m_s.push_back(horizontal_speed(*row));
        track.position_speed_m_s.push_back(speed);
        track.sigma_horizontal_m.push_back(horizontal_sigma(*row));
    }
    return track;
}

}  // namespace runcert
