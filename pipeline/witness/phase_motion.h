#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "estimation/phase_record.h"
#include "estimation/phase_screening.h"
#include "witness/phase_witness.h"
#include "witness/witness.h"

namespace runcert {

/// A receiver's phases with what screening found of them.
struct JudgedPhases {
    PhaseRecord record;
    PhaseScreening screening;
};

/// What screening left out of a stretch of a record.
struct PhaseInterruptions {
    std::int64_t slips = 0;
    std::int64_t refusals = 0;  ///< pairs of epochs
};

/// The axes of the positions from a time of theirs on.
struct FrameTurn {
    double from_s = 0.0;
    Eigen::Matrix3d enu_from_ecef;
};

/// The carrier phases of a receiver as a witness of its positions: the displacement between two
/// epochs by every satellite whose phase did not slip between them (`displacement_between`), turned
/// into the positions' frame, whose tangent plane may touch the Earth somewhere else.
///
/// An instant is served by the epoch nearest to it, no further than half a step; what the craft
/// moved between the two is taken from the displacements to the neighbours, and what it may have
/// done otherwise with a white jerk of `jerk_density` (m s^-2.5) is in the covariance. Epochs are
/// apart by what the receiver's clock says less what it gained: the displacement is that of the
/// time asked for. A clock that jumps between two epochs is not worth that: nothing is answered.
///
/// It cannot see what offsets phases and positions alike: a constant error, a wrong frame, a wrong
/// time common to both; and of multipath, which disturbs both, only what they do not share.
template <int Axes>
class PhaseWitness final : public Witness<Axes> {
  public:
    /// `first_epoch_s`: of the positions, on the record's time scale. `turns`: of the frames that
    /// the positions are in, in order of time; the first holds from the beginning.
    PhaseWitness(std::shared_ptr<const JudgedPhases> phases, double first_epoch_s,
                 std::vector<FrameTurn> turns, double jerk_density);

    std::optional<WitnessedMotion<Axes>> between(double from_s, double to_s) const override;
    TimeSpan covered() const override;
    /// The sum of the displacements from epoch to epoch.
    std::optional<double> path_between(double from_s, double to_s) const override;

    PhaseInterruptions interruptions(double from_s, double to_s) const;

  private:
    /// An instant: the nearest epoch, and what the craft moved from it on.
    struct Place {
        std::size_t epoch = 0;
        Eigen::Vector3d beyond_m = Eigen::Vector3d::Zero();
        double variance_m2 = 0.0;  ///< of that, each axis
    };
    std::optional<std::size_t> nearest(double record_s) const;
    std::optional<Place> place_of(double time_s) const;
    double record_time_s(std::size_t epoch) const;
    std::optional<WitnessedDisplacement> moved(std::size_t first, std::size_t second) const;
    Eigen::Matrix3d turn_at(std::size_t epoch) const;

    std::shared_ptr<const JudgedPhases> phases_;
    double first_epoch_s_;
    std::vector<FrameTurn> turns_;
    double jerk_density_;
    double nominal_step_s_ = 0.0;
};

}  // namespace runcert
