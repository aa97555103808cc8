#pragma once

#include <string>

#include "core/figures.h"
#include "schemas/windows/windows.h"

// The largest errors that the tests may have missed, in words.

namespace runcert {

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
