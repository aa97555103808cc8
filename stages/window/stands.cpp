#include "stages/window/stands.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "schemas/observations/stated_covariance.h"

namespace runcert {
namespace {

constexpr double stated_lag_s = 3.0;
constexpr double wheel_turns_m_s = 0.01;
constexpr double longest_step_s = 1.0;
constexpr double least_by_wheel_s = 10.0;
constexpr double left_out_by_wheel_s = 1.0;
constexpr double within_m = 1.0;
constexpr double least_by_positions_s = 30.0;
constexpr double left_out_by_positions_s = 5.0;
constexpr double fewest_spans = 5.0;
constexpr double by_chance_standing = 1e-3;
/// Positions that move by less of what they state were smoothed at rest.
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
               samples[k + 1].time_s - samples[k].time_s <= longest_step_s)
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

/// What the measured positions of one fix type moved over a lag while the craft stood, of an axis.
struct Movement {
    std::int64_t pairs = 0;
    double squares_m2 = 0.0;  ///< sum over the pairs, mean of the axes
    double stated_m2 = 0.0;   ///< the same of their stated variances
};

template <int Axes>
Movement movement_in(const ScreenedTable& screened, const Stand& stand,
                     std::optional<FixType> fix, double lag_s) {
    const auto& rows = screened.rows;
    const double half_step_s = 0.5 * screened.facts.nominal_interval_s;
    const auto seconds = [](const ScreenedEpoch& row) { return row.time.seconds(); };
    const auto counts = [&](const ScreenedEpoch& row) {
        return row.usable && (!fix || row.fix == *fix) && (Axes == 2 || row.up_m.has_value());
    };
    Movement movement;
    auto later = std::ranges::lower_bound(rows, stand.from_s, {}, seconds);
    for (auto earlier = later; earlier != rows.end(); ++earlier) {
        const double to_s = seconds(*earlier) + lag_s;
        while (later != rows.end() && seconds(*later) < to_s - half_step_s)
            ++later;
        if (later == rows.end() || seconds(*later) > stand.to_s) break;
        if (!counts(*earlier) || !counts(*later) || earlier->fix != later->fix ||
            earlier->arc != later->arc || seconds(*later) > to_s + half_step_s)
            continue;
        if constexpr (Axes == 2)
            movement.squares_m2 += 0.5 * (std::pow(*later->east_m - *earlier->east_m, 2) +
                                          std::pow(*later->north_m - *earlier->north_m, 2));
        else
            movement.squares_m2 += std::pow(*later->up_m - *earlier->up_m, 2);
        movement.stated_m2 += (stated_covariance<Axes>(*earlier).trace() +
                               stated_covariance<Axes>(*later).trace()) /
                              Axes;
        ++movement.pairs;
    }
    return movement;
}

}  // namespace

std::vector<Stand> stands_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                             const std::vector<StillSpan>& by_imu, const MeasuredSeries* wheel) {
    std::vector<Stand> stands = stands_by_imu(by_imu);
    if (stands.empty() && wheel) stands = stands_by_wheel(*wheel);
    if (stands.empty()) stands = stands_by_positions(trajectory);
    for (Stand& stand : stands) {
        const Movement moved = movement_in<2>(screened, stand, std::nullopt, stated_lag_s);
        stand.pairs = moved.pairs;
        if (moved.pairs == 0) continue;
        stand.moved_m = std::sqrt(moved.squares_m2 / static_cast<double>(moved.pairs));
        stand.stated_m = std::sqrt(moved.stated_m2 / static_cast<double>(moved.pairs));
    }
    return stands;
}

template <int Axes>
std::optional<double> standing_error_m(const ScreenedTable& screened,
                                       const std::vector<Stand>& stands, FixType fix,
                                       double lag_s, double scale) {
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
    const double correlated_m2 = 0.5 * (all.squares_m2 - scale * scale * all.stated_m2) /
                                 static_cast<double>(all.pairs);
    return std::sqrt(std::max(0.0, correlated_m2));
}

std::string standing_text(const std::vector<Stand>& stands) {
    double lasted_s = 0.0, moved_m2 = 0.0, stated_m2 = 0.0;
    double pairs = 0.0;
    for (const Stand& stand : stands) {
        if (!stand.moved_m) continue;
        const auto weight = static_cast<double>(stand.pairs);
        lasted_s += stand.to_s - stand.from_s;
        moved_m2 += weight * *stand.moved_m * *stand.moved_m;
        stated_m2 += weight * *stand.stated_m * *stand.stated_m;
        pairs += weight;
    }
    if (pairs == 0.0) return {};
    // Two axes, and pairs that overlap count once.
    const int independent = std::max(1, static_cast<int>(2.0 * lasted_s / stated_lag_s));
    const bool more = moved_m2 > stated_m2 * chi_squared_upper_quantile(by_chance_standing,
                                                                       independent) /
                                     independent;
    const bool alone = stands.front().shown_by == StandSource::positions;
    if (alone && !more) return {};
    const std::string figures = fmt::format(
        "Over {:g} s they moved by {:.1f} mm in each horizontal axis (root mean square); their "
        "stated standard deviations make {:.1f} mm.",
        stated_lag_s, 1e3 * std::sqrt(moved_m2 / pairs), 1e3 * std::sqrt(stated_m2 / pairs));
    const std::string stood =
        alone ? fmt::format("For {:.0f} s the positions stayed within a metre.", lasted_s)
              : fmt::format("By its {} the craft stood for {:.0f} s, and its positions show their "
                            "errors alone there.",
                            stands.front().shown_by == StandSource::imu ? "IMU" : "wheel",
                            lasted_s);
    const std::string_view said =
        more ? (alone ? " Either the craft moved, or they err by more than they state."
                      : " They err by more than they state. The bound on their time-correlated "
                        "error is at least what they show there.")
        : moved_m2 < held_share * held_share * stated_m2
            ? " Receivers hold positions at rest, so this tells little of their errors at speed."
            : "";
    return fmt::format("{} {}{}", stood, figures, said);
}

template std::optional<double> standing_error_m<1>(const ScreenedTable&, const std::vector<Stand>&,
                                                   FixType, double, double);
template std::optional<double> standing_error_m<2>(const ScreenedTable&, const std::vector<Stand>&,
                                                   FixType, double, double);

}  // namespace runcert
