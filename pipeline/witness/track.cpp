#include "witness/track.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "schemas/enu/measured_position.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

bool is_estimated(const TrajectoryEpoch& row) {
    return row.arc && row.east_m && row.north_m && row.velocity_east_m_s &&
           row.velocity_north_m_s && row.acceleration_east_m_s2 && row.acceleration_north_m_s2 &&
           row.sigma_east_m && row.sigma_north_m;
}

}  // namespace

const TrackEpoch* epoch_near(const Track& track, double time_s) {
    const double nearest_s = 0.6 * std::max(track.nominal_interval_s, 1e-3);
    const auto after = std::ranges::lower_bound(track.epochs, time_s, {}, &TrackEpoch::time_s);
    const TrackEpoch* best = after == track.epochs.end() ? nullptr : &*after;
    if (after != track.epochs.begin() &&
        (best == nullptr || time_s - (after - 1)->time_s < best->time_s - time_s))
        best = &*(after - 1);
    return best != nullptr && std::abs(best->time_s - time_s) <= nearest_s ? best : nullptr;
}

Track track_of(const TrajectoryTable& trajectory) {
    Track track{.first_epoch = trajectory.facts.first_epoch,
                .origin = trajectory.origin,
                .nominal_interval_s = trajectory.facts.nominal_interval_s,
                .epochs = {}};
    for (const TrajectoryEpoch& row : trajectory.rows) {
        if (!is_estimated(row)) continue;
        TrackEpoch& epoch = track.epochs.emplace_back();
        epoch.time_s = row.time.seconds();
        epoch.stretch = *row.arc;
        epoch.usable = row.usable;
        epoch.has_height = row.up_m && row.sigma_up_m;
        epoch.position_m = {*row.east_m, *row.north_m, row.up_m.value_or(0.0)};
        epoch.velocity_m_s = {*row.velocity_east_m_s, *row.velocity_north_m_s,
                              row.velocity_up_m_s.value_or(0.0)};
        epoch.acceleration_m_s2 = {*row.acceleration_east_m_s2, *row.acceleration_north_m_s2, 0.0};
        epoch.variance_m2 =
            Eigen::Vector3d(*row.sigma_east_m, *row.sigma_north_m, row.sigma_up_m.value_or(0.0))
                .cwiseAbs2();
    }
    return track;
}

Track track_of(const ScreenedTable& screened, const Motion& motion) {
    assert(screened.rows.size() == motion.size());
    Track track{.first_epoch = screened.facts.first_epoch,
                .origin = screened.origin,
                .nominal_interval_s = screened.facts.nominal_interval_s,
                .epochs = {}};
    for (std::size_t i = 0; i < motion.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (!row.usable || !row.arc || !motion[i]) continue;
        TrackEpoch& epoch = track.epochs.emplace_back();
        epoch.time_s = row.time.seconds();
        epoch.stretch = *row.arc;
        epoch.usable = true;
        epoch.position_m.head<2>() = measured_position<2>(row);
        epoch.velocity_m_s.head<2>() = motion[i]->velocity;
        epoch.acceleration_m_s2.head<2>() = motion[i]->acceleration;
        epoch.variance_m2.head<2>() = stated_covariance<2>(row).diagonal();
    }
    return track;
}

}  // namespace runcert
