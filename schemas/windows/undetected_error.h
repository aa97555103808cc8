#pragma once

#include <string>

#include "schemas/windows/windows.h"

// The largest errors that the tests may have missed, in words.

namespace runcert {

/// An error that the tests look for: "outlier of one epoch", "step of the positions".
std::string tested_error_text(Hypothesis hypothesis);

/// Where one is: "at epoch 812", "before epoch 812", "from epoch 812 on", "at epochs 812 to 815".
std::string where_text(const UndetectedError& error);

/// Whether no such error could have changed the speed; whether that has no limit.
bool is_harmless(const UndetectedError& error);
bool is_unlimited(const UndetectedError& error);

/// "0.10 m", "0.53 m/s".
std::string size_text(const UndetectedError& error);

}  // namespace runcert
