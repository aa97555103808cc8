#pragma once

#include <span>
#include <vector>

#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/instants.h"
#include "witness/arcs.h"
#include "witness/window_speed.h"

namespace runcert {

/// The least time-correlated error (m) that a rule assumes of positions of this fix type. Empty if
/// it names none.
std::optional<double> error_floor_m(const UncertaintyRule& rule, FixType fix);

/// The size of the time-correlated position error that the certificate allows for. It is the
/// largest of the fitted one, the stated standard deviation times its scale, what the positions
/// showed while the craft stood (`standing_error_m`), and the floor for the fix types in rows
/// `first_row` to `last_row`.
///
/// The data best determine how fast such an error wanders, sigma sqrt(2 / tau). The fitted size is
/// that of an error that wanders as fast with the shortest correlation time of the interval; with a
/// longer one it is larger (`sigma_at`). `along` is the size of that error along the direction of
/// travel in units of the fitted one, which both axes share. `standard_uncertainty_m_s` stays zero.
/// Axes: 2, or 1 for heights alone.
template <int Axes>
ErrorBound error_bound(const ScreenedTable& screened, std::size_t first_row, std::size_t last_row,
                       const NoiseSummary& noise, const UncertaintyRule& rule, double along = 1.0,
                       const std::vector<Stand>& stands = {});

/// The size of the fitted time-correlated error along a direction (east, north), in units of that
/// of both axes together. It is the most likely size for the coordinates along the direction,
/// between 1 and sqrt(2), which is that of an error in this direction alone. 1 where the model has
/// no such error.
double error_along(std::span<const ArcEpoch<2>> epochs, const EstimationModel& model,
                   const Eigen::Vector2d& direction);

/// Radius (m) of the circle that holds the true horizontal position with a probability of 95 %
/// ([NAV] R95), at the less certain end of the window. It combines the smoothed position's
/// covariance and the bound on the time-correlated error. For heights alone (Axes 1), it is half
/// the width of the interval that holds the true height with that probability.
template <int Axes>
double position_r95_m(const Chain<Axes>& smoothed, EpochPair window, const ErrorBound& bound);

/// Standard deviation (m) of the bounded error with this correlation time: `bound.sigma_m`, or that
/// of an error that wanders as fast as the fitted one.
double sigma_at(const ErrorBound& bound, double tau_s);

/// A window of an arc with estimated states.
template <int Axes>
struct EstimatedWindow {
    std::span<const ArcEpoch<Axes>> epochs;  ///< of the arc
    const Chain<Axes>& smoothed;             ///< estimated from `epochs` with `model`
    const EstimationModel& model;
    EpochPair window;  ///< indices into the epochs
    double duration_s = 0.0;
};

/// Sensitivity of a window's speed to each measured position (1/s), one for each epoch of the arc.
template <int Axes>
using SpeedWeights = std::vector<PositionVector<Axes>>;
template <int Axes>
SpeedWeights<Axes> speed_weights(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity);

/// Largest variance (m^2/s^2) that a bounded error of the positions leaves in a speed of these
/// weights. The error of each axis is a stationary Gauss-Markov process: the most adverse of the
/// interval's correlation times is taken, for each axis by itself, and the axes are added.
///
/// A variance is linear in the error's covariance. No mixture of such processes therefore leaves
/// more. Neither is it above (sigma sum|w|)^2, which assumes nothing about correlation.
template <int Axes>
double largest_correlated_variance(std::span<const ArcEpoch<Axes>> epochs,
                                   const SpeedWeights<Axes>& weights, const ErrorBound& bound);

/// Standard uncertainties of a window's speed from its positions, by source (m/s). Their squares
/// sum to that of the total.
struct PositionSpeed {
    SpeedEstimate speed;          ///< by the requested definition
    double displacement_m = 0.0;  ///< between the window's ends
    double white_m_s = 0.0;       ///< white noise of the positions
    double correlated_m_s = 0.0;  ///< the time-correlated error
    double motion_m_s = 0.0;      ///< motion of the craft between measurements
    double model_m_s = 0.0;       ///< half width from the choice of the motion model
};

/// The estimated speed, and its uncertainty with the time-correlated error bounded. The estimate is
/// a sum of the measured positions times `weights`. So are its errors from the positions' errors,
/// whatever model the weights come from. The remainder of the estimate's own variance is that of
/// the motion.
template <int Axes>
PositionSpeed speed_by_positions(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                                 const SpeedWeights<Axes>& weights, const ErrorBound& bound);

/// Other estimates of the window's speed, and their differences from that `measured`.
template <int Axes>
OtherEstimates other_estimates(const EstimatedWindow<Axes>& at, const SpeedQuantity& quantity,
                               const SpeedWeights<Axes>& weights, const PositionSpeed& measured);

/// The window's speed over all models of the posterior: the mean, with an uncertainty that includes
/// the models' own and their differences.
template <int Axes>
FittedSpeed fitted_speed(const WindowStretch<Axes>& stretch,
                         const std::vector<WeightedModel>& models, const SpeedQuantity& quantity);

}  // namespace runcert
