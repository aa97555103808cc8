#include "stages/screen/velocity_check_delays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "witness/recorded_velocities.h"
#include "witness/velocity_delay.h"

namespace runcert {
namespace {

using velocities::SpeedPair;

/// Whether the motion has a similar speed within a second and a half of a row.
bool motion_has(const std::vector<ScreenedEpoch>& rows, const Motion& motion, std::size_t at,
                double speed_m_s) {
    constexpr double near_s = 1.5;
    constexpr double largest_error_m_s = 1.0;  // twice what receivers showed
    constexpr double coverage = 3.0;
    double least = std::numeric_limits<double>::infinity(), most = 0.0;
    const auto hear = [&](std::size_t i) {
        if (std::abs(rows[i].time.seconds() - rows[at].time.seconds()) > near_s) return false;
        if (!rows[i].arc || !motion[i]) return true;
        const double by_positions = motion[i]->velocity.norm();
        const double error =
            largest_error_m_s + coverage * std::sqrt(motion[i]->velocity_covariance.trace());
        least = std::min(least, by_positions - error);
        most = std::max(most, by_positions + error);
        return true;
    };
    for (std::size_t i = at; i < rows.size() && hear(i); ++i) {
    }
    for (std::size_t i = at; i-- > 0 && hear(i);) {
    }
    return speed_m_s >= least && speed_m_s <= most;
}

}  // namespace

std::vector<VelocityDelay> velocity_delays(const std::vector<ScreenedEpoch>& rows,
                                           const Motion& motion, double delay_max_s) {
    std::vector<SpeedPair> pairs;
    std::vector<std::int64_t> epochs;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const ScreenedEpoch& row = rows[i];
        if (is_out_of_time(row)) continue;
        SpeedPair& pair = pairs.emplace_back();
        pair.time_s = row.time.seconds();
        if (const auto speed = recorded_speed(row, true, false))
            pair.recorded_m_s = speed->speed_m_s;
        if (row.arc && motion[i]) pair.by_positions_m_s = motion[i]->velocity.norm();
        epochs.push_back(row.epoch);
    }
    // However small the delay to be removed, one of up to a second does not count as another
    // moment.
    const double limit_s = std::max(delay_max_s, 1.0);
    std::vector<VelocityDelay> delays;
    for (const velocities::DelayStretch& one : velocities::delays_along(pairs, limit_s))
        delays.push_back({.first_epoch = epochs[one.first],
                          .last_epoch = epochs[one.last],
                          .delay_s = one.delay_s,
                          .sigma_s = one.sigma_s,
                          .difference_m_s = one.difference_m_s,
                          .difference_within_m_s = one.difference_within_m_s,
                          .beyond = one.is_beyond(limit_s)});
    return delays;
}

double share_of(const std::vector<ScreenedEpoch>& rows, const std::vector<bool>& chosen) {
    double all = 0.0, those = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (!recorded_speed(rows[i], true, false)) continue;
        all += 1.0;
        those += chosen[i] ? 1.0 : 0.0;
    }
    return all > 0.0 ? those / all : 0.0;
}

double contradicted_share(const std::vector<ScreenedEpoch>& rows, const Motion& motion,
                          const std::vector<bool>& of_other_moments) {
    double all = 0.0, contradicted = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto speed = recorded_speed(rows[i], true, false);
        const bool found = of_other_moments[i] || rows[i].reason == Reason::velocity;
        if (!speed || !(found || (rows[i].arc && motion[i]))) continue;
        all += 1.0;
        contradicted += found || !motion_has(rows, motion, i, speed->speed_m_s) ? 1.0 : 0.0;
    }
    return all > 0.0 ? contradicted / all : 0.0;
}

}  // namespace runcert
