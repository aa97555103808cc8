#include "stages/window/witnesses.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
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

/// White noise, motion, its model, time stamps and resolution: what positions have and no witness
/// does. (Their time-correlated error another receiver may have, too.)
constexpr std::string_view rows_of_position = "wjotr";

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

/// What was estimated of a wheel, and by which scale its speeds count.
std::string wheel_note(const WheelWitness& wheel, const WheelSpeeds& speeds) {
    if (wheel.made_from_positions)
        return "The wheel's speeds keep to the positions more closely than a wheel can: they were "
               "made from them, and were not heard.";
    std::string note = fmt::format(
        "The wheel's speeds, taken {:.3f} s {} (standard uncertainty {:.3f} s), fit the positions "
        "of the recording best when multiplied by {:.5f} (standard uncertainty {:.5f}). ",
        std::abs(wheel.delay_s), wheel.delay_s < 0.0 ? "earlier" : "later", wheel.sigma_delay_s,
        wheel.scale, wheel.sigma_scale);
    if (speeds.calibrated_scale)
        return note + fmt::format(
                          "They were multiplied by the calibrated {:.5f} (standard "
                          "uncertainty {:.5f}).",
                          *speeds.calibrated_scale, speeds.sigma_calibrated);
    return note +
           "For a window they count by the scale of the other runs. A wrong scale that "
           "lasts they cannot show.";
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
        !(beside.wheel.m_s.empty() && beside.gates_m.empty() && beside.receivers.empty());
    const Track track = related ? track_of(trajectory) : Track{};
    if constexpr (Axes == 2) {
        if (auto wheel = wheel_witness(beside.wheel, timed_positions<2>(screened.rows), track,
                                       jerk_density)) {
            std::string note = wheel_note(*wheel, beside.wheel);
            witnesses.push_back(
                {.kind = WitnessKind::wheel,
                 .motion = std::make_shared<const WheelMotion>(std::move(wheel->motion)),
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
    check(!beside.wheel.m_s.empty(), WitnessKind::wheel,
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

std::string unconfirming_text(const HeardWitness<2>& witness, const WindowSpan& span,
                              const std::string& profile) {
    const double start_s = span.start.seconds();
    const auto moved = witness.motion->between(start_s, start_s + span.duration.seconds());
    if (!moved || moved->confirms) return {};
    return fmt::format(
        "The {} confirm nothing of the window certified under {}: their scale was fitted to the "
        "run that it lies in, and takes in whatever drifts there in proportion to the speed. "
        "Hand in two more runs, or state a calibrated scale.",
        words_of(witness.kind), profile);
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
    if (witness.kind == WitnessKind::receiver) {
        const double correlated_m =
            positions.correlated_m_s * (positions.end_s - positions.start_s);
        moved->covariance_m2 += correlated_m * correlated_m * PositionMatrix<Axes>::Identity();
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
                                 .uncertainty_by_position = positions.standard_uncertainty_m_s,
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
    witnessed.position_standard_uncertainty_m_s = positions.standard_uncertainty_m_s;
    witnessed.normalised_error =
        std::max(figure.normalised_error(), displacement_ratio(*moved, positions));
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
    witnessed.chance_error = displacement_ratio(*moved, positions);
    const FaultPrior fault = fault_of(witness.kind, positions.fault);
    const SpeedMixture compared({.speed_m_s = figure.by_position,
                                 .standard_uncertainty_m_s = positions.standard_uncertainty_m_s,
                                 .fault = positions.fault},
                                SpeedBySource{.speed_m_s = figure.by_witness,
                                              .standard_uncertainty_m_s = uncertainty_m_s,
                                              .fault = fault});
    witnessed.fault_probability = fault.probability;
    witnessed.fault_m_s = fault.largest_m_s;
    witnessed.fault_posterior = compared.positions_at_fault() + compared.witness_at_fault();
    // What a test of size 0.05 finds with 80 %.
    constexpr double found_in_units = 2.84;
    witnessed.undetected_m_s =
        std::min(positions.fault.largest_m_s,
                 found_in_units * std::hypot(positions.standard_uncertainty_m_s, uncertainty_m_s));
    witnessed.confirms = witness.confirms && moved->confirms;
    return witnessed;
}

namespace {

/// What a witness says, as `weigh` takes it.
WitnessTerm term_of(const WitnessedSpeed& one, double correlated_m_s) {
    const bool receiver = one.kind == WitnessKind::receiver;
    // Another receiver's own bound is as large as that of the positions, and in its uncertainty.
    const double own_square = one.standard_uncertainty_m_s * one.standard_uncertainty_m_s -
                              (receiver ? correlated_m_s * correlated_m_s : 0.0);
    return {.difference_m_s = one.difference_m_s,
            .own_m_s = std::sqrt(std::max(0.0, own_square)),
            .shared_m_s = one.shared_standard_uncertainty_m_s,
            .shares_slow = receiver,
            .fault = {.probability = one.fault_probability.value_or(0.0),
                      .largest_m_s = one.fault_m_s.value_or(0.0)}};
}

/// What these say together; `evidence` gets what they may share with the positions beside that.
WitnessEvidence evidence_of(const PositionTerms& positions, const std::vector<WitnessTerm>& terms,
                            SpeedEvidence& evidence) {
    const WitnessMean mean = mean_of_witnesses(positions, terms);
    evidence.shared_standard_uncertainty_m_s =
        std::max(evidence.shared_standard_uncertainty_m_s, mean.besides_m_s);
    return {.difference_m_s = mean.difference_m_s,
            .standard_uncertainty_m_s = mean.standard_uncertainty_m_s,
            .common_standard_uncertainty_m_s = mean.common_m_s,
            .fault_probability = std::min(1.0, mean.fault.probability),
            .fault_m_s = mean.fault.largest_m_s};
}

}  // namespace

HeardTogether hear_together(const PositionTerms& positions, double correlated_m_s,
                            std::vector<WitnessedSpeed>& witnesses, SpeedEvidence& evidence) {
    std::vector<WitnessedSpeed*> heard;
    std::vector<WitnessTerm> terms, observed;
    for (WitnessedSpeed& one : witnesses)
        if (one.confirms) {
            heard.push_back(&one);
            terms.push_back(term_of(one, correlated_m_s));
            if (origin_of(one.kind).front() == to_text(InputOrigin::observed))
                observed.push_back(terms.back());
        }
    evidence.disagreement = disagreement(positions, terms);
    if (terms.empty() || evidence.disagreement > 1.0 ||
        std::ranges::any_of(witnesses, &contradicts))
        return {};
    const WeightedSpeed mean = weigh(positions, terms);
    for (std::size_t k = 0; k < heard.size(); ++k)
        heard[k]->share = mean.witnesses[k];
    evidence.witnesses = evidence_of(positions, terms, evidence);
    if (!observed.empty()) evidence.observed = evidence_of(positions, observed, evidence);
    return {.position_share = mean.positions, .difference_m_s = mean.difference_m_s};
}

void condition_on(const std::vector<WitnessedSpeed>& witnesses, double correlated_m_s,
                  double remaining_difference_m_s, std::vector<BudgetRow>& rows) {
    double rest = 1.0, of_slow = 0.0, of_phases = 0.0, shared_m_s = 0.0;
    for (const WitnessedSpeed& one : witnesses) {
        rest -= one.share;
        if (one.kind == WitnessKind::receiver) of_slow += one.share;
        if (one.shared_standard_uncertainty_m_s == 0.0) continue;
        of_phases += one.share;
        shared_m_s = one.shared_standard_uncertainty_m_s;
    }
    if (rest == 1.0) return;
    rest = std::max(0.0, rest);
    of_slow += rest;
    // What positions and phases share is part of the positions' own time-correlated error.
    const auto slow = std::ranges::find(rows, "b", &BudgetRow::symbol);
    const double slow_m_s = slow == rows.end() ? 0.0 : slow->contribution_m_s;
    const double common_m_s = of_phases > 0.0 ? std::min(shared_m_s, slow_m_s) : 0.0;
    const auto scale = [](BudgetRow& row, double factor) {
        row.sensitivity *= factor;
        row.contribution_m_s *= factor;
    };
    for (BudgetRow& row : rows)
        if (is_of(row, rows_of_position) || row.symbol == "d")
            scale(row, rest);
        else if (row.symbol == "b" && slow_m_s > 0.0)
            scale(row, of_slow * std::sqrt(1.0 - std::pow(common_m_s / slow_m_s, 2)));
    for (const WitnessedSpeed& one : witnesses) {
        if (one.share == 0.0) continue;
        const double own_m_s = term_of(one, correlated_m_s).own_m_s;
        BudgetRow own = speed_row(
            "g", std::string(words_of(one.kind)), "B", one.share * own_m_s,
            independent_of_other_rows,
            fmt::format("{:.4f} m/s by them, {:.4f} m/s times {:.3f}; the rows of the positions "
                        "count by {:.3f}",
                        one.speed_m_s, own_m_s, one.share, rest));
        own.estimate = one.speed_m_s;
        own.standard_uncertainty = own_m_s;
        own.sensitivity = one.share;
        rows.push_back(std::move(own));
    }
    rows.push_back(speed_row("e", "difference of positions and witness", "B",
                             std::abs(remaining_difference_m_s), independent_of_other_rows,
                             "the speed stated is that of the positions, and not corrected"));
    if (of_phases == 0.0) return;
    rows.push_back(speed_row(
        "s", "time-correlated errors that positions and phases share", "B",
        std::hypot((of_slow + of_phases) * common_m_s,
                   of_phases * std::sqrt(shared_m_s * shared_m_s - common_m_s * common_m_s)),
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
    const WeightedSpeed mean = weigh(position_terms(rows), std::array{term_of(velocities, 0.0)});
    velocities.share = mean.witnesses.front();
    condition_on({velocities}, 0.0, mean.difference_m_s, rows);
    return 2.0 * combine(rows).standard_uncertainty + mean.positions * bias_limit_m_s;
}

PositionTerms position_terms(const std::vector<BudgetRow>& rows) {
    PositionTerms terms;
    for (const BudgetRow& row : rows) {
        if (is_of(row, rows_of_position))
            terms.own_m_s = std::hypot(terms.own_m_s, row.contribution_m_s);
        if (row.symbol == "b") terms.slow_m_s = row.contribution_m_s;
        if (row.symbol == "d") terms.fault_m_s = row.contribution_m_s;
    }
    return terms;
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
