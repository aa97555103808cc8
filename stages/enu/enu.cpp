#include "stages/enu/enu.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "schemas/observations/stated_covariance.h"

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
    if (!from.recorded_velocity_east_m_s || !from.recorded_velocity_north_m_s) return;
    const Eigen::Vector3d velocity =
        rotation * Eigen::Vector3d(*from.recorded_velocity_east_m_s,
                                   *from.recorded_velocity_north_m_s,
                                   from.recorded_velocity_up_m_s.value_or(0.0));
    to.recorded_velocity_east_m_s = velocity.x();
    to.recorded_velocity_north_m_s = velocity.y();
    if (from.recorded_velocity_up_m_s) to.recorded_velocity_up_m_s = velocity.z();
    if (!from.sigma_recorded_velocity_east_m_s || !from.sigma_recorded_velocity_north_m_s) return;
    const Eigen::Vector3d variance =
        Eigen::Vector3d(*from.sigma_recorded_velocity_east_m_s,
                        *from.sigma_recorded_velocity_north_m_s,
                        from.sigma_recorded_velocity_up_m_s.value_or(0.0))
            .cwiseAbs2();
    const Eigen::Matrix3d rotated = rotation * variance.asDiagonal() * rotation.transpose();
    to.sigma_recorded_velocity_east_m_s = std::sqrt(rotated(0, 0));
    to.sigma_recorded_velocity_north_m_s = std::sqrt(rotated(1, 1));
    if (from.sigma_recorded_velocity_up_m_s)
        to.sigma_recorded_velocity_up_m_s = std::sqrt(rotated(2, 2));
}

EnuEpoch carried_over(const Observation& row) {
    EnuEpoch epoch;
    static_cast<EpochQuality&>(epoch) = row;
    epoch.epoch = row.epoch;
    epoch.time = row.time;
    epoch.recorded_speed_m_s = row.recorded_speed_m_s;
    epoch.sigma_recorded_speed_m_s = row.sigma_recorded_speed_m_s;
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
    if (enu.norm() > max_distance_m && row.fix != FixType::none)
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

bool FirstPosition::see(const Observation& row) {
    if (!has_position(row)) return true;
    if (row.fix == FixType::fixed) fixed_ = position_of(row);
    if (!any_ && row.fix != FixType::none) any_ = position_of(row);
    return !fixed_;
}

ToLocalFrame::ToLocalFrame(const RecordingFacts& facts, const std::optional<Geodetic>& stated,
                           const std::optional<Geodetic>& first)
    : vertical_(facts.vertical_measured) {
    if (!facts.georeferenced) {
        if (stated)
            throw Failure("origin",
                          "a geodetic origin is stated, but the recording's coordinates are "
                          "those of an engineering CRS",
                          "Remove `origin:`, or state the coordinates' real frame");
        return;
    }
    const auto position = stated ? stated : first;
    if (!position)
        throw Failure("recording of receiver " + facts.receiver, "no epoch has a position",
                      "Give a recording with positions");
    origin_ = FrameOrigin{.position = *position, .source = stated ? "attempt" : "first_epoch"};
    frame_.emplace(*position);
}

EnuEpoch ToLocalFrame::operator()(const Observation& row) const {
    return frame_ ? from_the_earth(row, *frame_, vertical_) : from_local_plane(row);
}

EnuTable to_enu(const Observations& observations, const std::optional<Geodetic>& stated_origin) {
    const RecordingFacts& facts = observations.facts;
    FirstPosition first;
    if (ToLocalFrame::needs_first_position(facts, stated_origin))
        (void)std::ranges::all_of(observations.rows,
                                  [&](const Observation& row) { return first.see(row); });
    const ToLocalFrame to_local(facts, stated_origin, first.position());
    EnuTable table;
    table.facts = facts;
    table.origin = to_local.origin();
    table.rows.reserve(observations.rows.size());
    for (const Observation& row : observations.rows)
        table.rows.push_back(to_local(row));
    return table;
}

}  // namespace runcert
