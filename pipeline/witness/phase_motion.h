#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "satellites/phase_record.h"
#include "satellites/phase_screening.h"
#include "witness/phase_witness.h"
#include "witness/witness.h"

namespace runcert {

/// A receiver's phases with their screening.
struct JudgedPhases {
    PhaseRecord record;
    PhaseScreening screening;
};

/// What screening excluded from a stretch of a record.
struct PhaseInterruptions {
    std::int64_t slips = 0;
    std::int64_t refusals = 0;  ///< pairs of epochs
};

/// The local axes of the positions from one of their times on.
struct FrameTurn {
    double from_s = 0.0;
    Eigen::Matrix3d enu_from_ecef;
};

/// A receiver's carrier phases as a witness of its positions. The displacement between two epochs
/// comes from every satellite whose phase did not slip in between (`displacement_between`). It is
/// rotated into the positions' frame, whose tangent plane may touch the Earth elsewhere.
///
/// Each instant is served by the nearest epoch, at most half a step away. The motion between the
/// two follows from the displacements to the neighbouring epochs. The covariance includes a white
/// jerk of `jerk_density` (m s^-2.5) in between. The true time between epochs is that of the
/// receiver's clock minus its drift, and the displacement is scaled to the time requested. No
/// answer is given where the clock jumps between two epochs.
///
/// It cannot see what offsets phases and positions alike: a constant error, a wrong frame, or a
/// wrong time common to both. Of multipath, which disturbs both, it sees only the part that they do
/// not share.
template <int Axes>
class PhaseWitness final : public Witness<Axes> {
  public:
    /// `first_epoch_s` is the first epoch of the positions on the record's time scale. `turns` are
    /// the frames of the positions, in order of time; the first holds from the beginning.
    PhaseWitness(std::shared_ptr<const JudgedPhases> phases, double first_epoch_s,
                 std::vector<FrameTurn> turns, double jerk_density);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    /// Sum of the lengths of the displacements from epoch to epoch.
    std::optional<double> path_between(double from_s, double to_s) const override;

    PhaseInterruptions interruptions(double from_s, double to_s) const;

  private:
    /// An instant: the nearest epoch, and the motion from that epoch to the instant.
    struct Instant {
        std::size_t epoch = 0;
        Eigen::Vector3d beyond_m = Eigen::Vector3d::Zero();
        double variance_m2 = 0.0;  ///< of `beyond_m`, each axis
    };
    std::optional<std::size_t> nearest(double record_s) const;
    std::optional<Instant> instant_at(double time_s) const;
    double record_time_s(std::size_t epoch) const;
    std::optional<WitnessedDisplacement> displacement(std::size_t first, std::size_t second) const;
    Eigen::Matrix3d turn_at(std::size_t epoch) const;

    std::shared_ptr<const JudgedPhases> phases_;
    double first_epoch_s_;
    std::vector<FrameTurn> turns_;
    double jerk_density_;
    double nominal_step_s_ = 0.0;
};

}  // namespace runcert
