#pragma once

#include "estimation/motion_model.h"
#include "stages/screen/screen.h"

namespace runcert {

/// The noise that the tests rest on, and what screening says of it. Jerk densities in m s^-2.5,
/// the time-correlated error in m and s, scales in units of the stated standard deviations.
struct ScreeningNoise {
    EstimationModel model;   ///< what the tests take it to be
    EstimationModel fitted;  ///< what the recording shows
    ScreeningModel summary;
};

/// Estimates it from the epochs that a first look at the rows leaves: a forward innovation test
/// with the class's motion and the stated standard deviations times a robust factor, whose only use
/// is to keep gross errors out of the fit. The jerk density is the larger of the class's and the
/// fitted one: what the craft can do must not be taken for an error because it did not do it for
/// long. Nor is the white noise taken to be less than a fraction of what is stated: where a
/// receiver has filtered its positions they follow one another more smoothly than they are
/// accurate, and the tests would find the model of motion wrong, not the positions. (Only where
/// velocities are recorded, which then settle what seem to be drifts.) Fitted to at most 3,000
/// epochs, in stretches over the whole recording, so that it costs the same for a long one. Figures
/// are rounded to the decimals of the file.
///
/// Noise is not fitted where `config.noise` is not fitted or the fit does not succeed. The model is
/// then the class's jerk density and the stated standard deviations times a robust factor. That
/// factor is the root of the median innovation statistic over the median of chi squared with Axes
/// degrees of freedom, and at least 1.
///
/// Axes is 2 for east and north of the local frame, 1 for heights. The smallest fraction of the
/// stated noise is `config.noise_scale_min`. Figures have 6 decimals.
template <int Axes>
ScreeningNoise estimate_screening_noise(const ScreenedTable& first_look,
                                        const ScreenConfig& config);

}  // namespace runcert
