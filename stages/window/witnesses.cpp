#include "stages/window/witnesses.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/statistics.h"
#include "core/uncertainty.h"
#include "estimation/tables/other_receiver.h"
#include "estimation/tables/screened_phases.h"
#include "estimation/velocity_witness.h"
#include "estimation/witnessed_spans.h"
#include "stages/window/budget.h"

namespace runcert {
namespace {

/// White noise, time-correlated error, motion, its model, time stamps and resolution: what
/// positions have and a witness of another origin does not.
constexpr std::string_view rows_of_position = "wbjotr";
constexpr std::string_view rows_of_receiver = "wjotr";

std::string_view rows_beside(WitnessKind kind) {
    return kind == WitnessKind::receiver ? rows_of_receiver : rows_of_position;
}

/// Displacements differ so by chance once in a thousand.
constexpr double by_chance = 1e-3;

bool is_of(const BudgetRow& row, std::string_view symbols) {
    return row.symbol.size() == 1 && symbols.find(row.symbol.front()) != std::string_view::npos;
}

/// Clockwise from north, 0 to 360.
double azimuth_deg(const Eigen::Vector2d& towards) {
    const double degrees = std::atan2(towards.x(), towards.y()) * 180.0 / std::numbers::pi;
    return degrees < 0.0 ? degrees + 360.0 : degrees;
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

template <int Axes>
HeardWitnesses<Axes> witnesses_of(const ScreenedTable& screened, const TrajectoryTable& trajectory,
                                  const Beside& beside, double jerk_density) {
    HeardWitnesses<Axes> witnesses;
    if (auto velocities = velocity_witness<Axes>(screened, directions_of(trajectory)))
        witnesses.push_back(
            {.kind = WitnessKind::velocities,
             .motion = std::make_shared<const VelocityWitness<Axes>>(*std::move(velocities)),
             .confirms = !screened.basis.velocity || !screened.basis.velocity->unfit});
    if (beside.phases)
        if (auto found = phase_witness<Axes>(beside.phases, beside.first_of_phases,
                                             trajectory.facts.first_epoch, trajectory.origin,
                                             jerk_density)) {
            const auto phases = std::make_shared<const PhaseWitness<Axes>>(*std::move(found));
            witnesses.push_back({.kind = WitnessKind::phases, .motion = phases, .phases = phases});
        }
    const bool related =
        !(beside.wheel_m_s.empty() && beside.gates_m.empty() && beside.receivers.empty());
    const Track track = related ? track_of(trajectory) : Track{};
    if constexpr (Axes == 2) {
        if (auto wheel = wheel_witness(beside.wheel_m_s, timed_positions<2>(screened.rows), track,
                                       jerk_density)) {
            std::string note =
                wheel->made_from_positions
                    ? std::string(
                          "The wheel's speeds keep to the positions more closely than a wheel can: "
                          "they were made from them, and were not heard.")
                    : fmt::format(
                          "The wheel's speeds were multiplied by {:.5f} (standard uncertainty "
                          "{:.5f}) and "
                          "taken {:.3f} s {} (standard uncertainty {:.3f} s), as fits the "
                          "positions best. A "
                          "wrong scale that lasts they cannot show.",
                          wheel->scale, wheel->sigma_scale, std::abs(wheel->delay_s),
                          wheel->delay_s < 0.0 ? "earlier" : "later", wheel->sigma_delay_s);
            witnesses.push_back(
                {.kind = WitnessKind::wheel,
                 .motion = std::make_shared<const VelocityWitness<2>>(std::move(wheel->motion)),
                 .note = std::move(note),
                 .made_from_positions = wheel->made_from_positions});
        }
        if (auto gates = gate_witness(beside.gates_m, beside.gate_errors, track)) {
            const bool made =
                gates->agrees_too_well() ||
                are_between_positions(beside.gates_m, timed_positions<2>(screened.rows));
            witnesses.push_back(
                {.kind = WitnessKind::gates,
                 .motion = std::make_shared<const GateWitness>(*std::move(gates)),
                 .note = made ? "The gates agree with the positions better than the errors of "
                                "either allow: they were made from them, and were not heard."
                              : "",
                 .made_from_positions = made});
        }
    }
    for (const TrajectoryTable* const other : beside.receivers)
        if (auto found = receiver_witness<Axes>(track_of(*other), track))
            witnesses.push_back(
                {.kind = WitnessKind::receiver,
                 .receiver = other->facts.receiver,
                 .motion = std::make_shared<const ReceiverWitness<Axes>>(*std::move(found))});
    return witnesses;
}

std::vector<std::string> unheard(const Beside& beside, const HeardWitnesses<2>& witnesses) {
    std::vector<std::string> sentences;
    const auto check = [&](bool given, WitnessKind kind, std::string_view why) {
        if (given && std::ranges::find(witnesses, kind, &HeardWitness<2>::kind) == witnesses.end())
            sentences.push_back(
                fmt::format("The {} were handed in and say nothing: {}.", words_of(kind), why));
    };
    constexpr std::string_view without_place =
        "the positions have no times or no place on the Earth to compare them with";
    check(beside.phases != nullptr, WitnessKind::phases, without_place);
    check(!beside.receivers.empty(), WitnessKind::receiver,
          "the two recordings have no common time or frame, or it has no estimate");
    check(!beside.wheel_m_s.empty(), WitnessKind::wheel,
          "too few of them are at times at which the craft's motion was estimated, or nothing "
          "bounds their errors");
    check(!beside.gates_m.empty(), WitnessKind::gates,
          "fewer than two were passed while the craft's motion was estimated");
    return sentences;
}

template <int Axes>
std::string silence_text(const HeardWitness<Axes>& witness, const TrajectoryTable& trajectory,
                         const std::string& profile) {
    const TimeSpan covered = witness.motion->covered();
    const double first_s = trajectory.rows.front().time.seconds();
    const double last_s = trajectory.rows.back().time.seconds();
    if (covered.last_s <= first_s)
        return fmt::format(
            "The {} end {:.0f} s before the recording begins: another time, or a clock that is "
            "off.",
            words_of(witness.kind), first_s - covered.last_s);
    if (covered.first_s >= last_s)
        return fmt::format(
            "The {} begin {:.0f} s after the recording ends: another time, or a clock that is off.",
            words_of(witness.kind), covered.first_s - last_s);
    return fmt::format(
        "The {} say nothing of the window certified under {}: they do not cover it without a "
        "break.",
        words_of(witness.kind), profile);
}

std::string contradiction_text(const HeardWitness<2>& witness, const ScreenedTable& screened) {
    constexpr double span_s = 3.0;
    if (witness.kind == WitnessKind::phases) return {};
    const WitnessedMotionComparison found =
        compare_motion(timed_positions<2>(screened.rows), *witness.motion, span_s);
    if (!found.contradicts) return {};
    std::string text = fmt::format(
        "The {} show another motion than the positions: over {:g} s they differ by {:.2f} m "
        "(median "
        "of {} spans).",
        words_of(witness.kind), span_s, found.median_difference_m, found.spans);
    if (found.positions_ahead_s)
        text += fmt::format(
            " The clock of the positions is {} s {} theirs: shifted by this the two agree.",
            std::abs(*found.positions_ahead_s),
            *found.positions_ahead_s > 0 ? "ahead of" : "behind");
    return text;
}

bool counts_path(SpeedDefinition definition) {
    return definition == SpeedDefinition::path_length || definition == SpeedDefinition::mean_n ||
           definition == SpeedDefinition::mean_n_plus_1;
}

template <int Axes>
double displacement_ratio(const WitnessedMotion<Axes>& moved,
                          const PositionFigures<Axes>& positions) {
    const double sigma_m =
        positions.standard_uncertainty_m_s * (positions.end_s - positions.start_s);
    const PositionMatrix<Axes> covariance =
        moved.covariance_m2 + sigma_m * sigma_m * PositionMatrix<Axes>::Identity();
    const PositionVector<Axes> difference = positions.displacement_m - moved.displacement_m;
    return std::sqrt(difference.dot(covariance.inverse() * difference) /
                     chi_squared_upper_quantile(by_chance, Axes));
}

template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const HeardWitness<Axes>& witness,
                                              const PositionFigures<Axes>& positions) {
    if (witness.made_from_positions) return std::nullopt;
    auto moved = witness.motion->between(positions.start_s, positions.end_s);
    if (!moved) return std::nullopt;
    PositionFigures<Axes> tested = positions;
    if (witness.kind == WitnessKind::receiver) {
        const double correlated_m =
            positions.correlated_m_s * (positions.end_s - positions.start_s);
        moved->covariance_m2 += correlated_m * correlated_m * PositionMatrix<Axes>::Identity();
        tested.standard_uncertainty_m_s =
            std::hypot(positions.standard_uncertainty_m_s, positions.correlated_m_s);
    }
    std::optional<double> path_m = moved->displacement_m.norm();
    if (positions.by_path)
        path_m = witness.motion->path_between(positions.start_s, positions.end_s);
    if (!path_m) return std::nullopt;
    const double duration_s = positions.end_s - positions.start_s;
    const double length_m = positions.displacement_m.norm();
    // Of a craft that hardly moved any direction is as good.
    const PositionVector<Axes> along =
        length_m > 0.0 ? PositionVector<Axes>(positions.displacement_m / length_m)
                       : PositionVector<Axes>::Unit(0);
    const double uncertainty_m_s = std::sqrt(along.dot(moved->covariance_m2 * along)) / duration_s;
    const WitnessedFigure figure{.by_position = positions.speed_m_s,
                                 .by_witness = *path_m / duration_s,
                                 .uncertainty_by_position = tested.standard_uncertainty_m_s,
                                 .uncertainty_by_witness = uncertainty_m_s};
    WitnessedSpeed witnessed;
    witnessed.kind = witness.kind;
    witnessed.receiver = witness.receiver;
    witnessed.origin = origin_of(witness.kind).front();
    witnessed.speed_m_s = figure.by_witness;
    if (witness.kind == WitnessKind::phases)
        witnessed.shared_standard_uncertainty_m_s =
            std::numbers::sqrt2 * shared_by_phases_m / duration_s;
    witnessed.standard_uncertainty_m_s = uncertainty_m_s;
    witnessed.difference_m_s = figure.difference();
    witnessed.position_standard_uncertainty_m_s = tested.standard_uncertainty_m_s;
    witnessed.normalised_error =
        std::max(figure.normalised_error(), displacement_ratio(*moved, tested));
    const PositionVector<Axes> apart = positions.displacement_m - moved->displacement_m;
    witnessed.apart_m = apart.norm();
    if constexpr (Axes == 2) witnessed.apart_azimuth_deg = azimuth_deg(apart);
    if (witness.phases) {
        const PhaseInterruptions within =
            witness.phases->interruptions(positions.start_s, positions.end_s);
        witnessed.satellites = moved->satellites;
        witnessed.slips = within.slips;
        witnessed.refusals = within.refusals;
    }
    if (witnessed.normalised_error <= 1.0 && witness.confirms)
        witnessed.share = share_of_position(positions.with_undetected_m_s, uncertainty_m_s);
    return witnessed;
}

WitnessedSpeed* choose_share(std::vector<WitnessedSpeed>& witnesses) {
    WitnessedSpeed* sharpest = nullptr;
    bool contradicted = false;
    for (WitnessedSpeed& one : witnesses) {
        contradicted = contradicted || one.normalised_error > 1.0;
        if (one.share > 0.0 && (sharpest == nullptr ||
                                one.standard_uncertainty_m_s < sharpest->standard_uncertainty_m_s))
            sharpest = &one;
    }
    if (contradicted) sharpest = nullptr;
    for (WitnessedSpeed& one : witnesses)
        if (&one != sharpest) one.share = 0.0;
    return sharpest;
}

double undetected_beside(const WitnessedSpeed& witnessed, double positions_alone_m_s,
                         double noncentrality) {
    const double of_difference =
        std::hypot(witnessed.position_standard_uncertainty_m_s, witnessed.standard_uncertainty_m_s);
    const double by_witness = noncentrality * of_difference * of_difference;
    const double square = positions_alone_m_s * positions_alone_m_s;
    return square + by_witness > 0.0 ? std::sqrt(square * by_witness / (square + by_witness)) : 0.0;
}

void set_undetected_beside(const WitnessedSpeed& witnessed, const UndetectedError& worst,
                           std::vector<BudgetRow>& rows) {
    const auto row = std::ranges::find(rows, "d", &BudgetRow::symbol);
    if (row == rows.end()) return;
    row->source = "undetected error, drifts included";
    row->standard_uncertainty = rectangular_uncertainty(witnessed.undetected_m_s);
    row->contribution_m_s = row->standard_uncertainty * std::abs(row->sensitivity);
    row->note = fmt::format(
        "screening and the {} together find a larger one; by the positions alone it could be "
        "{:.4f} m/s ({})",
        words_of(witnessed.kind), worst.speed_m_s, words_of(worst.hypothesis));
}

void condition_on(const WitnessedSpeed& witnessed, std::vector<BudgetRow>& rows) {
    const double share = witnessed.share;
    for (BudgetRow& row : rows) {
        if (!is_of(row, rows_beside(witnessed.kind)) && row.symbol != "d") continue;
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
    const double common_m_s = witnessed.shared_standard_uncertainty_m_s;
    if (common_m_s == 0.0) return;
    rows.push_back(speed_row(
        "s", "time-correlated errors that positions and phases share", "B", share * common_m_s,
        independent_of_other_rows,
        fmt::format("multipath disturbs both: {:g} m at either end of the window, independently",
                    shared_by_phases_m)));
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

namespace {

double uncertainty_by(const std::vector<BudgetRow>& rows, std::string_view symbols,
                      Undetected undetected) {
    double square = 0.0;
    for (const BudgetRow& row : rows)
        if (is_of(row, symbols) || (undetected == Undetected::counted && row.symbol == "d"))
            square += row.contribution_m_s * row.contribution_m_s;
    return std::sqrt(square);
}

}  // namespace

double position_uncertainty(const std::vector<BudgetRow>& rows, Undetected undetected) {
    return uncertainty_by(rows, rows_of_position, undetected);
}

double unshared_uncertainty(const std::vector<BudgetRow>& rows, WitnessKind kind,
                            Undetected undetected) {
    return uncertainty_by(rows, rows_beside(kind), undetected);
}

#define RUNCERT_INSTANTIATE(AXES)                                                            \
    template std::string silence_text(const HeardWitness<AXES>&, const TrajectoryTable&,     \
                                      const std::string&);                                   \
    template HeardWitnesses<AXES> witnesses_of(const ScreenedTable&, const TrajectoryTable&, \
                                               const Beside&, double);                       \
    template double displacement_ratio(const WitnessedMotion<AXES>&,                         \
                                       const PositionFigures<AXES>&);                        \
    template std::optional<WitnessedSpeed> witnessed_speed(const HeardWitness<AXES>&,        \
                                                           const PositionFigures<AXES>&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
