#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "reports/compare/enhanced_kalman.h"
#include "reports/compare/methods.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

// Where the recording states no accuracy of its velocities, or zero.
constexpr double default_velocity_sigma_m_s = 0.1;
// Heights that were not measured, or whose accuracy is not known.
constexpr double loose_height_sigma_m = 1.0;

bool has_velocity(const RecordedVelocity& row) {
    return row.recorded_velocity_east_m_s && row.recorded_velocity_north_m_s;
}

bool stated(const std::optional<double>& sigma) {
    return sigma && *sigma > 0.0;
}

bool accuracy_stated(const RecordedVelocity& row) {
    return stated(row.sigma_recorded_velocity_east_m_s) &&
           stated(row.sigma_recorded_velocity_north_m_s) &&
           (!row.recorded_velocity_up_m_s || stated(row.sigma_recorded_velocity_up_m_s));
}

/// The recorded velocity in the axes of the place, `rotation` * frame.
MeasuredVelocity velocity_of(const RecordedVelocity& row, const Eigen::Matrix3d& rotation) {
    const auto variance = [](const std::optional<double>& sigma) {
        const double taken_m_s = stated(sigma) ? *sigma : default_velocity_sigma_m_s;
        return taken_m_s * taken_m_s;
    };
    const Eigen::Vector3d frame_m_s(*row.recorded_velocity_east_m_s,
                                    *row.recorded_velocity_north_m_s,
                                    row.recorded_velocity_up_m_s.value_or(0.0));
    const Eigen::Vector3d variances(variance(row.sigma_recorded_velocity_east_m_s),
                                    variance(row.sigma_recorded_velocity_north_m_s),
                                    variance(row.sigma_recorded_velocity_up_m_s));
    return {.enu_m_s = rotation * frame_m_s,
            .covariance_m2_s2 = rotation * variances.asDiagonal() * rotation.transpose()};
}

EnhancedKalmanEpoch epoch_of(const ScreenedEpoch& row, const PlaceFrames& frames) {
    EnhancedKalmanEpoch epoch;
    epoch.time_s = row.time.seconds();
    if (!row.east_m || !row.north_m) return epoch;
    const Geodetic position =
        frames.geodetic(row.time, {*row.east_m, *row.north_m, row.up_m.value_or(0.0)});
    const Eigen::Matrix3d rotation =
        frames.at(row.time).rotation_from_local(position.latitude, position.longitude).transpose();
    if (row.usable) {
        Eigen::Matrix3d covariance = stated_covariance<3>(row);
        if (!row.up_m || !row.sigma_up_m)
            covariance(2, 2) = loose_height_sigma_m * loose_height_sigma_m;
        epoch.position =
            MeasuredGeodetic{.position = position,
                             .covariance_enu_m2 = rotation * covariance * rotation.transpose()};
    }
    if (has_velocity(row)) epoch.velocity = velocity_of(row, rotation);
    return epoch;
}

/// Runs the filter along rows of one arc.
void filter_arc(const ScreenedTable& screened, const PlaceFrames& frames,
                const std::vector<std::size_t>& rows, MethodTrack& track) {
    std::vector<EnhancedKalmanEpoch> epochs;
    epochs.reserve(rows.size());
    for (const std::size_t row : rows)
        epochs.push_back(epoch_of(screened.rows[row], frames));
    const auto states = filter_enhanced_kalman(epochs);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (!states[k]) continue;
        track.positions[rows[k]] =
            frames.enu_m(screened.rows[rows[k]].time, states[k]->position).head<2>();
        if (states[k]->velocity_enu_m_s)
            track.speeds_m_s[rows[k]] = states[k]->velocity_enu_m_s->head<2>().norm();
    }
}

std::string accuracy_note(const ScreenedTable& screened) {
    std::int64_t velocities = 0;
    std::int64_t without = 0;
    for (const ScreenedEpoch& row : screened.rows)
        if (row.arc && has_velocity(row)) {
            ++velocities;
            without += accuracy_stated(row) ? 0 : 1;
        }
    if (without == 0) return {};
    return fmt::format(
        "[EKF] takes {} m/s for the accuracy of {} of {} recorded velocities, which is not stated",
        default_velocity_sigma_m_s, without, velocities);
}

bool any_velocity(const ScreenedTable& screened) {
    return std::any_of(screened.rows.begin(), screened.rows.end(),
                       [](const ScreenedEpoch& row) { return row.arc && has_velocity(row); });
}

MethodTrack track_of_velocities(const std::string& name, SpeedDefinition window_speed,
                                const ScreenedTable& screened) {
    MethodTrack track = empty_track(name, window_speed, screened.rows.size());
    if (!any_velocity(screened)) track.unavailable = "the recording has no velocities";
    return track;
}

}  // namespace

MethodTrack recorded_speed(const ScreenedTable& screened) {
    MethodTrack track =
        track_of_velocities("recorded velocity", SpeedDefinition::mean_n_plus_1, screened);
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (row.arc && has_velocity(row))
            track.speeds_m_s[i] =
                std::hypot(*row.recorded_velocity_east_m_s, *row.recorded_velocity_north_m_s);
    }
    return track;
}

EnhancedKalmanTrack enhanced_kalman_track(const ScreenedTable& screened) {
    EnhancedKalmanTrack result;
    MethodTrack& track = result.track;
    track = track_of_velocities("enhanced Kalman filter [EKF]", SpeedDefinition::mean_n, screened);
    if (!track.unavailable.empty()) return result;
    if (!screened.origin) {
        track.unavailable = "the positions are engineering coordinates, not tied to the Earth";
        return result;
    }
    const PlaceFrames frames(*screened.origin);
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        if (!screened.rows[i].arc) continue;
        if (!rows.empty() && screened.rows[rows.back()].arc != screened.rows[i].arc) {
            filter_arc(screened, frames, rows, track);
            rows.clear();
        }
        rows.push_back(i);
    }
    filter_arc(screened, frames, rows, track);
    result.note = accuracy_note(screened);
    return result;
}

}  // namespace runcert
