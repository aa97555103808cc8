#pragma once

#include "motion/motion_model.h"
#include "stages/screen/screen.h"

namespace runcert {

/// The noise behind the tests, and screening's summary of it. Jerk densities are in m s^-2.5, the
/// time-correlated error in m and s, scales in units of the stated standard deviations.
struct ScreeningNoise {
    EstimationModel model;   ///< used by the tests
    EstimationModel fitted;  ///< fitted to the recording
    ScreeningModel summary;
};

/// Estimates the noise from the epochs that remain after a first look: a forward innovation test
/// with the motion of the craft's class and the stated standard deviations times a robust factor.
/// Its only purpose is to keep gross errors out of the fit.
///
/// The jerk density is the larger of the class's and the fitted one. What the craft can do must not
/// count as an error because it rarely did it. The white noise is not taken below a fraction of
/// what is stated, `config.noise_scale_min`. Positions that a receiver has filtered are smoother
/// than they are accurate, and the tests would reject the motion model, not the positions. This
/// holds only where velocities are recorded, which then decide about apparent drifts.
///
/// At most 3,000 epochs are fitted, in stretches over the whole recording, so that long recordings
/// cost no more. Figures are rounded to the decimals of the file, 6.
///
/// The noise is not fitted where `config.noise` does not ask for it or the fit fails. The model is
/// then the class's jerk density and the stated standard deviations times a robust factor. That
/// factor is the square root of the median innovation statistic over the median of chi squared with
/// Axes degrees of freedom, and at least 1.
///
/// Axes is 2 for east and north of the local frame, and 1 for heights.
template <int Axes>
ScreeningNoise estimate_screening_noise(const ScreenedTable& first_look,
                                        const ScreenConfig& config);

}  // namespace runcert
