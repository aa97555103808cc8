#pragma once

#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"

// What screening would have said of the made-up run of reports_sample.h.

namespace runcert::sample {

inline ScreeningEvidence evidence(bool vertical) {
    ScreeningEvidence evidence;
    evidence.family_false_alarm_rate = 0.001;
    evidence.tests = 30668;
    evidence.test_size = 0.001 / 30668.0;
    evidence.power = 0.8;
    evidence.burst_epochs_max = 20;
    evidence.passes = 2;
    evidence.models = {{.axes = TestedAxes::horizontal,
                        .noise = NoiseBasis::fitted,
                        .jerk_density = 0.43,
                        .measurement_scale = 0.951671,
                        .white_scale = 0.97,
                        .error_sigma_m = 0.0,
                        .error_tau_s = 1.0}};
    evidence.fix_kinds = {
        {FixKind::fixed, TestedAxes::horizontal, 420, 1.69, AccuracyJudgement::too_good},
        {FixKind::float_ambiguities, TestedAxes::horizontal, 31, 1.0,
         AccuracyJudgement::too_few_epochs}};
    if (vertical) {
        evidence.models.push_back(evidence.models.front());
        evidence.models.back().axes = TestedAxes::vertical;
        evidence.models.back().error_sigma_m = 0.0271;
        evidence.models.back().error_tau_s = 10.0;
        evidence.fix_kinds.push_back(
            {FixKind::fixed, TestedAxes::vertical, 420, 1.0404, AccuracyJudgement::as_stated});
    }
    evidence.velocity = {.compared = 437,
                         .delay_s = 0.1024,
                         .sigma_delay_s = 0.0021,
                         .scale_mps = 0.031,
                         .rejected = 0};
    evidence.time.jitter_s = 2.1e-5;
    evidence.limits = {.acceleration_max_mps2 = 15.0,
                       .jerk_max_mps3 = 30.0,
                       .vertical_rate_max_mps = 5.0,
                       .acceleration_mps2 = 8.71,
                       .jerk_mps3 = 2.04,
                       .vertical_rate_mps = 0.11,
                       .rejected = 0};
    return evidence;
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
