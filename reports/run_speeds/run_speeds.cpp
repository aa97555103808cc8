#include "reports/run_speeds/run_speeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include "core/statistics.h"

namespace runcert {
namespace {

/// The way (m) between two rows that have a speed of the dimension.
double way_m(const TrajectoryEpoch& from, const TrajectoryEpoch& to, Dimension dimension) {
    const double level_m = std::hypot(*to.east_m - *from.east_m, *to.north_m - *from.north_m);
    if (dimension == Dimension::horizontal) return level_m;
    const double upright_m = *to.up_m - *from.up_m;
    return dimension == Dimension::vertical ? std::abs(upright_m) : std::hypot(level_m, upright_m);
}

/// Whether a row goes on from the one before it without a break.
bool goes_on(const TrajectoryTable& table, std::size_t k) {
    constexpr double gap_factor = 1.5;
    const TrajectoryEpoch& before = table.rows[k - 1];
    const TrajectoryEpoch& row = table.rows[k];
    return before.arc == row.arc && row.time.seconds() - before.time.seconds() <=
                                        gap_factor * table.facts.nominal_interval_s;
}

using SpeedColumn = std::optional<double> TrajectoryEpoch::*;

constexpr std::array<std::pair<std::string_view, SpeedColumn>, 5> methods{
    {{"smoother, forward and backward", &TrajectoryEpoch::speed_m_s},
     {"batch least squares", &TrajectoryEpoch::speed_batch_m_s},
     {"method v1 of [DHD22]", &TrajectoryEpoch::speed_v1_m_s},
     {"method v2 of [DHD22]", &TrajectoryEpoch::speed_v2_m_s},
     {"forward filter of [DHD22]", &TrajectoryEpoch::speed_kalman_m_s}}};

}  // namespace

std::optional<double> speed_in(const TrajectoryEpoch& row, Dimension dimension) {
    if (dimension == Dimension::horizontal) return row.speed_m_s;
    if (!row.velocity_up_m_s) return std::nullopt;
    if (dimension == Dimension::vertical) return std::abs(*row.velocity_up_m_s);
    if (!row.speed_m_s) return std::nullopt;
    return std::hypot(*row.speed_m_s, *row.velocity_up_m_s);
}

std::vector<std::optional<double>> speeds_over_length(const TrajectoryTable& table,
                                                      const Profile& profile) {
    constexpr double tolerance_s = 1e-3;
    const bool over_distance = profile.window_kind == WindowKind::distance;
    if (!over_distance && profile.window_kind != WindowKind::time) return {};
    const std::vector<TrajectoryEpoch>& rows = table.rows;
    std::vector<std::optional<double>> speeds_m_s(rows.size()), over_length_m_s(rows.size());
    // Since the last break: the sum of the speeds before each row, and the way to it.
    std::vector<double> sums_m_s(rows.size()), path_m(rows.size());
    std::size_t back = 0;  // the latest row that is far enough back
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (rows[k].arc) speeds_m_s[k] = speed_in(rows[k], profile.dimension);
        if (!speeds_m_s[k]) continue;
        if (k > 0 && speeds_m_s[k - 1] && goes_on(table, k)) {
            sums_m_s[k] = sums_m_s[k - 1] + *speeds_m_s[k - 1];
            path_m[k] = path_m[k - 1] + way_m(rows[k - 1], rows[k], profile.dimension);
        } else {
            back = k;
        }
        const auto time_since = [&](std::size_t from) {
            return rows[k].time.seconds() - rows[from].time.seconds();
        };
        const auto reaches = [&](std::size_t from) {
            if (!over_distance) return time_since(from) >= profile.duration_s - tolerance_s;
            return from < k && path_m[k] - path_m[from] >= profile.distance_m;
        };
        while (back < k && reaches(back + 1))
            ++back;
        if (!reaches(back)) continue;
        over_length_m_s[k] = over_distance ? (path_m[k] - path_m[back]) / time_since(back)
                                           : (sums_m_s[k] + *speeds_m_s[k] - sums_m_s[back]) /
                                                 static_cast<double>(k - back + 1);
    }
    return over_length_m_s;
}

std::vector<MethodSpeeds> method_speeds(const TrajectoryTable& table, std::int64_t first_epoch,
                                        std::int64_t last_epoch) {
    const auto first = std::ranges::find(table.rows, first_epoch, &TrajectoryEpoch::epoch);
    const auto last = std::ranges::find(table.rows, last_epoch, &TrajectoryEpoch::epoch);
    std::vector<MethodSpeeds> all;
    if (last == table.rows.end() || last <= first) return all;
    for (const auto& [name, column] : methods) {
        std::vector<double> speeds_m_s;
        for (auto row = first; row <= last && (*row).*column; ++row)
            speeds_m_s.push_back(*((*row).*column));
        if (std::ssize(speeds_m_s) == last - first + 1)
            all.push_back({.method = name,
                           .epochs = std::ssize(speeds_m_s),
                           .mean_m_s = mean(speeds_m_s),
                           .standard_deviation_m_s = standard_deviation(speeds_m_s)});
    }
    return all;
}

}  // namespace runcert
