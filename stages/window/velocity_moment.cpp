#include "stages/window/velocity_moment.h"

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"
#include "stages/window/position_speed.h"
#include "stages/window/sample_series.h"
#include "witness/recorded_velocities.h"

namespace runcert {
namespace {

/// The point at the fraction `s` between two points `step_s` apart, on the cubic through both.
TrackPoint between(const TrackPoint& a, const TrackPoint& b, double step_s, double s) {
    const double r = 1.0 - s;
    TrackPoint at;
    at.position = r * r * ((1.0 + 2.0 * s) * a.position + s * step_s * a.velocity) +
                  s * s * ((1.0 + 2.0 * r) * b.position - r * step_s * b.velocity);
    at.velocity = 6.0 * s * r / step_s * (b.position - a.position) +
                  r * (1.0 - 3.0 * s) * a.velocity + s * (1.0 - 3.0 * r) * b.velocity;
    return at;
}

/// Length of the path between two points, by Simpson's rule.
double path_between(const TrackPoint& a, const TrackPoint& b, double step_s) {
    return step_s / 6.0 *
           (a.velocity.norm() + 4.0 * between(a, b, step_s, 0.5).velocity.norm() +
            b.velocity.norm());
}

/// Standard deviations of a sample's position and velocity, along the worst of the axes that count.
struct SampleSigmas {
    double position_m = 0.0, velocity_m_s = 0.0;
};
SampleSigmas sigmas_of(const TrajectoryEpoch& row, Dimension dimension) {
    SampleSigmas sigmas;
    if (dimension != Dimension::vertical)
        sigmas = {.position_m = std::max(*row.sigma_east_m, *row.sigma_north_m),
                  .velocity_m_s = std::max(row.sigma_velocity_east_m_s.value_or(0.0),
                                           row.sigma_velocity_north_m_s.value_or(0.0))};
    if (dimension != Dimension::horizontal)
        sigmas = {
            .position_m = std::max(sigmas.position_m, row.sigma_up_m.value_or(0.0)),
            .velocity_m_s = std::max(sigmas.velocity_m_s, row.sigma_velocity_up_m_s.value_or(0.0))};
    return sigmas;
}

}  // namespace

Eigen::Vector3d SmoothedTrack::position(std::size_t k) const {
    const TrajectoryEpoch& at = row(k);
    return axes_.cwiseProduct(Eigen::Vector3d(*at.east_m, *at.north_m, at.up_m.value_or(0.0)));
}

Eigen::Vector3d SmoothedTrack::velocity(std::size_t k) const {
    const TrajectoryEpoch& at = row(k);
    return axes_.cwiseProduct(Eigen::Vector3d(*at.velocity_east_m_s, *at.velocity_north_m_s,
                                              at.velocity_up_m_s.value_or(0.0)));
}

TrackPoint SmoothedTrack::at(double time_s) const {
    const auto sample = [&](std::size_t k) { return TrackPoint{position(k), velocity(k)}; };
    const auto after = std::ranges::upper_bound(arc_.rows, time_s, {}, [&](std::size_t row) {
        return trajectory_.rows[row].time.seconds();
    });
    const auto k =
        static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - arc_.rows.begin(), 1)) - 1;
    if (k + 1 == arc_.rows.size()) return sample(k);
    const double step_s = this->time_s(k + 1) - this->time_s(k);
    return between(sample(k), sample(k + 1), step_s,
                   std::clamp((time_s - this->time_s(k)) / step_s, 0.0, 1.0));
}

double sigma_of_delay(const ScreenedTable& screened) {
    const auto& velocity = screened.basis.velocity;
    if (velocity && velocity->delay_s) return velocity->sigma_delay_s.value_or(0.0);
    const auto& errors = screened.basis.velocity_errors;
    return errors.empty() ? 0.0 : errors.front().sigma_delay_s;
}

double delay_of_velocities(const ScreenedTable& screened) {
    const auto& velocity = screened.basis.velocity;
    return velocity ? velocity->delay_s.value_or(0.0) : 0.0;
}

void move_to_moments(SampleSeries& series, double delay_s) {
    const std::size_t count = series.times.size();
    if (delay_s == 0.0) return;
    const auto time_s = [&](std::size_t k) { return series.times[k].seconds(); };
    const auto point = [&](std::size_t k) {
        const std::size_t a = k == 0 ? 0 : k - 1, b = std::min(k + 1, count - 1);
        return TrackPoint{
            .position = series.positions[k],
            .velocity = (series.positions[b] - series.positions[a]) / (time_s(b) - time_s(a))};
    };
    std::vector<Eigen::Vector3d> moved = series.positions;
    std::size_t before = 0;
    for (std::size_t k = 0; k < count; ++k) {
        const double at_s = time_s(k) - delay_s;
        if (at_s < time_s(0) || at_s > time_s(count - 1)) {
            series.bounds[k] = false;
            continue;
        }
        while (before + 2 < count && time_s(before + 1) <= at_s)
            ++before;
        const double step_s = time_s(before + 1) - time_s(before);
        moved[k] =
            between(point(before), point(before + 1), step_s, (at_s - time_s(before)) / step_s)
                .position;
    }
    series.positions = std::move(moved);
}

