#pragma once

#include <map>

#include "arcs/arcs.h"

namespace runcert {

/// The noise model that the tests of screening rested on.
EstimationModel model_of(const ScreeningModel& noise);

/// By how much the stated variances of each kind of solution were multiplied beside that model's
/// scale. Empty where there was but one kind, whose scale is the model's.
std::map<FixKind, double> kind_factors(const ScreeningEvidence& evidence, TestedAxes axes);

/// The arcs of the table, stated covariances times the factor of their kind of solution.
template <int Axes>
std::vector<Arc<Axes>> scaled_arcs(const ScreenedTable& table,
                                   const std::map<FixKind, double>& factors);

}  // namespace runcert
