#include "reports/run_speeds/run_speeds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

namespace runcert {
namespace {

/// The way (m) between two rows that have a speed of the dimension.
double way_m(const TrajectoryEpoch& from, const TrajectoryEpoch& to, Dimension dimension) {
    const double level_m = std::hypot(*to.east_m - *from.east_m, *to.north_m - *from.north_m);
    if (dimension == Dimension::horizontal) return level_m;
    const double upright_m = *to.up_m - *from.up_m;
    return dimension == Dimension::vertical ? std::abs(upright_m) : std::hypot(level_m, upright_m);
}

/// The rows since the last break up to the one at hand, with what adds up along them.
class Stretch {
  public:
    Stretch(const TrajectoryTable& table, const Profile& profile)
        : table_(table), profile_(profile) {}

    void add(std::size_t k) {
        const TrajectoryEpoch& row = table_.rows[k];
        const auto speed = row.arc ? speed_in(row, profile_.dimension) : std::nullopt;
        if (!speed || (!times_s_.empty() && breaks_before(k))) {
            times_s_.clear();
            sums_m_s_.assign(1, 0.0);
            path_m_.clear();
            back_ = 0;
        }
        if (!speed) return;
        path_m_.push_back(path_m_.empty() ? 0.0
                                          : path_m_.back() +
                                                way_m(table_.rows[k - 1], row, profile_.dimension));
        times_s_.push_back(row.time.seconds());
        sums_m_s_.push_back(sums_m_s_.back() + *speed);
    }

    /// Over the rule's length, up to the row that was added last.
    std::optional<double> speed_m_s() {
        if (times_s_.empty()) return std::nullopt;
        const std::size_t last = times_s_.size() - 1;
        while (back_ < last && reaches(back_ + 1, last))
            ++back_;
        if (!reaches(back_, last)) return std::nullopt;
        if (profile_.window_kind == WindowKind::distance)
            return (path_m_[last] - path_m_[back_]) / (times_s_[last] - times_s_[back_]);
        return (sums_m_s_[last + 1] - sums_m_s_[back_]) / static_cast<double>(last - back_ + 1);
    }

  private:
    bool breaks_before(std::size_t k) const {
        constexpr double gap_factor = 1.5;
        const TrajectoryEpoch& before = table_.rows[k - 1];
        const TrajectoryEpoch& row = table_.rows[k];
        return before.arc != row.arc || row.time.seconds() - before.time.seconds() >
                                            gap_factor * table_.facts.nominal_interval_s;
    }

    bool reaches(std::size_t from, std::size_t last) const {
        constexpr double tolerance_s = 1e-3;
        if (profile_.window_kind == WindowKind::distance)
            return last > from && path_m_[last] - path_m_[from] >= profile_.distance_m;
        return times_s_[last] - times_s_[from] >= profile_.duration_s - tolerance_s;
    }

    const TrajectoryTable& table_;
    const Profile& profile_;
    std::vector<double> times_s_, path_m_;
    std::vector<double> sums_m_s_{0.0};  ///< of the speeds before each row
    std::size_t back_ = 0;               ///< the latest row that is far enough back
};

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
    std::vector<std::optional<double>> speeds;
    if (profile.window_kind != WindowKind::time && profile.window_kind != WindowKind::distance)
        return speeds;
    Stretch stretch(table, profile);
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        stretch.add(k);
        speeds.push_back(stretch.speed_m_s());
    }
    return speeds;
}

std::vector<MethodSpeeds> method_speeds(const TrajectoryTable& table, std::int64_t first_epoch,
                                        std::int64_t last_epoch) {
    const auto first = std::ranges::find(table.rows, first_epoch, &TrajectoryEpoch::epoch);
    const auto last = std::find_if(first, table.rows.end(), [&](const TrajectoryEpoch& row) {
        return row.epoch == last_epoch;
    });
    std::vector<MethodSpeeds> all;
    if (last == table.rows.end() || first == last) return all;
    const auto end = std::next(last);
    const auto count = static_cast<double>(std::distance(first, end));
    for (const auto& [name, speed] : methods) {
        const auto has = [column = speed](const TrajectoryEpoch& row) {
            return (row.*column).has_value();
        };
        if (!std::all_of(first, end, has)) continue;
        MethodSpeeds one{.method = name, .epochs = std::distance(first, end)};
        for (auto row = first; row != end; ++row)
            one.mean_m_s += *((*row).*speed) / count;
        double square = 0.0;
        for (auto row = first; row != end; ++row)
            square += std::pow(*((*row).*speed) - one.mean_m_s, 2);
        one.standard_deviation_m_s = std::sqrt(square / (count - 1.0));
        all.push_back(one);
    }
    return all;
}

}  // namespace runcert