std::vector<ComparedSpeed> compared_speeds(const ScreenedTable& screened,
                                           const TrajectoryTable& trajectory,
                                           const std::vector<ArcRows>& arcs, Dimension dimension) {
    constexpr double rounding_s = 1e-6;
    const std::vector<bool> left_out = velocities_left_out(screened.rows, screened.basis.velocity,
                                                           dimension != Dimension::horizontal);
    const double longest_s = std::max(1.0, 1.5 * trajectory.facts.nominal_interval_s) + rounding_s;
    const double delay_s = delay_of_velocities(screened);
    std::vector<ComparedSpeed> compared;
    std::int64_t stretch = 0;
    for (const ArcRows& arc : arcs) {
        ++stretch;
        const SmoothedTrack track(trajectory, arc, dimension);
        const std::size_t before_arc = compared.size();
        const double last_s = track.time_s(arc.rows.size() - 1);
        for (std::size_t k = 0; k < arc.rows.size(); ++k) {
            const auto recorded = recorded_speed(screened.rows[arc.rows[k]], dimension);
            const double at_s = track.time_s(k) - delay_s;
            const bool is_on_track = at_s >= track.time_s(0) && at_s <= last_s;
            if (!recorded || !is_on_track || !track.row(k).usable || left_out[arc.rows[k]]) {
                ++stretch;
                continue;
            }
            ComparedSpeed one{.time_s = track.time_s(k),
                              .recorded_m_s = recorded->speed_m_s,
                              .track = track.at(at_s),
                              .stated_m_s = recorded->standard_uncertainty_m_s};
            one.smoothed_m_s = one.track.velocity.norm();
            if (compared.size() > before_arc) {
                const ComparedSpeed& before = compared.back();
                const double step_s = one.time_s - before.time_s;
                if (step_s > longest_s) ++stretch;
                one.recorded_m =
                    before.recorded_m + 0.5 * step_s * (before.recorded_m_s + one.recorded_m_s);
                one.smoothed_m = before.smoothed_m + path_between(before.track, one.track, step_s);
            }
            one.stretch = stretch;
            compared.push_back(one);
        }
    }
    return compared;
}

SpeedEstimate track_speed(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                          const ArcRows& arc, const Profile& profile, const FoundWindow& found,
                          std::span<const ComparedSpeed> window) {
    const SmoothedTrack track(trajectory, arc, profile.dimension);
    const double duration_s = found.duration_s();
    double ends = 0.0, floors = 0.0;
    for (const std::size_t k : {found.first, found.last}) {
        ends += std::pow(sigmas_of(track.row(k), profile.dimension).position_m / duration_s, 2);
        const FixType fix = screened.rows[arc.rows[k]].fix;
        floors += std::pow(error_floor_m(profile.uncertainty, fix).value_or(0.0) / duration_s, 2);
    }
    double of_velocities = 0.0;
    for (std::size_t k = found.first; k <= found.last; ++k)
        of_velocities += sigmas_of(track.row(k), profile.dimension).velocity_m_s /
                         static_cast<double>(window.size());
    const SpeedTrack at_moments{[&](std::size_t k) { return window[k].track.position; },
                                [&](std::size_t k) { return window[k].track.velocity; }};
    SpeedEstimate result{.speed_m_s = speed_of(at_moments, {0, window.size() - 1}, duration_s,
                                               {.definition = profile.definition})};
    double of_shape = 0.0;
    if (profile.definition == SpeedDefinition::path_length) {
        const double cut_short_m_s =
            (window.back().smoothed_m - window.front().smoothed_m) / duration_s - result.speed_m_s;
        result.speed_m_s += cut_short_m_s;
        of_shape = rectangular_uncertainty(std::abs(cut_short_m_s));
    }
    const double of_delay = sigma_of_delay(screened) *
                            (window.back().track.velocity - window.front().track.velocity).norm() /
                            duration_s;
    const double of_velocity = of_velocities * of_velocities;
    const double of_motion =
        is_mean(profile.definition) ? of_velocity : std::min(ends, of_velocity);
    result.standard_uncertainty_m_s =
        std::sqrt(of_motion + floors + of_shape * of_shape + of_delay * of_delay);
    return result;
}

}  // namespace runcert
