#include "stages/window/certify_velocity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/failure.h"
#include "core/uncertainty.h"
#include "stages/window/budget.h"
#include "stages/window/sample_series.h"
#include "stages/window/selection.h"
#include "stages/window/velocity_moment.h"

namespace runcert {
namespace {

Eigen::Vector3d axes_of_speed_of(Dimension dimension) {
    if (dimension == Dimension::horizontal) return {1.0, 1.0, 0.0};
    return dimension == Dimension::vertical ? Eigen::Vector3d(0.0, 0.0, 1.0)
                                            : Eigen::Vector3d::Ones();
}

/// The four definitions from the smoothed trajectory.
SpeedDefinitions definitions_of(const TrajectoryTable& trajectory, const ArcRows& arc,
                                const Profile& profile, const FoundWindow& found) {
    const Eigen::Vector3d axes = axes_of_speed_of(profile.dimension);
    const auto row = [&](std::size_t k) -> const TrajectoryEpoch& {
        return trajectory.rows[arc.rows[k]];
    };
    const auto position = [&](std::size_t k) -> Eigen::Vector3d {
        return axes.cwiseProduct(
            Eigen::Vector3d(*row(k).east_m, *row(k).north_m, row(k).up_m.value_or(0.0)));
    };
    const auto speed = [&](std::size_t k) {
        return axes
            .cwiseProduct(Eigen::Vector3d(*row(k).velocity_east_m_s, *row(k).velocity_north_m_s,
                                          row(k).velocity_up_m_s.value_or(0.0)))
            .norm();
    };
    double path_m = 0.0;
    double later_m_s = 0.0;
    for (std::size_t k = found.first + 1; k <= found.last; ++k) {
        path_m += (position(k) - position(k - 1)).norm();
        later_m_s += speed(k);
    }
    const double duration_s = found.end.seconds() - found.start.seconds();
    const auto steps = static_cast<double>(found.last - found.first);
    return {.displacement_m_s = (position(found.last) - position(found.first)).norm() / duration_s,
            .path_length_m_s = path_m / duration_s,
            .mean_n_plus_1_m_s = (later_m_s + speed(found.first)) / (steps + 1.0),
            .mean_n_m_s = later_m_s / steps};
}

/// Mean of the standard uncertainties of the speeds of a window's epochs: that of their mean, if
/// all err alike.
double mean_uncertainty(const ScreenedTable& screened, const ArcRows& arc, const Profile& profile,
                        const FoundWindow& found) {
    double sum = 0.0;
    for (std::size_t k = found.first; k <= found.last; ++k) {
        const ScreenedEpoch& row = screened.rows[arc.rows[k]];
        const auto speed = recorded_speed(row, profile.dimension);
        if (!speed || !speed->standard_uncertainty_m_s)
            throw Failure(fmt::format("epoch {}", row.epoch),
                          "the recording does not state how accurate its velocity is",
                          "Use a profile whose speed is from positions");
        sum += *speed->standard_uncertainty_m_s;
    }
    return sum / static_cast<double>(found.last - found.first + 1);
}

/// What the positions say of the window, so that velocities are never certified that the positions
/// beside them do not show. The uncertainty of the velocities is what is stated for them, but no
/// more than receivers of all kinds were seen to err by.
WitnessedSpeed by_positions(const TrackSpeed& track, const FoundWindow& found, double stated_m_s) {
    constexpr double largest_of_velocities_m_s = 0.5;
    WitnessedSpeed witnessed;
    witnessed.kind = WitnessKind::positions;
    witnessed.origin = origin_of(witnessed.kind).front();
    witnessed.speed_m_s = track.speed_m_s;
    witnessed.standard_uncertainty_m_s = track.standard_uncertainty_m_s;
    witnessed.position_standard_uncertainty_m_s = std::min(stated_m_s, largest_of_velocities_m_s);
    witnessed.difference_m_s = found.speed_m_s - witnessed.speed_m_s;
    witnessed.normalised_error = std::abs(witnessed.difference_m_s) /
                                 (2.0 * std::hypot(witnessed.standard_uncertainty_m_s,
                                                   witnessed.position_standard_uncertainty_m_s));
    witnessed.apart_m =
        std::abs(witnessed.difference_m_s) * (found.end.seconds() - found.start.seconds());
    return witnessed;
}

/// Of the windows that could have been the fastest, as many as do not overlap.
std::int64_t rivals_of(const std::vector<FoundWindow>& all, double least_m_s) {
    std::vector<FoundWindow> near;
    for (const FoundWindow& window : all)
        if (window.speed_m_s >= least_m_s) near.push_back(window);
    std::ranges::sort(near, {}, [](const FoundWindow& window) { return window.end; });
    std::int64_t rivals = 0;
    ElapsedTime free_from{};
    for (const FoundWindow& window : near)
        if (rivals == 0 || window.start >= free_from) {
            ++rivals;
            free_from = window.end;
        }
    return std::max<std::int64_t>(rivals, 1);
}

}  // namespace

bool states_velocity_accuracy(const ScreenedTable& screened, const ArcRows& arc,
                              const Profile& profile, const FoundWindow& found) {
    for (std::size_t k = found.first; k <= found.last; ++k) {
        const auto speed = recorded_speed(screened.rows[arc.rows[k]], profile.dimension);
        if (!speed || !speed->standard_uncertainty_m_s) return false;
    }
    return true;
}

CertifiableWindow certified_by_velocity(const ScreenedTable& screened,
                                        const TrajectoryTable& trajectory, const ArcRows& arc,
                                        const Profile& profile, const FoundWindow& found,
                                        const std::vector<FoundWindow>& all,
                                        double least_uncertainty_m_s) {
    CertifiableWindow window;
    const TrajectoryEpoch& first = trajectory.rows[arc.rows[found.first]];
    const TrajectoryEpoch& last = trajectory.rows[arc.rows[found.last]];
    window.span = window_span(trajectory.facts, first.epoch, last.epoch, found.start, found.end);
    window.arc = arc.number;
    window.speed_m_s = found.speed_m_s;
    window.length_m = found.length_m;
    window.definitions = definitions_of(trajectory, arc, profile, found);
    window.displacement_m =
        std::hypot(*last.east_m - *first.east_m, *last.north_m - *first.north_m);
    window.position_r95_m = 2.45 * std::max({*first.sigma_east_m, *first.sigma_north_m,
                                             *last.sigma_east_m, *last.sigma_north_m});

    const double stated =
        std::max(mean_uncertainty(screened, arc, profile, found), least_uncertainty_m_s);
    window.witnesses.push_back(
        by_positions(track_speed(screened, trajectory, arc, profile, found), found, stated));
    const std::int64_t rivals = rivals_of(all, found.speed_m_s - selection_width * stated);
    const double selection = stated * std::sqrt(2.0 * std::log(static_cast<double>(rivals)));
    window.budget.push_back(speed_row(
        "u",
        least_uncertainty_m_s > 0.0
            ? "accuracy of the recorded velocities, as the attempt states it, or as they scatter"
            : "accuracy of the recorded velocities, as the recording states it",
        "B", stated, independent_of_other_rows,
        fmt::format("taken as one error throughout the window; the smoothed positions give {:.3f} "
                    "m/s over the same window",
                    speed_by(window.definitions, profile.definition))));
    window.budget.push_back(speed_row(
        "d", "undetected error", "B", 0.0, independent_of_other_rows,
        "not quantified: screening tests positions; velocities are only compared with them"));
    window.bias_limit_m_s = 0.5 * selection;
    window.speed_m_s = less_bias(window.speed_m_s, window.bias_limit_m_s);
    BudgetRow row = speed_row(
        "f", "choice of the fastest of many windows", "B", 0.0, independent_of_other_rows,
        fmt::format("{} that do not overlap could have been the fastest: a bias of at most {:.4f} "
                    "m/s, half of which is subtracted from the speed and half added to the "
                    "expanded uncertainty",
                    rivals == 1 ? std::string("no others") : fmt::format("{} windows", rivals),
                    selection));
    row.estimate = window.bias_limit_m_s;
    row.sensitivity = -1.0;
    window.budget.push_back(std::move(row));
    window.standard_uncertainty_m_s = combine(window.budget).standard_uncertainty;
    return window;
}

}  // namespace runcert
