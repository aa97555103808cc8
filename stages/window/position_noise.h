#pragma once

#include <span>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/speed_by_definition.h"
#include "witness/arcs.h"

namespace runcert {

/// The size of the time-correlated position error that the certificate allows for: the largest of
/// the fitted one, the stated standard deviation times its scale, and the floor of the fix types in
/// the rows `first_row` to `last_row`.
///
/// What the data tell of such an error is how fast it wanders, sigma sqrt(2 / tau): the fitted size
/// is that of the error which wanders as fast with the shortest correlation time of the interval,
/// and whose bounding process therefore bounds the fitted error whatever its correlation time.
/// `along` is the size of that error along the direction of travel in units of the fitted one,
/// which both axes share. `standard_uncertainty_m_s` is left zero. Axes: 2, or 1 for heights alone.
template <int Axes>
ErrorBound error_bound(const ScreenedTable& screened, std::size_t first_row, std::size_t last_row,
                       const NoiseSummary& noise, const UncertaintyRule& rule, double along = 1.0);

/// The size of the fitted time-correlated error along a direction (east, north) in units of that of
/// both axes together: the most likely one for the coordinates along it, between 1 and sqrt(2),
/// which is that of an error in this direction alone. 1 where the model has no such error.
double error_along(std::span<const ArcEpoch<2>> epochs, const EstimationModel& model,
                   const Eigen::Vector2d& direction);

/// Radius (m) of the circle that holds the true horizontal position with a probability of 95 %, at
/// the worse of the window's ends ([NAV] R95): the smoothed position's covariance and the bounded
/// time-correlated error's. Nobody knows which side of a bridged step is the true one: at the worse
/// end the position is off by the step's offset, whose length is therefore added in full. (How well
/// the offset itself is known, some millimetres, does not count beside the bound.) Of heights alone
/// (Axes 1), half the width of the interval that holds the true height with that probability.
template <int Axes>
double position_r95_m(const SmoothedArc<Axes>& smoothed, EpochPair window, const ErrorBound& bound);

/// The process that bounds every time-correlated error that the certificate allows for.
GaussMarkovError bounding_error(const NoiseSummary& noise, const ErrorBound& bound);

/// A window of an arc whose states are estimated.
template <int Axes>
struct EstimatedWindow {
    std::span<const ArcEpoch<Axes>> epochs;  ///< of the arc
    const SmoothedArc<Axes>& smoothed;       ///< from these, with the model
    const EstimationModel& model;
    EpochPair window;  ///< indices into the epochs
    double duration_s = 0.0;
};

/// By how much each measured position moves a window's speed (1/s), one for each epoch of the arc.
template <int Axes>
using SpeedWeights = std::vector<PositionVector<Axes>>;
template <int Axes>
SpeedWeights<Axes> speed_weights(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity);

/// Standard uncertainties of a window's speed from its positions, by source (m/s): their squares
/// add up to that of the whole.
struct PositionNoise {
    SpeedEstimate speed;          ///< by the definition asked for
    double displacement_m = 0.0;  ///< between the window's ends
    double white_m_s = 0.0;       ///< white noise of the positions
    double correlated_m_s = 0.0;  ///< the time-correlated error
    double motion_m_s = 0.0;      ///< what the craft may have done between measurements
    double model_m_s = 0.0;       ///< half width of what the choice of the motion's model changes
    /// What a second receiver does not share: the time-correlated error as it is of this receiver
    /// alone, at its worst correlation time, not as bounded.
    double own_correlated_m_s = 0.0;
};

/// The speed as estimated, and its uncertainty with the time-correlated error bounded: the estimate
/// is a sum of the measured positions times `weights`, and so are the parts of its error that the
/// positions' errors make, whatever model the weights came from. What is left of the estimate's own
/// variance is the motion's.
template <int Axes>
PositionNoise position_noise(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                             const SpeedWeights<Axes>& weights, const GaussMarkovError& bounding,
                             const ErrorBound& bound);

/// What other estimates say of the window, and by how much they differ from the one of `noise`.
template <int Axes>
OtherEstimates other_estimates(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                               const SpeedWeights<Axes>& weights, const PositionNoise& noise);

/// The window's speed over all models of the posterior: mean, and the uncertainty that holds the
/// models' own and their differences.
template <int Axes>
FittedSpeed fitted_speed(const WindowStretch<Axes>& stretch,
                         const std::vector<WeightedModel>& models, const SpeedQuantity& quantity);

}  // namespace runcert
