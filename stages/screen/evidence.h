#pragma once

#include <map>

#include "estimation/epoch_motion.h"
#include "estimation/tables/screening_noise.h"
#include "stages/screen/adaptation.h"
#include "stages/screen/noise.h"

namespace runcert {

/// The noise of both groups of axes, and by how much the stated variances of each kind of solution
/// are multiplied beside it.
struct ScreeningNoises {
    ScreeningNoise horizontal;
    std::optional<ScreeningNoise> vertical;  ///< where heights were measured
    std::map<FixKind, double> horizontal_factors;
    std::map<FixKind, double> vertical_factors;
};

/// Compares the innovations of each kind of solution with the noise fitted: the robust variance
/// factor that its stated accuracies need, and whether they are too good or too bad (beyond chance,
/// at three standard deviations of the median). Kinds of fewer than 100 tested epochs are taken as
/// the others.
template <int Axes>
std::vector<FixKindEvidence> compare_fix_kinds(const ScreenedTable& first_look,
                                               const ScreeningNoise& noise);

/// Fills the evidence of every row of an arc, given all decisions: statistic and threshold of the
/// best supported hypothesis of usable rows, the errors of those left out as estimated, detectable
/// sizes, local variance factors; and the smoothed motion.
Motion examine_arcs(ScreenedTable& table, const ScreeningNoises& noises, const TestPlan& plan,
                    std::size_t section_epochs = epochs_of_section);

}  // namespace runcert
