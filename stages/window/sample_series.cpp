#include "stages/window/sample_series.h"

#include <algorithm>
#include <cmath>

#include "core/geodesy.h"
#include "stages/window/velocity_moment.h"
#include "witness/continuity.h"
#include "witness/recorded_velocities.h"
#include "witness/window_speed.h"

namespace runcert {
namespace {

/// The position on the axes that the profile counts, zero on the others.
Eigen::Vector3d counted(const Eigen::Vector3d& position, ElapsedTime time, const Profile& profile,
                        const std::optional<FrameOrigin>& origin) {
    Eigen::Vector3d counted = axes_of_speed(profile.dimension).cwiseProduct(position);
    if (profile.dimension == Dimension::vertical)
        counted.z() += fall_at_m(origin, time, position.x(), position.y());
    return counted;
}

double smoothed_speed(const TrajectoryEpoch& row, const Profile& profile) {
    const double up = row.velocity_up_m_s.value_or(0.0);
    if (profile.dimension == Dimension::horizontal) return *row.speed_m_s;
    return profile.dimension == Dimension::vertical ? std::abs(up) : std::hypot(*row.speed_m_s, up);
}

/// Extends the path of recorded speeds to the sample, using the mean speed of each pair over its
/// time.
void add_recorded(SampleSeries& series, ElapsedTime time, double speed_m_s) {
    const double before_m = series.path_m.empty() ? 0.0 : series.path_m.back();
    const double step_m = series.times.empty()
                              ? 0.0
                              : 0.5 * (series.speeds_m_s.back() + speed_m_s) *
                                    (time.seconds() - series.times.back().seconds());
    series.path_m.push_back(before_m + step_m);
    series.speeds_m_s.push_back(speed_m_s);
}

std::optional<Eigen::Vector3d> recorded_position(const ScreenedEpoch& row) {
    if (!row.east_m || !row.north_m) return std::nullopt;
    return Eigen::Vector3d(*row.east_m, *row.north_m, row.up_m.value_or(0.0));
}

/// Whether a row has no recorded speed where the rule takes one, or a refused one.
std::vector<bool> silent_rows(const ScreenedTable& screened, const Profile& profile) {
    std::vector<bool> silent(screened.rows.size(), false);
    if (profile.speed_source != SpeedSource::velocity) return silent;
    silent = velocities_left_out(screened.rows, screened.basis.velocity,
                                 profile.dimension != Dimension::horizontal);
    for (std::size_t i = 0; i < silent.size(); ++i)
        silent[i] = silent[i] || !recorded_speed(screened.rows[i], profile.dimension);
    return silent;
}

SampleSeries arc_series(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                        const ArcRows& arc, const std::vector<std::int64_t>& obstacles,
                        const std::vector<bool>& silent, const Profile& profile,
                        SeriesPositions positions) {
    SampleSeries series;
    for (const std::size_t at : arc.rows) {
        const TrajectoryEpoch& row = trajectory.rows[at];
        Eigen::Vector3d position(*row.east_m, *row.north_m, row.up_m.value_or(0.0));
        if (positions == SeriesPositions::recorded)
            position = recorded_position(screened.rows[at]).value_or(position);
        if (profile.speed_source == SpeedSource::velocity) {
            const auto speed = recorded_speed(screened.rows[at], profile.dimension);
            add_recorded(series, row.time, speed ? speed->speed_m_s : 0.0);
        } else {
            series.speeds_m_s.push_back(smoothed_speed(row, profile));
        }
        series.times.push_back(row.time);
        series.positions.push_back(counted(position, row.time, profile, trajectory.origin));
        series.obstacles.push_back(obstacles[at]);
        series.bounds.push_back(row.usable && !silent[at]);
    }
    return series;
}

/// For each row of the table, the number of obstacles up to it. Rows that belong to no arc are
/// included. A row out of time is skipped as if missing, and may leave a gap, which is an obstacle.
std::vector<std::int64_t> obstacles_in(const ScreenedTable& screened,
                                       const TrajectoryTable& trajectory,
                                       const std::vector<bool>& silent, const Profile& profile) {
    const auto longest_s = longest_step_of(profile, trajectory.facts.nominal_interval_s);
    std::vector<std::int64_t> obstacles;
    obstacles.reserve(trajectory.rows.size());
    std::optional<double> before_s;
    for (std::size_t i = 0; i < trajectory.rows.size(); ++i) {
        const TrajectoryEpoch& row = trajectory.rows[i];
        const bool out_of_time = is_out_of_time(screened.rows[i]);
        const bool gap = longest_s && before_s && row.time.seconds() - *before_s > *longest_s;
        const bool obstacle = !out_of_time && (!row.usable || gap || silent[i]);
        obstacles.push_back((obstacles.empty() ? 0 : obstacles.back()) + (obstacle ? 1 : 0));
        if (!out_of_time) before_s = row.time.seconds();
    }
    return obstacles;
}

/// How a row shows a speed. It does so with its neighbours, or only with others of its kind (as far
/// away, without a fix, or with standard deviations as absurd), or not at all.
enum class Showing { with_all, apart, nothing };

/// A single position that its neighbours contradict shows nothing, because they already show the
/// motion.
Showing showing_of(const std::vector<ScreenedEpoch>& rows, std::size_t i, const Profile& profile) {
    const ScreenedEpoch& row = rows[i];
    if (profile.speed_source == SpeedSource::velocity)
        return recorded_speed(row, profile.dimension) ? Showing::with_all : Showing::nothing;
    if (!row.east_m || !row.north_m || (profile.dimension != Dimension::horizontal && !row.up_m))
        return Showing::nothing;
    if (row.fix == FixType::none || row.reason == Reason::far_position ||
        row.reason == Reason::accuracy_absurd)
        return Showing::apart;
    const auto is_outlier = [&](std::size_t k) {
        return k < rows.size() && rows[k].reason == Reason::outlier;
    };
    const bool single = row.reason == Reason::outlier && !is_outlier(i - 1) && !is_outlier(i + 1);
    return single ? Showing::nothing : Showing::with_all;
}

/// Adds a row that shows a speed, at a time. Where another series begins, it starts a new one.
void add_indicated(const ScreenedTable& screened, const Profile& profile, std::size_t row,
                   ElapsedTime time, bool begins, IndicatedSeries& indicated) {
    if (begins) {
        indicated.series.emplace_back();
        indicated.rows.emplace_back();
    }
    const ScreenedEpoch& epoch = screened.rows[row];
    SampleSeries& series = indicated.series.back();
    if (profile.speed_source == SpeedSource::velocity)
        add_recorded(series, time, recorded_speed(epoch, profile.dimension)->speed_m_s);
    series.times.push_back(time);
    // A velocity needs no position, and takes that of the previous row.
    const Eigen::Vector3d before = series.positions.empty()
                                       ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                       : series.positions.back();
    series.positions.push_back(
        epoch.east_m && epoch.north_m
            ? counted({*epoch.east_m, *epoch.north_m, epoch.up_m.value_or(0.0)}, epoch.time,
                      profile, screened.origin)
            : before);
    indicated.rows.back().push_back(row);
}

/// Whether two rows lie in different places and cannot be joined: the way between them was not
/// recorded, or heights are needed, which refer to the plane of their place.
bool parts_between(const ScreenedTable& screened, const Profile& profile, std::size_t from,
                   std::size_t to, double regular_s) {
    const ScreenedEpoch &before = screened.rows[from], &after = screened.rows[to];
    return screened.origin &&
           screened.origin->number_at(before.time) != screened.origin->number_at(after.time) &&
           (seconds_between(before, after) > regular_s || profile.dimension == Dimension::space);
}

/// Adds rows that show a speed only with others of their kind, for as long as these continue
/// steadily. Guessed or held positions do not.
void add_apart(const ScreenedTable& screened, const Profile& profile, double regular_s,
               IndicatedSeries& indicated) {
    std::vector<std::size_t> rows;
    std::vector<EnuEpoch> epochs;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        const ScreenedEpoch& row = screened.rows[i];
        if (is_out_of_time(row) || showing_of(screened.rows, i, profile) != Showing::apart)
            continue;
        rows.push_back(i);
        EnuEpoch& epoch = epochs.emplace_back(row);
        epoch.fix = FixType::unknown;
        // With an absurd standard deviation any step would pass as steady.
        if (row.reason == Reason::accuracy_absurd) static_cast<StatedAccuracy&>(epoch) = {};
    }
    std::optional<Eigen::Vector3d> velocity;
    for (std::size_t k = 0; k < rows.size(); ++k) {
        bool begins = k == 0;
        if (k > 0) {
            RecordedStep step{
                .from = &epochs[k - 1], .to = &epochs[k], .before = velocity, .after = {}};
            if (k + 1 < rows.size())
                step.after = velocity_between(epochs[k], epochs[k + 1], regular_s);
            const double step_s = seconds_between(epochs[k - 1], epochs[k]);
            begins = step_s > regular_s || !continues(step, step_s);
            velocity =
                begins ? std::nullopt : velocity_between(epochs[k - 1], epochs[k], regular_s);
        }
        add_indicated(screened, profile, rows[k], epochs[k].time, begins, indicated);
    }
}

}  // namespace

