#include "stages/window/witnesses.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/angle.h"
#include "stages/window/lasting_difference.h"
#include "stages/window/witnessed_budget.h"
#include "witness/kinds/imu.h"
#include "witness/receiver_witness.h"
#include "witness/screened_phases.h"
#include "witness/velocity_witness.h"
#include "witness/witnessed_spans.h"

namespace runcert {
namespace {

AntennaSwing antenna_swing(const WitnessRecords& records) {
    if (records.inertial && !records.inertial->epochs.empty() &&
        records.inertial->consistency.consistent())
        return {.solution = records.inertial};
    return {.bound = records.antenna_motion};
}

/// What screening, before any attitude is known, could see of the positions with a witness of
/// the craft. Empty if it did not compare them.
std::string antenna_comparison_text(const ScreenedTable& screened, WitnessKind kind) {
    const auto& all = screened.basis.displacements;
    const auto found = std::ranges::find(all, kind, &DisplacementComparison::kind);
    if (found == all.end() || found->spreads.empty()) return {};
    const auto& spread = found->spreads.front();
    return fmt::format(
        " Screening knows no attitude, and compared them with the antenna. Over {:g} s the two "
        "scatter by {:.2f} m (standard deviation, each axis): only larger differences are marked.",
        spread.span_s, spread.sd_m);
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
AssessedWitnesses<Axes> witnesses_of(const ScreenedTable& screened,
                                     const TrajectoryTable& trajectory,
                                     const WitnessRecords& records, double jerk_density) {
    AssessedWitnesses<Axes> witnesses;
    const Directions directions = directions_of(trajectory);
    std::vector<WitnessSource> sources;
    if constexpr (Axes == 2)
        for (const OtherReceiver& other : records.receivers)
            if (auto source = source_by_receiver(screened, *other.screened))
                sources.push_back(*std::move(source));
    if (auto velocities = velocity_witness<Axes>(screened, directions)) {
        std::optional<std::string> original;
        if constexpr (Axes == 2) {
            auto source = source_by_velocities(screened, directions);
            original = source_of(source->speeds_m_s, sources, source->delay_s);
            sources.push_back(*std::move(source));
        }
        witnesses.push_back(
            {.kind = WitnessKind::velocities,
             .motion = std::make_shared<const VelocityWitness<Axes>>(*std::move(velocities)),
             .note = original ? copy_text("recorded velocities", *original) : std::string(),
             .is_copy = original.has_value(),
             .confirms = !screened.basis.velocity || !screened.basis.velocity->unfit});
    }
    if (records.phases)
        if (auto found = phase_witness<Axes>(records.phases, records.first_of_phases,
                                             trajectory.facts.first_epoch, trajectory.origin,
                                             jerk_density)) {
            const auto phases = std::make_shared<const PhaseWitness<Axes>>(*std::move(found));
            witnesses.push_back({.kind = WitnessKind::phases, .motion = phases, .phases = phases});
        }
    if (records.inertial && !records.inertial->epochs.empty() &&
        records.inertial->consistency.tells_motion())
        witnesses.push_back({.kind = WitnessKind::imu,
                             .motion = std::make_shared<const ImuWitness<Axes>>(records.inertial),
                             .confirms = false});
    const bool related = !(records.handed_in.series.empty() && records.receivers.empty());
    const Track track = related ? track_of(trajectory) : Track{};
    if constexpr (Axes == 2) {
        const auto positions =
            related ? timed_positions<2>(screened.rows) : std::vector<TimedPosition<2>>{};
        const AntennaSwing swing = antenna_swing(records);
        for (const WitnessEntry& entry : witness_roster())
            if (auto made = handed_in_witness(entry, records.handed_in, positions, track,
                                              jerk_density, sources, swing)) {
                if (swing.is_known() && !made->is_copy)
                    made->note += antenna_comparison_text(screened, entry.kind);
                witnesses.push_back(*std::move(made));
            }
    }
    for (const OtherReceiver& other : records.receivers)
        if (auto found = receiver_witness<Axes>(track_of(*other.trajectory), track))
            witnesses.push_back(
                {.kind = WitnessKind::receiver,
                 .receiver = other.trajectory->facts.receiver,
                 .motion = std::make_shared<const ReceiverWitness<Axes>>(*std::move(found))});
    return witnesses;
}

std::vector<std::string> unused_witness_notes(const WitnessRecords& records,
                                              const AssessedWitnesses<2>& witnesses) {
    std::vector<std::string> sentences;
    for (const auto& [key, series] : records.handed_in.series)
        if (!series.left_out.empty()) sentences.push_back(series.left_out);
    const auto was_given = [&](WitnessKind kind) {
        return kind == WitnessKind::phases ? records.phases != nullptr
               : kind == WitnessKind::imu  ? records.inertial != nullptr
               : kind == WitnessKind::receiver
                   ? !records.receivers.empty()
                   : records.handed_in.series.contains(std::string(to_text(kind)));
    };
    for (const WitnessEntry& entry : witness_roster())
        if (was_given(entry.kind) &&
            std::ranges::find(witnesses, entry.kind, &AssessedWitness<2>::kind) == witnesses.end())
            sentences.push_back(fmt::format("The {} were handed in and say nothing: {}.",
                                            words_of(entry.kind), entry.silent));
    return sentences;
}

template <int Axes>
std::string silence_text(const AssessedWitness<Axes>& witness, const TrajectoryTable& trajectory,
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

std::string contradiction_text(const AssessedWitness<2>& witness, const ScreenedTable& screened) {
    if (witness.kind == WitnessKind::phases) return {};
    const WitnessedMotionComparison found =
        compare_motion(timed_positions<2>(screened.rows), *witness.motion, usual_window_s);
    if (!found.contradicts) return {};
    std::string text = fmt::format(
        "The {} show another motion than the positions: over {:g} s they differ by {:.2f} m "
        "(median "
        "of {} spans).",
        words_of(witness.kind), usual_window_s, found.median_difference_m, found.spans);
    if (found.positions_ahead_s)
        text += fmt::format(
            " The clock of the positions is {} s {} theirs: shifted by this the two agree.",
            std::abs(*found.positions_ahead_s),
            *found.positions_ahead_s > 0 ? "ahead of" : "behind");
    return text;
}

std::string unconfirming_text(const AssessedWitness<2>& witness, const WindowSpan& span,
                              const std::string& profile) {
    const double start_s = span.start.seconds();
    const auto motion = witness.motion->between(start_s, start_s + span.duration.seconds());
    if (!motion || motion->confirms) return {};
    return fmt::format("The {} confirm nothing of the window certified under {}: {}.",
                       words_of(witness.kind), profile, witness_entry(witness.kind).unconfirming);
}

double sigma_of_difference(const WitnessedSpeed& one) {
    return std::hypot(one.standard_uncertainty_m_s, one.position_standard_uncertainty_m_s);
}

template <int Axes>
double displacement_ratio(const WitnessedMotion<Axes>& motion,
                          const PositionFigures<Axes>& positions) {
    const double sigma_m = positions.speed.alone_m_s() * positions.duration_s();
    const PositionMatrix<Axes> covariance =
        motion.covariance_m2 + sigma_m * sigma_m * PositionMatrix<Axes>::Identity();
    const PositionVector<Axes> difference = positions.displacement_m - motion.displacement_m;
    return over_chance(difference.dot(covariance.inverse() * difference), Axes);
}

namespace {

/// The speed of a window by a witness, with its error along the displacement by positions. Empty if
/// the rule measures a path, and the witness knows none.
template <int Axes>
std::optional<SpeedBySource> speed_by(const AssessedWitness<Axes>& witness,
                                      const WitnessedMotion<Axes>& motion,
                                      const PositionFigures<Axes>& positions) {
    const double duration_s = positions.duration_s();
    const std::optional<double> path_m =
        positions.by_path ? witness.motion->path_between(positions.start_s, positions.end_s)
                          : motion.displacement_m.norm();
    if (!path_m) return std::nullopt;
    const double length_m = positions.displacement_m.norm();
    // For a craft that hardly moved, any direction will do.
    const PositionVector<Axes> along =
        length_m > 0.0 ? PositionVector<Axes>(positions.displacement_m / length_m)
                       : PositionVector<Axes>::Unit(0);
    return SpeedBySource{.speed_m_s = *path_m / duration_s,
                         .own_m_s = std::sqrt(along.dot(motion.covariance_m2 * along)) / duration_s,
                         .fault = witness_entry(witness.kind).fault(positions.speed.fault)};
}

}  // namespace

template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const AssessedWitness<Axes>& witness,
                                              const PositionFigures<Axes>& positions) {
    if (witness.is_copy) return std::nullopt;
    auto motion = witness.motion->between(positions.start_s, positions.end_s);
    if (!motion) return std::nullopt;
    const double duration_s = positions.duration_s();
    if (witness.kind == WitnessKind::receiver) {
        const double slow_m = positions.speed.slow_m_s * duration_s;
        motion->covariance_m2 += slow_m * slow_m * PositionMatrix<Axes>::Identity();
    }
    const auto by_witness = speed_by(witness, *motion, positions);
    if (!by_witness) return std::nullopt;
    WitnessedSpeed witnessed;
    witnessed.kind = witness.kind;
    witnessed.receiver = witness.receiver;
    witnessed.origin = origin_of(witness.kind).front();
    witnessed.speed_m_s = by_witness->speed_m_s;
    if (witness.kind == WitnessKind::phases)
        witnessed.shared_standard_uncertainty_m_s =
            std::numbers::sqrt2 * shared_by_phases_m / duration_s;
    witnessed.standard_uncertainty_m_s = by_witness->own_m_s;
    witnessed.difference_m_s = positions.speed.speed_m_s - by_witness->speed_m_s;
    witnessed.position_standard_uncertainty_m_s = positions.speed.alone_m_s();
    const double sigma_m_s = sigma_of_difference(witnessed);
    witnessed.chance_error = displacement_ratio(*motion, positions);
    witnessed.normalised_error =
        std::max(std::abs(witnessed.difference_m_s) / (2.0 * sigma_m_s), *witnessed.chance_error);
    const PositionVector<Axes> apart = positions.displacement_m - motion->displacement_m;
    witnessed.apart_m = apart.norm();
    if constexpr (Axes == 2) witnessed.apart_azimuth_deg = azimuth_deg(apart.x(), apart.y());
    if (witness.phases) {
        const PhaseInterruptions within =
            witness.phases->interruptions(positions.start_s, positions.end_s);
        witnessed.satellites = motion->satellites;
        witnessed.slips = within.slips;
        witnessed.refusals = within.refusals;
    }
    witnessed.fault_probability = by_witness->fault.probability;
    witnessed.fault_m_s = by_witness->fault.largest_m_s;
    const std::vector<double> at_fault = fault_posteriors(std::array{positions.speed, *by_witness});
    witnessed.fault_posterior = at_fault[0] + at_fault[1];
    witnessed.undetected_m_s =
        std::min(positions.speed.fault.largest_m_s, found_in_units * sigma_m_s);
    witnessed.unanswered = witness.unanswered;
    witnessed.confirms = witness.confirms && motion->confirms;
    witnessed.calibrated_by_positions = motion->calibrated_by_positions;
    return witnessed;
}

template <int Axes>
std::optional<PositionVector<Axes>> ArcMotion<Axes>::between(double from_s, double to_s) const {
    if (from_s < covered_.first_s || to_s > covered_.last_s) return std::nullopt;
    const Eigen::Vector3d moved = track_.at(to_s).position - track_.at(from_s).position;
    return PositionVector<Axes>(Axes == 1 ? moved.tail<Axes>() : moved.head<Axes>());
}

template <int Axes>
std::optional<SpanComparedWith> compared_over(const AssessedWitness<Axes>& witness,
                                              const PositionFigures<Axes>& of_window,
                                              const ArcMotion<Axes>& motion, TimeSpan span) {
    if (witness.is_copy) return std::nullopt;
    const bool covers_span = witness.motion->between(span.first_s, span.last_s).has_value();
    if (!covers_span) {
        const auto around = witness.motion->enclosing(span.first_s, span.last_s);
        if (!around) return std::nullopt;
        span = *around;
    }
    const auto moved_m = motion.between(span.first_s, span.last_s);
    if (!moved_m) return std::nullopt;
    PositionFigures<Axes> figures{
        .start_s = span.first_s, .end_s = span.last_s, .displacement_m = *moved_m};
    const double duration_s = figures.duration_s();
    const double shorter = of_window.duration_s() / duration_s;
    figures.speed = {.speed_m_s = moved_m->norm() / duration_s,
                     .own_m_s = shorter * of_window.speed.own_m_s,
                     .slow_m_s = shorter * of_window.speed.slow_m_s,
                     .fault = of_window.speed.fault};
    figures.speed.fault.largest_m_s *= shorter;
    auto speed = witnessed_speed(witness, figures);
    if (!speed) return std::nullopt;
    if (!covers_span) {
        speed->compared_over_s = duration_s;
        speed->confirms = false;
    }
    return SpanComparedWith{.span = span, .speed = *std::move(speed)};
}

template <int Axes>
std::vector<WitnessedSpeed> witnessed_speeds(const AssessedWitnesses<Axes>& witnesses,
                                             const PositionFigures<Axes>& window,
                                             const ArcMotion<Axes>& motion) {
    std::vector<WitnessedSpeed> speeds;
    for (const AssessedWitness<Axes>& witness : witnesses) {
        if (auto speed = witnessed_speed(witness, window)) {
            speeds.push_back(*std::move(speed));
            continue;
        }
        const TimeSpan span{window.start_s, window.end_s};
        if (witness.motion->between(span.first_s, span.last_s)) continue;
        if (auto around = compared_over(witness, window, motion, span))
            speeds.push_back(std::move(around->speed));
    }
    return speeds;
}

#define RUNCERT_INSTANTIATE(AXES)                                                               \
    template std::string silence_text(const AssessedWitness<AXES>&, const TrajectoryTable&,     \
                                      const std::string&);                                      \
    template AssessedWitnesses<AXES> witnesses_of(const ScreenedTable&, const TrajectoryTable&, \
                                                  const WitnessRecords&, double);               \
    template double displacement_ratio(const WitnessedMotion<AXES>&,                            \
                                       const PositionFigures<AXES>&);                           \
    template std::optional<WitnessedSpeed> witnessed_speed(const AssessedWitness<AXES>&,        \
                                                           const PositionFigures<AXES>&);       \
    template class ArcMotion<AXES>;                                                             \
    template std::optional<SpanComparedWith> compared_over(const AssessedWitness<AXES>&,        \
                                                           const PositionFigures<AXES>&,        \
                                                           const ArcMotion<AXES>&, TimeSpan);   \
    template std::vector<WitnessedSpeed> witnessed_speeds(                                      \
        const AssessedWitnesses<AXES>&, const PositionFigures<AXES>&, const ArcMotion<AXES>&);
RUNCERT_INSTANTIATE(1)
RUNCERT_INSTANTIATE(2)
#undef RUNCERT_INSTANTIATE

}  // namespace runcert
