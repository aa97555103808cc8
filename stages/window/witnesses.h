#pragma once

#include <memory>
#include <string>
#include <vector>

#include "inertial/inertial_smoother.h"
#include "inertial/still_spans.h"
#include "motion/joint_speeds.h"
#include "schemas/trajectory/declared.h"
#include "schemas/windows/windows.h"
#include "stages/window/velocity_moment.h"
#include "witness/certifiable.h"
#include "witness/phase_motion.h"
#include "witness/recorded_velocities.h"
#include "witness/roster.h"
#include "witness/window_speed.h"

namespace runcert {

/// The smoothed direction of travel at each row.
Directions directions_of(const TrajectoryTable& trajectory);

/// Another receiver of the attempt, with its estimate.
struct OtherReceiver {
    const ScreenedTable* screened = nullptr;
    const TrajectoryTable* trajectory = nullptr;
};

/// Data recorded in addition to a receiver's positions and velocities.
struct WitnessRecords {
    std::shared_ptr<const JudgedPhases> phases = nullptr;
    GpsTime first_of_phases = {};  ///< their first epoch
    /// By the receiver's IMU and its positions; null without an IMU.
    std::shared_ptr<const InertialSolution> inertial = nullptr;
    std::vector<StillSpan> still_by_imu = {};  ///< where that IMU felt that the craft stood
    std::vector<OtherReceiver> receivers = {};
    HandedIn handed_in = {};
    bool own_phases = false;  ///< the phases are the recording's own, as of RINEX
    /// Bounds of the antenna's motion against the craft, where there is no such IMU.
    std::optional<AntennaMotion> antenna_motion = std::nullopt;
};

/// Whether two findings are of the same witness.
bool is_same_witness(const auto& one, const auto& other) {
    return one.kind == other.kind && one.receiver == other.receiver;
}

/// Whether a witness comes from a file other than the recording judged.
inline bool is_second_file(WitnessKind kind, const WitnessRecords& records) {
    return kind != WitnessKind::velocities && !(kind == WitnessKind::phases && records.own_phases);
}

/// A sentence for each part of a series that was left out, and for each series that gave no
/// witness.
std::vector<std::string> unused_witness_notes(const WitnessRecords& records,
                                              const AssessedWitnesses<2>& witnesses);

/// The reason why a witness says nothing about a window: it covers another time than the
/// trajectory, or has a gap in the window.
template <int Axes>
std::string silence_text(const AssessedWitness<Axes>& witness, const TrajectoryTable& trajectory,
                         const std::string& profile);

/// All witnesses of the positions: the recorded velocities, if anything limits their errors; the
/// carrier phases; an IMU that agrees with the positions; series handed in; the other receivers.
template <int Axes>
AssessedWitnesses<Axes> witnesses_of(const ScreenedTable& screened,
                                     const TrajectoryTable& trajectory,
                                     const WitnessRecords& records, double jerk_density);

/// The reason why a witness that agrees with a window does not confirm it. Empty if it does.
std::string unconfirming_text(const AssessedWitness<2>& witness, const WindowSpan& span,
                              const std::string& profile);

/// How far a contradicting witness shows another motion than the positions over the whole
/// recording, and by how many seconds a clock may be off. Empty if it does not, and for phases,
/// about which screening reports.
std::string contradiction_text(const AssessedWitness<2>& witness, const ScreenedTable& screened);

/// A window's figures by positions, for comparison with a witness.
template <int Axes>
struct PositionFigures {
    double start_s = 0.0;
    double end_s = 0.0;
    bool by_path = false;
    SpeedVector<Axes> displacement_m = SpeedVector<Axes>::Zero();
    /// The speed by displacement, or by path, with the errors that a witness does not share.
    SpeedBySource speed = {};

    double duration_s() const { return end_s - start_s; }
};

/// The difference of the displacements by positions and by a witness, divided by the largest that
/// occurs by chance once in a thousand. Above 1 they contradict each other.
template <int Axes>
double displacement_ratio(const WitnessedMotion<Axes>& motion,
                          const PositionFigures<Axes>& positions);

/// The speed of a window by a witness, compared with that by positions. Empty if the witness
/// does not cover the window.
///
/// The two contradict each other where an error of either is more probable than none
/// (`fault_posteriors`), or where the displacements differ by more than chance allows once in a
/// thousand. Another receiver's time-correlated error is assumed to have the same bound as the
/// positions' own. The test allows for both, as if they had nothing in common. `share` stays 0.
template <int Axes>
std::optional<WitnessedSpeed> witnessed_speed(const AssessedWitness<Axes>& witness,
                                              const PositionFigures<Axes>& positions);

/// What a comparison by the 95 % of both finds with a probability of 0.8, in standard uncertainties
/// of the difference.
inline constexpr double found_in_units = 1.96 + 0.84;

/// Standard uncertainty (m/s) of the difference of a window's speeds by positions and by a witness.
double sigma_of_difference(const WitnessedSpeed& one);

/// The smoothed motion along one arc. Between epochs the track follows the cubic through their
/// positions and velocities.
template <int Axes>
class ArcMotion {
  public:
    ArcMotion(const TrajectoryTable& trajectory, const ArcRows& arc)
        : track_(trajectory, arc, Axes == 1 ? Dimension::vertical : Dimension::horizontal),
          covered_{track_.time_s(0), track_.time_s(arc.rows.size() - 1)} {}

    TimeSpan covered() const { return covered_; }
    /// The displacement between two instants (s). Empty if the arc does not hold both.
    std::optional<PositionVector<Axes>> between(double from_s, double to_s) const;

  private:
    SmoothedTrack track_;
    TimeSpan covered_;
};

/// A comparison of positions and a witness over a span.
struct SpanComparedWith {
    TimeSpan span;
    WitnessedSpeed speed;
};

/// The same over another span of the arc, from figures of a window: errors at the ends of a span
/// are taken to be as large as at the window's. Where the witness says nothing of the span, the
/// comparison is over the nearest that encloses it, and confirms nothing. Empty if there is none in
/// the arc.
template <int Axes>
std::optional<SpanComparedWith> compared_over(const AssessedWitness<Axes>& witness,
                                              const PositionFigures<Axes>& of_window,
                                              const ArcMotion<Axes>& motion, TimeSpan span);

/// What all witnesses say of a window, or else of a span that encloses it.
template <int Axes>
std::vector<WitnessedSpeed> witnessed_speeds(const AssessedWitnesses<Axes>& witnesses,
                                             const PositionFigures<Axes>& window,
                                             const ArcMotion<Axes>& motion);

}  // namespace runcert