WindowCriteria window_criteria(const Profile& profile, double duration_tolerance_s,
                               double nominal_interval_s) {
    WindowCriteria rule;
    rule.kind = profile.window_kind;
    rule.definition = profile.definition;
    rule.ends = profile.ends;
    rule.exact = profile.exact_duration;
    rule.duration_s = profile.duration_s;
    rule.duration_tolerance_s = duration_tolerance_s;
    rule.nominal_interval_s = nominal_interval_s;
    rule.distance_m = profile.distance_m;
    rule.proximity_m = profile.proximity_m;
    rule.turn_deg = profile.turn_deg;
    rule.alpha = profile.alpha;
    return rule;
}

std::optional<double> longest_step_of(const Profile& profile, double nominal_interval_s) {
    constexpr double regular = 1.5;
    constexpr double rounding_s = 1e-9;
    std::optional<double> longest_s;
    for (const Clause& clause : profile.clauses)
        if (clause.decided_by == Computation::sampling_rate && clause.limit && *clause.limit > 0.0)
            longest_s = 1.0 / *clause.limit + rounding_s;
    if (is_mean(profile.definition))
        longest_s = std::min(longest_s.value_or(regular * nominal_interval_s),
                             regular * nominal_interval_s);
    return longest_s;
}

std::optional<RecordedSpeed> recorded_speed(const RecordedVelocity& velocity, Dimension dimension) {
    return recorded_speed(velocity, dimension != Dimension::vertical,
                          dimension != Dimension::horizontal);
}

