#include "stages/window/witnesses.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/statistics.h"
#include "estimation/velocity_witness.h"
#include "stages/window/budget.h"

namespace runcert {
namespace {

/// White noise, time-correlated error, motion, its model, time stamps and resolution: what
/// positions have and a witness of another origin does not.
constexpr std::string_view rows_of_position = "wbjotr";

/// Displacements differ so by chance once in a thousand.
constexpr double by_chance = 1e-3;

bool is_of(const BudgetRow& row, std::string_view symbols) {
    return row.symbol.size() == 1 && symbols.find(row.symbol.front()) != std::string_view::npos;
}

/// The difference of the displacements over the largest that chance makes.
template <int Axes>
double displacement_error(const WitnessedMotion<Axes>& moved,
                          const PositionFigures<Axes>& positions) {
    const double sigma_m =
        positions.standard_uncertainty_m_s * (positions.end_s - positions.start_s);
    const PositionMatrix<Axes> covariance =
        moved.covariance_m2 + sigma_m * sigma_m * PositionMatrix<Axes>::Identity();
    const PositionVector<Axes> difference = positions.displacement_m - moved.displacement_m;
    return std::sqrt(difference.dot(covariance.inverse() * difference) /
                     chi_squared_upper_quantile(by_chance, Axes));
}

}  // namespace

Directions directions_of(const TrajectoryTable& trajectory) {
    Directions directions;
    directions.reserve(trajectory.rows.size());
    for (const TrajectoryEpoch& row : trajectory.rows) {
        auto& direction = directions.emplace_back();
        if (!row.velocity_east_m_s || !row.velocity_north_m_s || !row.sigma_velocity_east_m_s ||
            !row.sigma_velocity_north_m_s)
            continue;
        const Eigen::Vector2d sigma(*row.sigma_velocity_east_m_s, *row.sigma_velocity_north_m_s);
        direction = direction_of({*row.velocity_east_m_s, *row.velocity_north_m_s},
                                 sigma.cwiseAbs2().asDiagonal());
    }
    return directions;
}

bool counts_path(SpeedDefinition definition) {
    return definition == SpeedDefinition::path_length || definition == SpeedDefinition::mean_n ||
           definition == SpeedDefinition::mean_n_plus_1;
}

template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const Witness<Axes>& witness,
                                              const PositionFigures<Axes>& positions) {
    const auto moved = witness.between(positions.start_s, positions.end_s);
    if (!moved) return std::nullopt;
    const double duration_s = positions.end_s - positions.start_s;
    const double length_m = positions.displacement_m.norm();
    // Of a craft that hardly moved any direction is as good.
    const PositionVector<Axes> along =
        length_m > 0.0 ? PositionVector<Axes>(positions.displacement_m / length_m)
                       : PositionVector<Axes>::Unit(0);
    const double uncertainty_m_s = std::sqrt(along.dot(moved->covariance_m2 * along)) / duration_s;
    const WitnessedFigure figure{
        .by_position = positions.speed_m_s,
        .by_witness =
            (positions.by_path ? moved->path_m : moved->displacement_m.norm()) / duration_s,
        .uncertainty_by_position = positions.standard_uncertainty_m_s,
        .uncertainty_by_witness = uncertainty_m_s};
    WitnessedSpeed witnessed;
    witnessed.kind = WitnessKind::velocities;
    witnessed.speed_m_s = figure.by_witness;
    witnessed.standard_uncertainty_m_s = uncertainty_m_s;
    witnessed.difference_m_s = figure.difference();
    witnessed.position_standard_uncertainty_m_s = positions.standard_uncertainty_m_s;
    witnessed.normalised_error =
        std::max(figure.normalised_error(), displacement_error(*moved, positions));
    if (witnessed.normalised_error <= 1.0)
        witnessed.share = share_of_position(positions.with_undetected_m_s, uncertainty_m_s);
    return witnessed;
}

double undetected_beside(const WitnessedSpeed& witnessed, double positions_alone_m_s,
                         double noncentrality) {
    const double of_difference =
        std::hypot(witnessed.position_standard_uncertainty_m_s, witnessed.standard_uncertainty_m_s);
    const double by_witness = noncentrality * of_difference * of_difference;
    const double square = positions_alone_m_s * positions_alone_m_s;
    return square + by_witness > 0.0 ? std::sqrt(square * by_witness / (square + by_witness)) : 0.0;
}

void condition_on(const WitnessedSpeed& witnessed, std::vector<BudgetRow>& rows) {
    const double share = witnessed.share;
    for (BudgetRow& row : rows) {
        if (!is_of(row, rows_of_position) && row.symbol != "d") continue;
        row.sensitivity *= 1.0 - share;
        row.contribution_m_s *= 1.0 - share;
    }
    BudgetRow own = speed_row("g", std::string(words_of(witnessed.kind)), "B",
                              share * witnessed.standard_uncertainty_m_s, independent_of_other_rows,
                              fmt::format("{:.4f} m/s by them; of the difference {:.1f} % is to be "
                                          "expected as the positions' error, so that the rows of "
                                          "the positions count by the rest",
                                          witnessed.speed_m_s, 100.0 * share));
    own.estimate = witnessed.speed_m_s;
    own.standard_uncertainty = witnessed.standard_uncertainty_m_s;
    own.sensitivity = share;
    rows.push_back(std::move(own));
    BudgetRow apart = speed_row(
        "e", "difference of positions and witness", "B", share * std::abs(witnessed.difference_m_s),
        independent_of_other_rows, "the speed stated is that of the positions, and not corrected");
    apart.standard_uncertainty = std::abs(witnessed.difference_m_s);
    apart.sensitivity = share;
    rows.push_back(std::move(apart));
}

double expected_beside_velocities(std::vector<BudgetRow> rows, double own_uncertainty_m_s,
                                  double bias_limit_m_s, double duration_s, double interval_s) {
    constexpr double sigma_at_epoch_m_s = 0.1;
    constexpr double median_of_normal = 0.6745;
    WitnessedSpeed velocities;
    velocities.kind = WitnessKind::velocities;
    velocities.standard_uncertainty_m_s = std::hypot(
        least_velocity_sigma_m_s, sigma_at_epoch_m_s * std::sqrt(interval_s / duration_s));
    velocities.difference_m_s =
        median_of_normal * std::hypot(own_uncertainty_m_s, velocities.standard_uncertainty_m_s);
    velocities.share = share_of_position(position_uncertainty(rows, Undetected::counted),
                                         velocities.standard_uncertainty_m_s);
    condition_on(velocities, rows);
    return 2.0 * combine(rows).standard_uncertainty + (1.0 - velocities.share) * bias_limit_m_s;
}

double position_uncertainty(const std::vector<BudgetRow>& rows, Undetected undetected) {
    double square = 0.0;
    for (const BudgetRow& row : rows)
        if (is_of(row, rows_of_position) ||
            (undetected == Undetected::counted && row.symbol == "d"))
            square += row.contribution_m_s * row.contribution_m_s;
    return std::sqrt(square);
}

#define RUNCERT_INSTANTIATE(AXES)                                                \
    template std::optional<WitnessedSpeed> witnessed_speed(const Witness<AXES>&, \
                                                           const PositionFigures<AXES>&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
