#include "stages/window/stands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "motion/joint_speeds.h"
#include "motion/motion_model.h"
#include "schemas/observations/stated_covariance.h"
#include "stages/window/lasting_difference.h"

namespace runcert {
namespace {

constexpr double wheel_turns_m_s = 0.01;    // resolution of recorded wheel speeds
constexpr double standing_below_m_s = 0.2;  // slower than a wheel begins to count
constexpr double least_by_wheel_s = 10.0;   // chosen, as the next four: a wheel stops before and
constexpr double left_out_by_wheel_s =
    1.0;                          // turns after the craft does, by samples a second apart
constexpr double within_m = 1.0;  // and positions alone wander by some decimetres
constexpr double least_by_positions_s = 30.0;
constexpr double left_out_by_positions_s = 5.0;
constexpr double fewest_spans = 5.0;  // 10 squares of two axes: a standard deviation to a quarter
/// Positions that move by less of what they state were smoothed at rest: independent errors do so
/// in fewer than one of a thousand stands of `fewest_spans`.
constexpr double held_share = 0.2;

void add_stand(double from_s, double to_s, StandSource by, std::vector<Stand>& stands) {
    Stand& stand = stands.emplace_back();
    stand.from_s = from_s;
    stand.to_s = to_s;
    stand.shown_by = by;
}

std::vector<Stand> stands_by_imu(const std::vector<StillSpan>& spans) {
    std::vector<Stand> stands;
    for (const StillSpan& span : spans)
        add_stand(span.from_s, span.to_s, StandSource::imu, stands);
    return stands;
}

std::vector<Stand> stands_by_wheel(const MeasuredSeries& wheel) {
    std::vector<Stand> stands;
    const auto& samples = wheel.samples;
    for (std::size_t k = 0; k < samples.size(); ++k) {
        const std::size_t first = k;
        if (!(samples[k].value <= wheel_turns_m_s)) continue;
        while (k + 1 < samples.size() && samples[k + 1].value <= wheel_turns_m_s &&
               samples[k + 1].time_s - samples[k].time_s <= left_out_by_wheel_s)
            ++k;
        const double from_s = samples[first].time_s + left_out_by_wheel_s;
        const double to_s = samples[k].time_s - left_out_by_wheel_s;
        if (to_s - from_s >= least_by_wheel_s) add_stand(from_s, to_s, StandSource::wheel, stands);
    }
    return stands;
}

std::vector<Stand> stands_by_positions(const TrajectoryTable& trajectory) {
    std::vector<Stand> stands;
    const auto& rows = trajectory.rows;
    for (std::size_t first = 0; first < rows.size(); ++first) {
        if (!rows[first].east_m) continue;
        std::size_t last = first;
        while (last + 1 < rows.size() && rows[last + 1].arc == rows[first].arc &&
               rows[last + 1].east_m &&
               std::hypot(*rows[last + 1].east_m - *rows[first].east_m,
                          *rows[last + 1].north_m - *rows[first].north_m) < within_m)
            ++last;
        const double from_s = rows[first].time.seconds() + left_out_by_positions_s;
        const double to_s = rows[last].time.seconds() - left_out_by_positions_s;
        if (to_s - from_s < least_by_positions_s) continue;
        add_stand(from_s, to_s, StandSource::positions, stands);
        first = last;
    }
    return stands;
}

/// What the measured positions moved over a lag while the craft stood, of an axis.
struct Movement {
    std::int64_t pairs = 0;
    double squares_m2 = 0.0;  ///< sum over the pairs, mean of the axes
    double stated_m2 = 0.0;   ///< the same of their stated variances
    double drift_m_s = 0.0;   ///< steady movement, horizontally or up: it is not in the squares
};

/// Position of an epoch that counts, with its stated variance.
template <int Axes>
struct StandingPosition {
    const ScreenedEpoch* row = nullptr;
    double time_s = 0.0;
    PositionVector<Axes> position = PositionVector<Axes>::Zero();
};

template <int Axes>
std::vector<StandingPosition<Axes>> positions_in(const ScreenedTable& screened, const Stand& stand,
                                                 std::optional<FixType> fix) {
    std::vector<StandingPosition<Axes>> positions;
    // Only the usable rows are sure to be in the order of time.
    for (const ScreenedEpoch& row : screened.rows) {
        if (!row.usable || (fix && row.fix != *fix) || (Axes == 1 && !row.up_m)) continue;
        const double time_s = row.time.seconds();
        if (time_s < stand.from_s) continue;
        if (time_s > stand.to_s) break;
        auto& one = positions.emplace_back();
        one.row = &row;
        one.time_s = time_s;
        if constexpr (Axes == 2)
            one.position = {*row.east_m, *row.north_m};
        else
            one.position(0) = *row.up_m;
    }
    return positions;
}

/// Velocity by a straight line through the positions.
template <int Axes>
PositionVector<Axes> steady_movement(const std::vector<StandingPosition<Axes>>& positions) {
    double mean_s = 0.0, square_s2 = 0.0;
    for (const auto& one : positions)
        mean_s += one.time_s / static_cast<double>(positions.size());
    PositionVector<Axes> sum = PositionVector<Axes>::Zero();
    for (const auto& one : positions) {
        sum += (one.time_s - mean_s) * (one.position - positions.front().position);
        square_s2 += (one.time_s - mean_s) * (one.time_s - mean_s);
    }
    if (!(square_s2 > 0.0)) return PositionVector<Axes>::Zero();
    return sum / square_s2;
}

template <int Axes>
Movement movement_in(const ScreenedTable& screened, const Stand& stand, std::optional<FixType> fix,
                     double lag_s) {
    const double half_step_s = 0.5 * screened.facts.nominal_interval_s;
    const auto positions = positions_in<Axes>(screened, stand, fix);
    const PositionVector<Axes> steady = steady_movement<Axes>(positions);
    Movement movement;
    movement.drift_m_s = steady.norm();
    std::size_t k = 0;
    for (const auto& earlier : positions) {
        while (k < positions.size() && positions[k].time_s < earlier.time_s + lag_s - half_step_s)
            ++k;
        if (k == positions.size()) break;
        const auto& later = positions[k];
        const double apart_s = later.time_s - earlier.time_s;
        if (apart_s > lag_s + half_step_s || earlier.row->fix != later.row->fix ||
            earlier.row->arc != later.row->arc)
            continue;
        movement.squares_m2 +=
            (later.position - earlier.position - apart_s * steady).squaredNorm() / Axes;
        movement.stated_m2 += (stated_covariance<Axes>(*earlier.row).trace() +
                               stated_covariance<Axes>(*later.row).trace()) /
                              Axes;
        ++movement.pairs;
    }
    return movement;
}

/// Whether the smoothed positions are slow all through a stand.
bool is_slow(const TrajectoryTable& trajectory, const Stand& stand) {
    return std::ranges::none_of(trajectory.rows, [&](const TrajectoryEpoch& row) {
        return row.time.seconds() >= stand.from_s && row.time.seconds() <= stand.to_s &&
               row.speed_m_s && *row.speed_m_s >= standing_below_m_s;
    });
}

}  // namespace

std::vector<Stand> stands_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<StillSpan>& by_imu, const MeasuredSeries* wheel) {
    std::vector<Stand> stands = stands_by_imu(by_imu);
    if (stands.empty() && wheel) {
        stands = stands_by_wheel(*wheel);
        std::erase_if(stands, [&](const Stand& stand) { return !is_slow(trajectory, stand); });
    }
    if (stands.empty()) stands = stands_by_positions(trajectory);
    for (Stand& stand : stands) {
        const Movement moved = movement_in<2>(screened, stand, std::nullopt, usual_window_s);
        stand.pairs = moved.pairs;
        if (moved.pairs == 0) continue;
        stand.drift_m_s = moved.drift_m_s;
        stand.moved_m = std::sqrt(moved.squares_m2 / static_cast<double>(moved.pairs));
        stand.stated_m = std::sqrt(moved.stated_m2 / static_cast<double>(moved.pairs));
    }
    return stands;
}

