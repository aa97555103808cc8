#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "satellites/phase_record.h"
#include "satellites/phase_screening.h"

namespace runcert {

/// Computes the receiver's place from its pseudoranges, to some metres, at every epoch that has
/// none yet. Where there are too few, the last computed place is used.
void locate_by_pseudoranges(PhaseRecord& record);

/// The place at one epoch from its pseudoranges, starting from a nearby one. Empty if there are
/// too few.
std::optional<Eigen::Vector3d> position_by_pseudoranges(const PhaseRecord& record,
                                                        const PhaseEpoch& epoch,
                                                        const Eigen::Vector3d& near_m);

/// The first epoch `length_ns` after another, to 20 ms. Empty if there is none.
std::optional<std::size_t> epoch_after(const PhaseRecord& record, std::size_t first,
                                       std::int64_t length_ns);

/// The displacement of the receiver between two epochs of a record, from its phases.
struct WitnessedDisplacement {
    Eigen::Vector3d enu_m;
    /// White noise of the phases, raised to their residuals where these are larger. Horizontally it
    /// includes the systematic rates of all satellites.
    Eigen::Matrix3d covariance_m2;
    double interval_s = 0.0;  ///< true time between the epochs, corrected for the receiver's clock
    std::size_t satellites = 0;
    double statistic = 0.0;  ///< chi-squared with `redundancy` degrees of freedom
    int redundancy = 0;
};

/// The deviation of a satellite's phase from the displacement by all satellites.
struct PhaseResidual {
    Satellite satellite;
    double residual_m = 0.0;
    double sigma_m = 0.0;  ///< standard deviation with which the phase was weighted
};

/// The residuals of the displacement between two epochs. Empty if there is none.
std::vector<PhaseResidual> residuals_between(const PhaseRecord& record,
                                             const PhaseScreening& screening, std::size_t first,
                                             std::size_t second);

/// Fewer satellites are not enough for a judgement.
inline constexpr std::size_t least_witnesses = 6;

/// The displacement between two epochs (indices into the record) from the first-band phases whose
/// arcs span both. Empty if fewer than `least_witnesses` do, or if the place is unknown.
std::optional<WitnessedDisplacement> displacement_between(const PhaseRecord& record,
                                                          const PhaseScreening& screening,
                                                          std::size_t first, std::size_t second);

}  // namespace runcert
