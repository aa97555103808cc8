#include "stages/window/velocity_moment.h"

#include <algorithm>
#include <cmath>

#include "core/uncertainty.h"

namespace runcert {
namespace {

/// A position on the track between samples, and the velocity there.
struct TrackPoint {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

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

/// The smoothed track of an arc along the axes that a rule counts.
class SmoothedTrack {
  public:
    SmoothedTrack(const TrajectoryTable& trajectory, const ArcRows& arc, Dimension dimension)
        : trajectory_(trajectory), arc_(arc), axes_(axes_of_speed(dimension)) {}

    const TrajectoryEpoch& row(std::size_t k) const { return trajectory_.rows[arc_.rows[k]]; }
    double time_s(std::size_t k) const { return row(k).time.seconds(); }

    TrackPoint sample(std::size_t k) const {
        const TrajectoryEpoch& at = row(k);
        return {
            .position =
                axes_.cwiseProduct(Eigen::Vector3d(*at.east_m, *at.north_m, at.up_m.value_or(0.0))),
            .velocity = axes_.cwiseProduct(Eigen::Vector3d(
                *at.velocity_east_m_s, *at.velocity_north_m_s, at.velocity_up_m_s.value_or(0.0)))};
    }

    /// The track at a time. Before the first sample and after the last one, it is that sample.
    TrackPoint at(double time_s) const {
        const std::size_t k = sample_before(time_s);
        if (k + 1 == arc_.rows.size()) return sample(k);
        const double step_s = this->time_s(k + 1) - this->time_s(k);
        return between(sample(k), sample(k + 1), step_s,
                       std::clamp((time_s - this->time_s(k)) / step_s, 0.0, 1.0));
    }

    struct Length {
        double path_m = 0.0, chords_m = 0.0;
    };
    Length length(double from_s, double to_s) const {
        Length length;
        TrackPoint before = at(from_s);
        double before_s = from_s;
        const auto add = [&](double until_s) {
            if (until_s <= before_s) return;
            const TrackPoint here = at(until_s);
            length.path_m += path_between(before, here, until_s - before_s);
            length.chords_m += (here.position - before.position).norm();
            before = here;
            before_s = until_s;
        };
        for (std::size_t k = sample_before(from_s) + 1; k < arc_.rows.size() && time_s(k) < to_s;
             ++k)
            add(time_s(k));
        add(to_s);
        return length;
    }

  private:
    std::size_t sample_before(double time_s) const {
        const auto after = std::ranges::upper_bound(arc_.rows, time_s, {}, [&](std::size_t row) {
            return trajectory_.rows[row].time.seconds();
        });
        return static_cast<std::size_t>(std::max<std::ptrdiff_t>(after - arc_.rows.begin(), 1)) - 1;
    }

    const TrajectoryTable& trajectory_;
    const ArcRows& arc_;
    Eigen::Vector3d axes_;
};

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

double floor_m(const Profile& profile, FixType fix) {
    const auto floor = profile.uncertainty.error_floor_m.find(std::string(to_text(fix)));
    return floor == profile.uncertainty.error_floor_m.end() ? 0.0 : floor->second;
}

}  // namespace

Eigen::Vector3d axes_of_speed(Dimension dimension) {
    if (dimension == Dimension::horizontal) return {1.0, 1.0, 0.0};
    return dimension == Dimension::vertical ? Eigen::Vector3d(0.0, 0.0, 1.0)
                                            : Eigen::Vector3d::Ones();
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
    if (delay_s == 0.0 || count < 3) return;
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

std::vector<std::optional<TrackMoment>> track_at_moments(const ScreenedTable& screened,
                                                         const TrajectoryTable& trajectory,
                                                         const ArcRows& arc, Dimension dimension) {
    const SmoothedTrack track(trajectory, arc, dimension);
    const double delay_s = delay_of_velocities(screened);
    const std::size_t count = arc.rows.size();
    std::vector<std::optional<TrackMoment>> moments(count);
    TrackPoint before;
    for (std::size_t k = 0; k < count; ++k) {
        const double at_s = track.time_s(k) - delay_s;
        if (at_s < track.time_s(0) || at_s > track.time_s(count - 1)) continue;
        const TrackPoint here = track.at(at_s);
        TrackMoment& moment = moments[k].emplace();
        moment.speed_m_s = here.velocity.norm();
        moment.position_m = here.position;
        if (k > 0 && moments[k - 1])
            moment.step_m = path_between(before, here, track.time_s(k) - track.time_s(k - 1));
        before = here;
    }
    return moments;
}

TrackSpeed track_speed(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                       const ArcRows& arc, const Profile& profile, const FoundWindow& found) {
    const SmoothedTrack track(trajectory, arc, profile.dimension);
    const double delay_s = delay_of_velocities(screened);
    const double duration_s = found.end.seconds() - found.start.seconds();
    const double from_s = found.start.seconds() - delay_s, to_s = found.end.seconds() - delay_s;
    double ends = 0.0, floors = 0.0;
    for (const std::size_t k : {found.first, found.last}) {
        ends += std::pow(sigmas_of(track.row(k), profile.dimension).position_m / duration_s, 2);
        floors += std::pow(floor_m(profile, screened.rows[arc.rows[k]].fix) / duration_s, 2);
    }
    double of_velocities = 0.0, speeds = 0.0;
    const auto steps = static_cast<double>(found.last - found.first);
    for (std::size_t k = found.first; k <= found.last; ++k) {
        of_velocities += sigmas_of(track.row(k), profile.dimension).velocity_m_s / (steps + 1.0);
        if (k > found.first || profile.definition == SpeedDefinition::mean_n_plus_1)
            speeds += track.at(track.time_s(k) - delay_s).velocity.norm();
    }
    const bool mean = profile.definition == SpeedDefinition::mean_n ||
                      profile.definition == SpeedDefinition::mean_n_plus_1;
    const TrackPoint first = track.at(from_s), last = track.at(to_s);
    TrackSpeed result;
    double of_shape = 0.0;
    if (mean) {
        result.speed_m_s =
            speeds / (profile.definition == SpeedDefinition::mean_n ? steps : steps + 1.0);
    } else if (profile.definition == SpeedDefinition::path_length) {
        const auto [path_m, chords_m] = track.length(from_s, to_s);
        result.speed_m_s = path_m / duration_s;
        of_shape = rectangular_uncertainty(std::abs(path_m - chords_m) / duration_s);
    } else {
        result.speed_m_s = (last.position - first.position).norm() / duration_s;
    }
    const double of_delay =
        sigma_of_delay(screened) * (last.velocity - first.velocity).norm() / duration_s;
    const double of_velocity = of_velocities * of_velocities;
    result.standard_uncertainty_m_s = std::sqrt((mean ? of_velocity : std::min(ends, of_velocity)) +
                                                floors + of_shape * of_shape + of_delay * of_delay);
    return result;
}

}  // namespace runcert
