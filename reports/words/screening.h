#pragma once

#include <string>

#include "core/figures.h"
#include "schemas/screened/screened.h"
#include "schemas/windows/windows.h"

// What screening found, as report and audit say it: without a capital and a full stop, to be put
// after a label or into a sentence.

namespace runcert {

/// "of 1,000 recordings without an outlier at most one would have anything marked, by all 4,212
/// tests together"; "not stated" where no rate is.
std::string false_alarm_text(const ScreeningBasis& basis);

/// "horizontally: errors from epoch to epoch 0.98 times the stated standard deviation (601 epochs;
/// as stated)". A time-correlated error is not in it.
std::string fix_type_errors_text(const FixTypeErrors& errors);

/// "0.120 s ± 0.004 s behind the positions, which is allowed for; compared at 601 epochs, they
/// differ by 0.031 m/s and contradict 2"; says so where nothing could be
/// compared, where they are of other moments, and where they are no source of a speed.
std::string velocity_comparison_text(const VelocityComparison& velocity);

/// "18 of 600 positions recorded in motion repeat the one before, 4 lie on a line or curve
/// through others to the last digit; chance makes 0.1".
std::string device_signs_text(const DeviceSigns& device);

/// What is wrong with the time stamp at an epoch: "0.300 s missing".
std::string time_fault_text(const TimeFault& fault);

/// "“mast”: antennas 1.204 m apart, standard deviation 0.006 m over 601 epochs; contradicted at 3".
std::string baseline_comparison_text(const BaselineComparison& baseline);

/// "601 compared, none beside it; median +0.012 m, scatter 0.021 m; 3 contradicted; an error of
/// 0.41 m is found with a probability of 0.8".
std::string surface_text(const SurfaceComparison& surface);

}  // namespace runcert
