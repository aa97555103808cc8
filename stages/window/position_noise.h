#pragma once

#include "arcs/noise_models.h"
#include "schemas/profile/profile.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"
#include "stages/window/speed_by_definition.h"

namespace runcert {

/// The size of the slow position error that the certificate allows for: the largest of the fitted
/// one, the stated accuracy times its scale, and the floor of the kinds of solution in the rows
/// `first_row` to `last_row`.
///
/// What the data tell of such an error is how fast it wanders, sigma sqrt(2 / tau): the fitted size
/// is that of the error which wanders as fast with the shortest correlation time of the interval,
/// and whose bounding process therefore bounds the fitted error whatever its correlation time.
/// `standard_uncertainty_mps` is left zero.
ErrorBound error_bound(const ScreenedTable& screened, std::size_t first_row, std::size_t last_row,
                       const NoiseSummary& noise, const Profile::Uncertainty& rule);

/// Radius (m) of the circle that holds the true horizontal position with a probability of 95 %, at
/// the worse of the window's ends ([NAV] R95): the smoothed position's covariance and the bounded
/// slow error's. Nobody knows which side of a bridged step is the true one: at the worse end the
/// position is off by the step's offset, whose length is therefore added in full. (How well the
/// offset itself is known, some millimetres, does not count beside the bound.)
double position_r95_m(const SmoothedArc<2>& smoothed, EpochPair window, const ErrorBound& bound);

/// The noise model of the certificate: motion and white noise as fitted, the slow error bounded.
EstimationModel bounded_model(const NoiseSummary& noise, const ErrorBound& bound);

/// Standard uncertainties of a window's speed from its positions, by source (m/s): their squares
/// add up to that of the whole.
struct PositionNoise {
    SpeedEstimate speed;                  ///< by the definition asked for
    double displacement_m = 0.0;          ///< horizontal, between the window's ends
    double white_mps = 0.0;               ///< white noise of the positions
    double correlated_mps = 0.0;          ///< the slow error
    double motion_mps = 0.0;              ///< what the craft may have done between measurements
    Eigen::Matrix2d velocity_covariance;  ///< of displacement over time, m^2/s^2
};

/// Smooths the stretch with the model and takes the variance apart. The variance is of first degree
/// in the variances of the three noises, and at the optimum its derivative by one of them is that
/// noise's own part, the gains held fixed.
PositionNoise position_noise(const WindowStretch& stretch, const EstimationModel& model,
                             std::string_view definition);

/// The window's speed over all models of the posterior: mean, and the uncertainty that holds the
/// models' own and their differences.
FittedSpeed fitted_speed(const WindowStretch& stretch, const std::vector<WeightedModel>& models,
                         std::string_view definition);

}  // namespace runcert
