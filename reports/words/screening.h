#pragma once

#include <string>

#include "reports/words/figures.h"
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

/// "43 s behind", "0.12 s ahead of".
std::string delay_words(double delay_s);

/// "over epochs 71 to 375 they are 43 s behind the positions (the speeds differ by 6.27 m/s, at
/// that delay by 0.30 m/s)": where recorded velocities have a delay that is not taken off, if so.
std::string other_moments_text(const VelocityComparison& velocity);

/// "they contradict the positions at 96 % of the epochs"; empty where they are fit for a speed.
std::string unfit_text(const VelocityComparison& velocity);

/// "0.120 s ± 0.004 s behind the positions, which is allowed for; compared at 601 epochs, they
/// differ by 0.031 m/s and contradict 2"; says so where nothing could be
/// compared, where they are of other moments, and where they are no source of a speed.
std::string velocity_comparison_text(const VelocityComparison& velocity);

/// "18 of 600 positions recorded in motion repeat the one before, 4 lie in line with their
/// neighbours to the last digit; chance makes 0.1".
std::string device_signs_text(const DeviceSigns& device);

/// What is wrong with the time stamp at an epoch: "0.300 s missing".
std::string time_fault_text(const TimeFault& fault);

/// "“mast”: antennas 1.204 m apart, standard deviation 0.006 m over 601 epochs; contradicted at 3".
std::string baseline_comparison_text(const BaselineComparison& baseline);

/// "601 compared, none beside it; median +0.012 m, scatter 0.021 m; 3 contradicted; an error of
/// 0.41 m is found with a probability of 0.8".
std::string surface_text(const SurfaceComparison& surface);

/// "Carrier phases of the receiver's raw signals: over 3 s they differ by 0.012 m per axis (57
/// spans) and contradict 2 epochs", without its end.
std::string displacement_comparison_text(const DisplacementComparison& comparison);

/// An error that the tests look for: "outlier of one epoch", "step of the positions".
std::string tested_error_text(Hypothesis hypothesis);

/// Where one is: "at epoch 812", "before epoch 812", "from epoch 812 on", "at epochs 812 to 815".
std::string where_text(const UndetectedError& error);

/// "an undetected step of the positions of 0.10 m (before epoch 812) could have changed the speed
/// by at most 0.123 km/h; a larger one is found with a probability of more than 0.8". `power` is
/// that of the tests; says so where the size has no limit, or where no error matters.
std::string undetected_error_text(const UndetectedError& error, double power,
                                  const SpeedUnit& unit);

/// Whether no such error could have changed the speed; whether that has no limit.
bool is_harmless(const UndetectedError& error);
bool is_unlimited(const UndetectedError& error);

/// "0.10 m", "0.53 m/s".
std::string size_text(const UndetectedError& error);

}  // namespace runcert
