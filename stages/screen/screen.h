#pragma once

#include <algorithm>
#include <set>
#include <span>

#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "stages/screen/physical_limits.h"
#include "stages/screen/sections.h"
#include "witness/roster.h"
#include "witness/witness.h"

namespace runcert {

/// The figures of screening; `schemas/attempt/v1.yaml` describes them under `parameters.screen`.
/// The fix type that one counts as: one that nobody states as that of one receiver alone.
constexpr FixType counted_as(FixType fix) {
    return fix == FixType::unknown ? FixType::single : fix;
}

struct ScreenConfig : ScreenParameters {
    std::set<FixType> counted_fixes = {};  ///< allowed, as counted (`counted_as`): none is unknown
    double tau_min_s = 0.0;  ///< correlation times that a time-correlated error may have
    double tau_max_s = 0.0;
    PhysicalLimits limits = {};
    std::size_t section_epochs = epochs_of_section;  ///< longer arcs are tested in sections

    /// A step of time up to this (s) is bridged by the estimate.
    double bridged_s(double nominal_interval_s) const {
        return std::max(gap_factor * nominal_interval_s, gap_max_s);
    }
};

/// What was recorded beside a receiver's positions and is no part of its table.
struct ScreeningWitnesses {
    const Witness<2>* phases = nullptr;  ///< null where there are none
    HandedIn handed_in = {};
};

/// The figures that the attempt states, or the schema's own where it states none.
ScreenConfig screen_config(const Attempt& attempt);

/// Marks the epochs that may not take part in the estimate, and cuts the rest into arcs.
///
/// First each epoch by itself: position, fix type, time, stated standard deviation; then gaps. Then
/// detection, identification and adaptation ([Baarda68], [Teunissen18]), horizontally and
/// vertically: the noise is estimated from what a first look leaves; every epoch is tested for an
/// outlier, a burst, a step, a ramp and a shift of its stamps, every stretch for the model as a
/// whole; the best supported hypothesis is adapted to, and the tests are repeated until none is
/// left. All tests together raise a false alarm with the family-wise rate at most. Then the
/// witnesses, where there are any: carrier phases, the recorded velocities, what was handed in; and
/// the limits of the craft's class. No row is removed. The header is the caller's. Failure, naming
/// the time, where a covariance of the estimate stops being positive definite by more than
/// rounding.
ScreenedTable screen(const EnuTable& table, const ScreenConfig& config,
                     const ScreeningWitnesses& beside = {});

/// The tables of all receivers of an attempt, in their order: each screened by itself, then the
/// first two compared with one another: the vector between the antennas (`compare_receivers`), and
/// the displacements of each by the other as its witness. `beside`: of each table; empty where
/// there is nothing.
std::vector<ScreenedTable> screen_receivers(std::span<const EnuTable> tables,
                                            const ScreenConfig& config,
                                            std::span<const ScreeningWitnesses> beside = {});

}  // namespace runcert
