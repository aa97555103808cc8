#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "motion/chain.h"
#include "motion/noise_fit.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"
#include "schemas/trajectory/declared.h"

namespace runcert {

/// An arc, ready for estimation.
template <int Axes>
struct Arc {
    std::int64_t number = 0;
    std::vector<std::size_t> rows;       ///< indices into the rows of the table
    std::vector<ArcEpoch<Axes>> epochs;  ///< one for each of these rows
};

/// Which epochs of an arc have their measurement.
enum class Measurements {
    usable,            ///< epochs that screening kept
    before_rejection,  ///< also epochs rejected individually, as outliers
};

/// The arcs of a screened table, in order, of the horizontal positions (Axes 2), the heights alone
/// (1) or both together (3). Rejected epochs inside an arc stay, without their measurement.
/// Covariances are as stated, unscaled.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& table,
                               Measurements measurements = Measurements::usable);

/// The axes that a screened table names for estimates of the horizontal positions (2) or of heights
/// alone (1).
template <int Axes>
inline constexpr TestedAxes tested_axes = Axes == 1 ? TestedAxes::vertical : TestedAxes::horizontal;

/// The noise model with which a trajectory was estimated.
EstimationModel model_of(const NoiseSummary& noise);

/// The options of the noise fit that an attempt's parameters of smoothing ask for.
NoiseFitOptions fit_options(const SmoothParameters& parameters);

/// The basis of an estimate, given the status of its noise fit.
NoiseBasis basis_of(NoiseFit::Status status);

/// The horizontal (Axes 2) or vertical (1) noise with which a trajectory says it was estimated.
/// Failure if the vertical one is requested and the trajectory has no heights.
template <int Axes>
const NoiseSummary& noise_of(const TrajectoryTable& trajectory);

/// The arcs of a screened table, with the jerk densities used to estimate the trajectory.
template <int Axes>
std::vector<Arc<Axes>> arcs_of(const ScreenedTable& screened, const TrajectoryTable& trajectory);

/// The noise models that the recording supports, with their weights. Only the trajectory's own
/// model where nothing was fitted.
std::vector<WeightedModel> posterior_of(const NoiseSummary& noise);

/// The noise model of screening's tests.
EstimationModel model_of(const ScreeningModel& noise);

/// Factors on the stated variances of each fix type, in addition to the model's scale. Empty if
/// there was only one fix type, whose scale is the model's.
std::map<FixType, double> kind_factors(const ScreeningBasis& basis, TestedAxes axes);

/// Raises the jerk density of the step to the next epoch so that a change of acceleration by
/// `size_m_s2` is one standard deviation. It is never lowered.
template <int Axes>
void allow_manoeuvre(const ArcEpoch<Axes>& from, double size_m_s2, const EstimationModel& model,
                     ArcEpoch<Axes>& to) {
    const double of_model = model.motion.jerk_density * std::sqrt(to.time_s - from.time_s);
    to.jerk_factor = std::max(to.jerk_factor, size_m_s2 / of_model);
}

/// The arcs of the table as screening tests them. Stated covariances are multiplied by the factor
/// of their fix type, and the manoeuvres found are allowed for.
template <int Axes>
std::vector<Arc<Axes>> tested_arcs(const ScreenedTable& table, const EstimationModel& model,
                                   const std::map<FixType, double>& factors);

/// The manoeuvre (m/s^2) found just before an epoch, horizontal (Axes 2) or vertical (1). 0 if
/// there is none.
template <int Axes>
double manoeuvre_before(const ScreenedEpoch& row) {
    return (Axes == 1 ? row.manoeuvre_up_m_s2 : row.manoeuvre_m_s2).value_or(0.0);
}

}  // namespace runcert
