#pragma once

#include <algorithm>
#include <cmath>
#include <map>

#include "witness/arcs.h"

namespace runcert {

/// The noise model that the tests of screening rested on.
EstimationModel model_of(const ScreeningModel& noise);

/// By how much the stated variances of each fix type were multiplied beside that model's
/// scale. Empty where there was but one kind, whose scale is the model's.
std::map<FixType, double> kind_factors(const ScreeningBasis& basis, TestedAxes axes);

/// Gives the step from one epoch to the next so much jerk density that an acceleration which
/// changes by `size_m_s2` in it is one standard deviation; never less than it has.
template <int Axes>
void allow_manoeuvre(const ArcEpoch<Axes>& from, double size_m_s2, const EstimationModel& model,
                     ArcEpoch<Axes>& to) {
    const double of_model = model.motion.jerk_density * std::sqrt(to.time_s - from.time_s);
    to.jerk_factor = std::max(to.jerk_factor, size_m_s2 / of_model);
}

/// The arcs of the table as the tests of screening have them: stated covariances times the factor
/// of their fix type, and the manoeuvres that were found allowed for.
template <int Axes>
std::vector<Arc<Axes>> tested_arcs(const ScreenedTable& table, const EstimationModel& model,
                                   const std::map<FixType, double>& factors);

/// The manoeuvre found before an epoch (m/s^2), horizontally or vertically; 0 where there is none.
template <int Axes>
double manoeuvre_before(const ScreenedEpoch& row) {
    return (Axes == 1 ? row.manoeuvre_up_m_s2 : row.manoeuvre_m_s2).value_or(0.0);
}

}  // namespace runcert
