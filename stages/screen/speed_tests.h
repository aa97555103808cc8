#pragma once

#include "schemas/screened/screened.h"
#include "stages/screen/screen.h"
#include "stages/screen/test_plan.h"

namespace runcert {

/// Tests the recorded speeds against one another, as positions are tested: every sample for an
/// outlier, bursts and steps (`adapt`), with the accuracy that the sample states and the jerk
/// density of the positions' motion (m s^-2.5). Horizontally it is the length of the velocity, or
/// the recorded speed; vertically the rate. Marks the samples that no rule may use
/// (`ScreenedEpoch::speed_test`), positions stay as they are. Returns what was found on each of the
/// two that is recorded at 30 epochs or more and changes.
///
/// The white noise is that of third differences, and the stated standard deviations only say which
/// samples are worse than others. A change of acceleration is motion up to
/// `config.limits.acceleration_m_s2`. Both samples beside a step are refused, and those up to the
/// step back, if that comes within half a minute.
std::vector<SpeedScreening> screen_speeds(std::vector<ScreenedEpoch>& rows, const TestPlan& plan,
                                          double jerk_density, const ScreenConfig& config,
                                          double nominal_interval_s);

}  // namespace runcert
