#pragma once

#include <optional>
#include <span>
#include <vector>

#include "inertial/alignment.h"

namespace runcert {

/// The heading of a craft at an epoch by the direction from one of its antennas to another.
struct BaselineHeading {
    double time_s = 0.0;
    double heading_rad = 0.0;     ///< 0 to below 2 pi
    double sigma_rad = 0.0;       ///< by the stated standard deviations of the two positions
    double difference_rad = 0.0;  ///< less the inertial heading, -pi to pi
};

/// How headings by the antennas and the inertial ones compare.
struct BaselineJudgement {
    std::vector<BaselineHeading> headings = {};
    Estimated<double> length_m = {};        ///< mean distance of the antennas as measured
    Estimated<double> difference_rad = {};  ///< mean of the headings' differences
    /// The mean differs from nothing by no more than two of its standard deviations.
    bool agrees = false;
};

/// Whether antennas so far apart are those stated, to three standard deviations: `body_m` and
/// errors of `fix_sigma_m` in the distance between them.
bool is_stated_length(const AntennaBaseline& baseline, const Estimated<double>& length_m);

/// The mean direction from antenna to antenna of a craft that stands from one time to another.
/// Nothing where no epoch has both antennas, their distance or height above one another is not as
/// stated (beside `gravity`), or the heading's standard deviation is 15 degrees or more.
std::optional<DirectionPair> direction_of(const AntennaBaseline& baseline, double from_s,
                                          double to_s, const DirectionPair& gravity,
                                          const PositionErrorModel& error);

/// Headings by the antennas beside those of a solution, at the epochs that have both. The mean
/// difference errs by what both positions err by, the time-correlated error over its correlation
/// time; by what the antennas' places on the craft err by; and by the inertial heading, the same at
/// all epochs. Nothing where no epoch has both, or the antennas stand above one another: level less
/// than 0.3 m apart, or less than half as far as upwards.
std::optional<BaselineJudgement> judge_baseline(const InertialSolution& solution,
                                                const AntennaBaseline& baseline,
                                                const PositionErrorModel& error);

}  // namespace runcert
