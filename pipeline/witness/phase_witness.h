#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "estimation/phase_record.h"
#include "estimation/phase_screening.h"

namespace runcert {

/// Solves the receiver's place by its pseudoranges (some metres), at every epoch that has none yet;
/// where they are too few it is the place solved before.
void locate_by_pseudoranges(PhaseRecord& record);

/// The same of one epoch, from a place near by; nothing where the pseudoranges are too few.
std::optional<Eigen::Vector3d> place_by_pseudoranges(const PhaseRecord& record,
                                                     const PhaseEpoch& epoch,
                                                     const Eigen::Vector3d& near_m);

/// The first epoch that is so long after another, to 20 ms; nothing where there is none.
std::optional<std::size_t> epoch_after(const PhaseRecord& record, std::size_t first,
                                       std::int64_t length_ns);

/// How far the receiver moved between two epochs of a record, by its phases.
struct WitnessedDisplacement {
    Eigen::Vector3d enu_m;
    /// White noise of the phases, by their residuals where these are larger; and horizontally the
    /// systematic rates of all satellites.
    Eigen::Matrix3d covariance_m2;
    double interval_s = 0.0;  ///< true time between them: the receiver's clock is taken out
    std::size_t satellites = 0;
    double statistic = 0.0;  ///< chi-squared with `redundancy` degrees of freedom is expected
    int redundancy = 0;
};

/// What a satellite's phase differs by from the displacement of all.
struct PhaseResidual {
    Satellite satellite;
    double residual_m = 0.0;
    double sigma_m = 0.0;  ///< of the phase, as it was weighted
};

/// The residuals of that displacement; empty where there is none.
std::vector<PhaseResidual> residuals_between(const PhaseRecord& record,
                                             const PhaseScreening& screening, std::size_t first,
                                             std::size_t second);

/// Fewer satellites are not enough to judge by.
inline constexpr std::size_t least_witnesses = 6;

/// The displacement between two epochs (numbers in the record) by the first-band phases whose arcs
/// span both. Nothing where fewer than `least_witnesses` do, or the place is not known.
std::optional<WitnessedDisplacement> displacement_between(const PhaseRecord& record,
                                                          const PhaseScreening& screening,
                                                          std::size_t first, std::size_t second);

}  // namespace runcert
