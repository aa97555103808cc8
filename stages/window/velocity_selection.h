#pragma once

#include <vector>

#include "schemas/common/table.h"
#include "stages/window/selection.h"

namespace runcert {

/// Errors of recorded speeds that differ between windows, for drawing. They are white noise of each
/// sample, a brief error with this standard deviation in the mean of the chosen window, and a
/// slowly varying one with any correlation time from 5 s to 60 s. An error that is constant over a
/// session affects all windows alike and is not included.
struct DrawnSpeedErrors {
    double white_m_s = 0.0;  ///< of one sample
    double brief_m_s = 0.0;  ///< of the mean of the chosen window
    double slow_m_s = 0.0;
    /// Of the mean of the chosen window: a wider range tells nothing of where the bias is.
    double combined_m_s = std::numeric_limits<double>::infinity();
};

/// The bias (m/s) of choosing the fastest window by recorded speeds, between that under white noise
/// alone (`fitted_bias_m_s`) and that under all errors (`bounded_bias_m_s`). The errors are drawn
/// onto the samples of all windows together, so that a lasting one moves neighbouring legs alike.
///
/// `times` are those of each series' samples. For long windows fewer draws than `samples` are made,
/// but at least 100 if so many are requested, because their means hardly differ. The same `seed`
/// gives the same result, whatever the number of threads.
SelectionBias speed_choice_bias(const std::vector<std::vector<ElapsedTime>>& times,
                                const std::vector<WindowLeg>& legs, SpeedDefinition definition,
                                const DrawnSpeedErrors& errors, std::int64_t samples,
                                std::int64_t seed);

/// Standard deviation of the mean of `samples` values, one step apart, of a first-order
/// Gauss-Markov process with variance 1.
double gauss_markov_mean_sd(std::size_t samples, double step_s, double tau_s);

}  // namespace runcert
