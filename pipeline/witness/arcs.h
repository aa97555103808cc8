#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "estimation/noise_fit.h"
#include "estimation/smoother.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/trajectory.h"

namespace runcert {

/// An arc, ready for estimation.
template <int Axes>
struct Arc {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;       ///< indices into the table's rows
    std::vector<ArcEpoch<Axes>> epochs;  ///< one for each of these rows
};

/// Which epochs of an arc come with their measurement.
enum class Measurements {
    usable,            ///< those that screening kept
    before_rejection,  ///< and those that were rejected alone, as outliers
};

/// The arcs of a screened table, in order, of the horizontal positions (Axes 2), the heights alone
/// (1) or both together (3). Rejected epochs inside an arc are kept, without their
/// measurement. The covariances are those stated, unscaled.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& table,
                               Measurements measurements = Measurements::usable);

/// The noise model that a trajectory was estimated with.
EstimationModel model_of(const NoiseSummary& noise);

/// The models of the motion that an attempt's choice allows.
NoiseFitOptions::Motion motion_of(MotionChoice choice);

/// What an estimate rests on after this fit.
NoiseBasis basis_of(NoiseFit::Status status);

/// The horizontal (Axes 2) or vertical (1) noise that a trajectory says it was estimated with.
/// Failure without heights for the vertical one.
template <int Axes>
const NoiseSummary& noise_of(const TrajectoryTable& trajectory);

/// The arcs of a screened table with the jerk densities that the trajectory was estimated with.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& screened, const TrajectoryTable& trajectory);

/// The models that the recording allows, with their shares; that of the trajectory alone where
/// nothing was fitted.
std::vector<WeightedModel> posterior_of(const NoiseSummary& noise);

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
