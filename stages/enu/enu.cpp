#include "stages/enu/enu.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"

namespace runcert {
namespace {

constexpr double max_distance_m = 100'000.0;

Geodetic position_of(const Observation& row) {
    return {.latitude = Angle::from_degrees(*row.latitude_deg),
            .longitude = Angle::from_degrees(*row.longitude_deg),
            .height_m = *row.height_m};
}

bool has_position(const Observation& row) {
    return row.latitude_deg && row.longitude_deg && row.height_m;
}

/// The first fixed position, else the first of any kind: an origin taken from a solution without
/// a fix could be far away.
std::optional<Geodetic> first_position(const std::vector<Observation>& rows) {
    const auto fixed = std::find_if(rows.begin(), rows.end(), [](const Observation& row) {
        return has_position(row) && row.fix == FixKind::fixed;
    });
    if (fixed != rows.end()) return position_of(*fixed);
    const auto any = std::find_if(rows.begin(), rows.end(), [](const Observation& row) {
        return has_position(row) && row.fix != FixKind::none;
    });
    if (any != rows.end()) return position_of(*any);
    return std::nullopt;
}

StatedAccuracy accuracy_of(const Eigen::Matrix3d& covariance, bool vertical) {
    const Eigen::Vector3d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    const auto correlation = [&](int i, int j) -> std::optional<double> {
        const double scale = sigma(i) * sigma(j);
        if (!(scale > 0.0)) return std::nullopt;
        return covariance(i, j) / scale;
    };
    StatedAccuracy accuracy{.sigma_east_m = sigma(0),
                            .sigma_north_m = sigma(1),
                            .sigma_up_m = std::nullopt,
                            .correlation_east_north = correlation(0, 1),
                            .correlation_east_up = std::nullopt,
                            .correlation_north_up = std::nullopt};
    if (vertical) {
        accuracy.sigma_up_m = sigma(2);
        accuracy.correlation_east_up = correlation(0, 2);
        accuracy.correlation_north_up = correlation(1, 2);
    }
    return accuracy;
}

void rotate_velocity(const RecordedVelocity& from, const Eigen::Matrix3d& rotation, EnuEpoch& to) {
    if (!from.recorded_velocity_east_mps || !from.recorded_velocity_north_mps) return;
    const Eigen::Vector3d velocity =
        rotation * Eigen::Vector3d(*from.recorded_velocity_east_mps,
                                   *from.recorded_velocity_north_mps,
                                   from.recorded_velocity_up_mps.value_or(0.0));
    to.recorded_velocity_east_mps = velocity.x();
    to.recorded_velocity_north_mps = velocity.y();
    if (from.recorded_velocity_up_mps) to.recorded_velocity_up_mps = velocity.z();
    if (!from.sigma_recorded_velocity_east_mps || !from.sigma_recorded_velocity_north_mps) return;
    const Eigen::Vector3d variance =
        Eigen::Vector3d(*from.sigma_recorded_velocity_east_mps,
                        *from.sigma_recorded_velocity_north_mps,
                        from.sigma_recorded_velocity_up_mps.value_or(0.0))
            .cwiseAbs2();
    const Eigen::Matrix3d rotated = rotation * variance.asDiagonal() * rotation.transpose();
    to.sigma_recorded_velocity_east_mps = std::sqrt(rotated(0, 0));
    to.sigma_recorded_velocity_north_mps = std::sqrt(rotated(1, 1));
    if (from.sigma_recorded_velocity_up_mps)
        to.sigma_recorded_velocity_up_mps = std::sqrt(rotated(2, 2));
}

EnuEpoch carried_over(const Observation& row) {
    EnuEpoch epoch;
    static_cast<EpochQuality&>(epoch) = row;
    epoch.epoch = row.epoch;
    epoch.time = row.time;
    return epoch;
}

EnuEpoch from_local_plane(const Observation& row) {
    EnuEpoch epoch = carried_over(row);
    static_cast<StatedAccuracy&>(epoch) = row;
    static_cast<RecordedVelocity&>(epoch) = row;
    epoch.east_m = row.plane_east_m;
    epoch.north_m = row.plane_north_m;
    epoch.up_m = row.plane_up_m;
    return epoch;
}

EnuEpoch from_the_earth(const Observation& row, const LocalFrame& frame, bool vertical) {
    EnuEpoch epoch = carried_over(row);
    if (!has_position(row)) return epoch;
    const Geodetic position = position_of(row);
    const Eigen::Vector3d enu = frame.enu_from_geodetic(position).m;
    if (enu.norm() > max_distance_m && row.fix != FixKind::none)
        throw Failure(row.source_line ? fmt::format("line {} of the recording", *row.source_line)
                                      : fmt::format("epoch {}", row.epoch),
                      fmt::format("the position is {:.0f} km from the origin of the local frame",
                                  enu.norm() / 1000.0),
                      "Check `origin:` in the attempt, and whether latitude and longitude are "
                      "swapped");
    epoch.east_m = enu.x();
    epoch.north_m = enu.y();
    if (vertical) epoch.up_m = enu.z();
    const Eigen::Matrix3d rotation =
        frame.rotation_from_local(position.latitude, position.longitude);
    const bool vertical_stated = vertical && row.sigma_up_m.has_value();
    if (row.sigma_east_m && row.sigma_north_m)
        static_cast<StatedAccuracy&>(epoch) = accuracy_of(
            rotation * stated_covariance<3>(row) * rotation.transpose(), vertical_stated);
    rotate_velocity(row, rotation, epoch);
    return epoch;
}

}  // namespace

EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin) {
    EnuTable table;
    table.facts = observations.facts;
    table.rows.reserve(observations.rows.size());
    if (!observations.facts.georeferenced) {
        if (stated_origin)
            throw Failure("origin",
                          "an origin on the Earth is stated, but the recording's coordinates are "
                          "those of a local plane",
                          "Remove `origin:`, or state the coordinates' real frame");
        for (const Observation& row : observations.rows)
            table.rows.push_back(from_local_plane(row));
        return table;
    }
    const auto position = stated_origin ? stated_origin : first_position(observations.rows);
    if (!position)
        throw Failure("recording of receiver " + observations.facts.receiver,
                      "no epoch has a position", "Give a recording with positions");
    table.origin =
        FrameOrigin{.position = *position, .source = stated_origin ? "attempt" : "first_epoch"};
    const LocalFrame frame(*position);
    for (const Observation& row : observations.rows)
        table.rows.push_back(from_the_earth(row, frame, observations.facts.vertical_measured));
    return table;
}

}  // namespace runcert
