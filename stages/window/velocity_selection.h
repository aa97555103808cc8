#pragma once

#include <vector>

#include "schemas/common/table.h"
#include "stages/window/best_window.h"

namespace runcert {

/// Errors of recorded speeds that differ between windows, for drawing. They are white noise of each
/// sample, a brief error with this standard deviation in the mean of the chosen window, and a
/// slowly varying one with any correlation time from 5 s to 60 s. An error that is constant over a
/// session affects all windows alike and is not included.
struct DrawnSpeedErrors {
    double white_m_s = 0.0;  ///< of one sample
    double brief_m_s = 0.0;  ///< of the mean of the chosen window
    double slow_m_s = 0.0;
};

/// The bias of the recorded speed that results from choosing the fastest window, m/s: with white
/// noise alone, and with all errors.
struct SpeedChoiceBias {
    std::int64_t candidates = 1;
    double least_m_s = 0.0;
    double most_m_s = 0.0;
    double uncertainty_m_s = 0.0;  ///< standard uncertainty of either, from the number of draws
};

/// Simulates the choice of the fastest window. Windows whose assured speed is at most `reach_m_s`
/// below that of the chosen one are searched repeatedly, with errors drawn onto their recorded
/// speeds. The recorded speeds already contain errors, which separate the windows and make the
/// result too small. Legs (windows that overlap one another) whose fastest windows differ by no
/// more than errors explain are therefore drawn together before; and the same is done with speeds
/// that have drawn errors already, and the difference is added ([ET93] 18, as in `selection_bias`).
///
/// `times` are those of each series' samples. For long windows fewer draws than `samples` are made,
/// but at least 100 if so many are requested, because their means hardly differ. The same `seed`
/// gives the same result, whatever the number of threads. `most_m_s` is not below `least_m_s`,
/// which is not below 0.
SpeedChoiceBias speed_choice_bias(const std::vector<std::vector<ElapsedTime>>& times,
                                  const std::vector<FoundWindow>& all, const FoundWindow& chosen,
                                  SpeedDefinition definition, const DrawnSpeedErrors& errors,
                                  double reach_m_s, std::int64_t samples, std::int64_t seed);

/// Standard deviation of the mean of `samples` values, one step apart, of a first-order
/// Gauss-Markov process with variance 1.
double gauss_markov_mean_sd(std::size_t samples, double step_s, double tau_s);

}  // namespace runcert