template <int Axes>
std::optional<double> standing_error_m(const ScreenedTable& screened,
                                       const std::vector<Stand>& stands, FixType fix, double lag_s,
                                       double scale) {
    Movement all;
    for (const Stand& stand : stands) {
        if (stand.shown_by == StandSource::positions) continue;
        const Movement moved = movement_in<Axes>(screened, stand, fix, lag_s);
        all.pairs += moved.pairs;
        all.squares_m2 += moved.squares_m2;
        all.stated_m2 += moved.stated_m2;
    }
    const double lasted_s = static_cast<double>(all.pairs) * screened.facts.nominal_interval_s;
    if (all.pairs == 0 || lasted_s < (fewest_spans - 1.0) * lag_s) return std::nullopt;
    const double correlated_m2 =
        0.5 * (all.squares_m2 - scale * scale * all.stated_m2) / static_cast<double>(all.pairs);
    return std::sqrt(std::max(0.0, correlated_m2));
}

std::string standing_text(const std::vector<Stand>& stands) {
    double lasted_s = 0.0, moved_m2 = 0.0, stated_m2 = 0.0, pairs = 0.0, drift_m_s = 0.0;
    for (const Stand& stand : stands) {
        if (!stand.moved_m) continue;
        const auto weight = static_cast<double>(stand.pairs);
        lasted_s += stand.to_s - stand.from_s;
        moved_m2 += weight * *stand.moved_m * *stand.moved_m;
        stated_m2 += weight * *stand.stated_m * *stand.stated_m;
        pairs += weight;
        drift_m_s = std::max(drift_m_s, *stand.drift_m_s);
    }
    if (lasted_s < fewest_spans * usual_window_s) return {};
    // Two axes, and pairs that overlap count once.
    const int independent = std::max(1, static_cast<int>(2.0 * lasted_s / usual_window_s));
    const bool more = over_chance(independent * moved_m2 / stated_m2, independent) > 1.0;
    const bool alone = stands.front().shown_by == StandSource::positions;
    const bool drifts = drift_m_s * usual_window_s > std::sqrt(stated_m2 / pairs);
    if (alone && !more) return {};
    std::string text =
        alone
            ? fmt::format("For {:.0f} s the positions stayed within a metre.", lasted_s)
            : fmt::format("By its {} the craft stood for {:.0f} s.",
                          stands.front().shown_by == StandSource::imu ? "IMU" : "wheel", lasted_s);
    if (drifts)
        text += fmt::format(
            " Its positions moved steadily there, by up to {:.3f} m/s: the craft crept, or they "
            "drift.",
            drift_m_s);
    text += fmt::format(
        " Over {:g} s they moved {}by {:.1f} mm in each horizontal axis (root mean square). Their "
        "stated standard deviations make {:.1f} mm.",
        usual_window_s, drifts ? "beyond that " : "", 1e3 * std::sqrt(moved_m2 / pairs),
        1e3 * std::sqrt(stated_m2 / pairs));
    if (more)
        text += alone ? " Either the craft moved, or they err by more than they state."
                      : " They err by more than they state.";
    else if (moved_m2 < held_share * held_share * stated_m2)
        text += " Receivers hold positions at rest, so this tells little of errors at speed.";
    return text;
}

template std::optional<double> standing_error_m<1>(const ScreenedTable&, const std::vector<Stand>&,
                                                   FixType, double, double);
template std::optional<double> standing_error_m<2>(const ScreenedTable&, const std::vector<Stand>&,
                                                   FixType, double, double);

}  // namespace runcert