std::vector<SampleSeries> certifiable_series(const ScreenedTable& screened,
                                             const TrajectoryTable& trajectory,
                                             const std::vector<ArcRows>& arcs,
                                             const Profile& profile, SeriesPositions positions) {
    const std::vector<bool> silent = silent_rows(screened, profile);
    const auto obstacles = obstacles_in(screened, trajectory, silent, profile);
    std::vector<SampleSeries> series;
    series.reserve(arcs.size());
    for (const ArcRows& arc : arcs) {
        series.push_back(
            arc_series(screened, trajectory, arc, obstacles, silent, profile, positions));
        if (profile.speed_source == SpeedSource::velocity)
            move_to_moments(series.back(), delay_of_velocities(screened));
    }
    return series;
}

IndicatedSeries indicated_series(const ScreenedTable& screened, const Profile& profile,
                                 double gap_factor) {
    const double regular_s = gap_factor * screened.facts.nominal_interval_s;
    IndicatedSeries indicated;
    for (std::size_t i = 0; i < screened.rows.size(); ++i) {
        if (is_out_of_time(screened.rows[i]) ||
            showing_of(screened.rows, i, profile) != Showing::with_all)
            continue;
        const bool begins =
            indicated.series.empty() ||
            parts_between(screened, profile, indicated.rows.back().back(), i, regular_s);
        add_indicated(screened, profile, i, screened.rows[i].time, begins, indicated);
    }
    add_apart(screened, profile, regular_s, indicated);
    return indicated;
}

IndicatedSeries indicated_by_pace(const ScreenedTable& screened, const Profile& profile,
                                  double gap_factor) {
    std::vector<std::size_t> recorded;
    for (std::size_t i = 0; i < screened.rows.size(); ++i)
        if (screened.rows[i].reason != Reason::repeated &&
            showing_of(screened.rows, i, profile) == Showing::with_all)
            recorded.push_back(i);
    std::ranges::sort(recorded, {}, [&](std::size_t i) { return screened.rows[i].epoch; });
    const double interval_s = screened.facts.nominal_interval_s;
    const double regular_s = gap_factor * interval_s;
    IndicatedSeries indicated;
    std::optional<Eigen::Vector3d> velocity;
    ElapsedTime time;
    for (std::size_t k = 0; k < recorded.size(); ++k) {
        const ScreenedEpoch& row = screened.rows[recorded[k]];
        bool begins = k == 0;
        if (k > 0) {
            const ScreenedEpoch& before = screened.rows[recorded[k - 1]];
            const double step_s = seconds_between(before, row);
            RecordedStep step{.from = &before, .to = &row, .before = velocity, .after = {}};
            if (k + 1 < recorded.size())
                step.after = velocity_between(row, screened.rows[recorded[k + 1]], regular_s);
            const bool out_of_time = is_out_of_time(before) || is_out_of_time(row);
            const bool jumps = (step_s <= 0.0 || step_s > regular_s) &&
                               (out_of_time ? continues(step, interval_s)
                                            : clock_jumped(step, step_s, interval_s));
            begins = !jumps && step_s <= 0.0;
            if (jumps) {
                indicated.jumps.push_back(recorded[k]);
                const std::int64_t interval_ns = std::llround(interval_s * 1e9);
                time.nanoseconds += interval_ns;
                EnuEpoch paced = row;
                paced.time.nanoseconds = before.time.nanoseconds + interval_ns;
                velocity = velocity_between(before, paced, regular_s);
            } else {
                time.nanoseconds += row.time.nanoseconds - before.time.nanoseconds;
                velocity = velocity_between(before, row, regular_s);
            }
        }
        if (begins) time = row.time;
        add_indicated(screened, profile, recorded[k], time, begins, indicated);
    }
    return indicated.jumps.empty() ? IndicatedSeries{} : indicated;
}

void restrict_to(const std::optional<WindowPart>& part, const ScreenedTable& screened,
                 IndicatedSeries& indicated) {
    for (std::size_t k = 0; k < indicated.series.size(); ++k) {
        std::vector<ElapsedTime> times;
        times.reserve(indicated.rows[k].size());
        for (const std::size_t row : indicated.rows[k])
            times.push_back(screened.rows[row].time);
        restrict_to(part, times, indicated.series[k]);
    }
}

}  // namespace runcert
