#pragma once

#include <map>

#include "motion/epoch_motion.h"
#include "stages/screen/adaptation.h"
#include "stages/screen/noise.h"
#include "witness/arcs.h"

namespace runcert {

/// The noise of both groups of axes, and factors on the stated variances of each fix type in
/// addition to it.
struct ScreeningNoises {
    ScreeningNoise horizontal;
    std::optional<ScreeningNoise> vertical;  ///< empty if no heights were measured
    std::map<FixType, double> horizontal_factors;
    std::map<FixType, double> vertical_factors;
};

/// Compares the innovations of each fix type with the fitted noise. The result is the robust
/// variance factor that its stated standard deviations need, and whether they are optimistic or
/// pessimistic (beyond chance, at three standard deviations of the median). Fix types with fewer
/// than 100 tested epochs are treated as the others.
template <int Axes>
std::vector<FixTypeErrors> compare_fix_types(const ScreenedTable& first_look,
                                             const ScreeningNoise& noise);

/// Fills in the test of every row of an arc, given all decisions. These are statistic and threshold
/// of the best supported hypothesis of usable rows, the estimated errors of rows left out,
/// detectable sizes and local variance factors. Returns the smoothed motion.
Motion examine_arcs(ScreenedTable& table, const ScreeningNoises& noises, const TestPlan& plan,
                    std::size_t section_epochs = epochs_of_section);

}  // namespace runcert
