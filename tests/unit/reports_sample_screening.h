#pragma once

#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"

// What screening would have said of the made-up run of reports_sample.h.

namespace runcert::sample {

inline ScreeningBasis basis(bool vertical) {
    ScreeningBasis basis;
    basis.family_false_alarm_rate = 0.001;
    basis.tests = 30668;
    basis.test_size = 0.001 / 30668.0;
    basis.power = 0.8;
    basis.burst_epochs_max = 20;
    basis.passes = 2;
    basis.models = {{.axes = TestedAxes::horizontal,
                     .noise = NoiseBasis::fitted,
                     .jerk_density = 0.43,
                     .measurement_scale = 0.951671,
                     .white_scale = 0.97,
                     .error_sigma_m = 0.0,
                     .error_tau_s = 1.0}};
    basis.fix_types = {
        {FixType::fixed, TestedAxes::horizontal, 420, 1.69, AccuracyJudgement::optimistic},
        {FixType::float_ambiguities, TestedAxes::horizontal, 31, 1.0,
         AccuracyJudgement::too_few_epochs}};
    if (vertical) {
        basis.models.push_back(basis.models.front());
        basis.models.back().axes = TestedAxes::vertical;
        basis.models.back().error_sigma_m = 0.0271;
        basis.models.back().error_tau_s = 10.0;
        basis.fix_types.push_back(
            {FixType::fixed, TestedAxes::vertical, 420, 1.0404, AccuracyJudgement::as_stated});
    }
    basis.velocity = {.compared = 437,
                      .delay_s = 0.1024,
                      .sigma_delay_s = 0.0021,
                      .scale_m_s = 0.031,
                      .rejected = 0};
    basis.time.jitter_s = 2.1e-5;
    basis.limits = {.acceleration_max_m_s2 = 15.0,
                    .jerk_max_m_s3 = 30.0,
                    .vertical_rate_max_m_s = 5.0,
                    .acceleration_m_s2 = 8.71,
                    .jerk_m_s3 = 2.04,
                    .vertical_rate_m_s = 0.11,
                    .rejected = 0};
    return basis;
}

/// Largest first. Row "d" of the budget is the step's 0.000693 m/s over the root of three.
inline std::vector<UndetectedError> reliability() {
    return {{Hypothesis::ramp, 375, 375, 0.0123, "m / s", 0.004321},
            {Hypothesis::step, 396, 396, 0.0352, "m", 0.000693},
            {Hypothesis::burst, 401, 409, 0.0414, "m", 0.000612},
            {Hypothesis::outlier, 403, 403, 0.0587, "m", 0.000405},
            {Hypothesis::time_shift, 1, 1, 0.0, "s", 0.0}};
}

}  // namespace runcert::sample
