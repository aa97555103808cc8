#pragma once

#include <algorithm>
#include <set>
#include <span>

#include "motion/sections.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "stages/screen/physical_limits.h"
#include "stages/screen/surface_check.h"
#include "witness/roster.h"
#include "witness/witness.h"

namespace runcert {

/// The fix type that a given one counts as. An unstated fix type counts as that of a single
/// receiver.
constexpr FixType counted_as(FixType fix) {
    return fix == FixType::unknown ? FixType::single : fix;
}

/// The parameters of screening, with those that follow from them.
struct ScreenConfig : ScreenParameters {
    std::set<FixType> counted_fixes = {};  ///< allowed fix types, as counted (`counted_as`), so
                                           ///< never unknown
    double tau_min_s = 0.0;  ///< limits of the correlation time of a time-correlated error
    double tau_max_s = 0.0;
    PhysicalLimits limits = {};
    std::size_t section_epochs = epochs_of_section;  ///< longer arcs are tested in sections

    /// Longest time step (s) that the estimate bridges.
    double bridged_s(double nominal_interval_s) const {
        return std::max(gap_factor * nominal_interval_s, gap_max_s);
    }
};

/// Data recorded in addition to a receiver's positions that are not in its table.
struct ScreeningWitnesses {
    const Witness<2>* phases = nullptr;  ///< null if there are none
    HandedIn handed_in = {};
    const GroundBelow* ground = nullptr;  ///< null if no surface was handed in
};

/// The parameters of screening (`schemas/attempt/v1.yaml`, `parameters.screen`): those that the
/// attempt states, and the schema's defaults elsewhere.
ScreenConfig screen_config(const Attempt& attempt);

/// Marks the epochs that must not enter the estimate, and divides the rest into arcs.
///
/// First each epoch is checked alone: position, fix type, time, stated standard deviation; then
/// gaps. Then follow detection, identification and adaptation ([Baarda68], [Teunissen18]),
/// horizontally and vertically. The noise is estimated from what a first look leaves. Every epoch
/// is tested for an outlier, a burst, a step, a ramp and a shift of its stamps, and every stretch
/// for the model as a whole. The best supported hypothesis is adapted to, and the tests are
/// repeated until none is left. All tests together raise a false alarm with at most the family-wise
/// rate.
///
/// Then the heights are compared with the surface that the craft runs on, if one was handed in
/// (`check_surface`).
///
/// Then come the witnesses, if any (carrier phases, the recorded velocities, series handed in), and
/// the limits of the craft's class. No row is removed. The caller sets the header. Failure, naming
/// the time, where a covariance of the estimate stops being positive definite by more than
/// rounding; and where the surface is another one.
ScreenedTable screen(const EnuTable& table, const ScreenConfig& config,
                     const ScreeningWitnesses& witnesses = {});

/// Screens the tables of all receivers of an attempt, in their order: each on its own, then the
/// first two against each other. That comparison covers the vector between the antennas
/// (`compare_receivers`), and the displacements of each with the other as its witness.
/// `witnesses` has one element for each table, or is empty if there is nothing.
std::vector<ScreenedTable> screen_receivers(std::span<const EnuTable> tables,
                                            const ScreenConfig& config,
                                            std::span<const ScreeningWitnesses> witnesses = {});

}  // namespace runcert
