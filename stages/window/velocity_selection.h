#pragma once

#include <vector>

#include "schemas/common/table.h"
#include "stages/window/best_window.h"

namespace runcert {

/// Errors of recorded speeds that differ between windows, as they are drawn: white noise of each
/// sample; a brief error, of which the chosen window's mean has this standard deviation; and a slow
/// one, with any correlation time from 5 s to 60 s. What is the same all over a session moves no
/// window against another, and is none of them.
struct DrawnSpeedErrors {
    double white_m_s = 0.0;  ///< of one sample
    double brief_m_s = 0.0;  ///< of the mean of the chosen window
    double slow_m_s = 0.0;
};

/// What choosing the fastest of windows adds to its recorded speed, m/s: with white noise alone,
/// and with all errors.
struct SpeedChoiceBias {
    std::int64_t candidates = 1;
    double least_m_s = 0.0;
    double most_m_s = 0.0;
    double uncertainty_m_s = 0.0;  ///< standard uncertainty of either, from the number of draws
};

/// How a window's speed is made of its samples.
enum class MeanOf { samples, samples_after_first, path };

/// The windows whose assured speed is at most `reach_m_s` below that of the chosen one are searched
/// again and again, with errors drawn onto their recorded speeds. These hold errors of their own,
/// which part the windows and make the answer too small: the same is done with speeds onto which
/// errors were drawn before, and the difference put on ([ET93] 18, as `selection_bias` has it).
///
/// `times` are those of each series' samples. Of long windows fewer draws than `samples` are made,
/// at least 100 where so many are asked for: their means hardly differ. The same `seed` gives the
/// same answer, whatever the number of threads. `most_m_s` is not below `least_m_s`, nor this
/// below 0.
SpeedChoiceBias speed_choice_bias(const std::vector<std::vector<ElapsedTime>>& times,
                                  const std::vector<FoundWindow>& all, const FoundWindow& chosen,
                                  MeanOf mean_of, const DrawnSpeedErrors& errors, double reach_m_s,
                                  std::int64_t samples, std::int64_t seed);

/// Standard deviation of the mean of so many samples, a step apart, of a first-order Gauss-Markov
/// process of variance 1.
double gauss_markov_mean_sd(std::size_t samples, double step_s, double tau_s);

}  // namespace runcert
