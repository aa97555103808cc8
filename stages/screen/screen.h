#pragma once

#include <set>

#include "estimation/motion_model.h"
#include "schemas/attempt/attempt.h"
#include "schemas/screened/screened.h"

namespace runcert {

/// The figures of screening; `schemas/attempt/v1.yaml` describes them under `parameters.screen`.
struct ScreenConfig {
    std::set<FixKind> allowed_fixes;
    double accuracy_min_m = 0.0;
    double accuracy_max_m = 0.0;
    double gap_factor = 0.0;
    double false_alarm_rate = 0.0;
    std::int64_t restart_after = 0;
    std::int64_t min_arc_epochs = 0;
    EstimationModel model;
};

ScreenConfig screen_config(const Attempt& attempt);

/// Marks the epochs that may not take part in the estimate, and cuts the rest into arcs.
///
/// First each epoch by itself: position, kind of solution, time, stated accuracy; then gaps; then
/// the chi-squared test of the innovations of a forward Kalman filter through each arc, the stated
/// covariances multiplied by a robust variance factor of the recording. `restart_after` rejections
/// in a row are a break: the arc ends before the first of them and a new one begins with it. No
/// row is removed. The header is the caller's.
ScreenedTable screen(const EnuTable& table, const ScreenConfig& config);

}  // namespace runcert
