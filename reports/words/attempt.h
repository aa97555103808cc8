#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/gps_time.h"
#include "schemas/attempt/declared.h"
#include "schemas/common/window_span.h"

// What an attempt states, in words.

namespace runcert {

/// "The decision rule was agreed on 2026-03-01 by the board and the team."; where that day is after
/// the window, that it is; without an agreement, that none is stated.
std::string agreement_text(const std::optional<DecisionRuleAgreement>& agreed,
                           const std::optional<WindowSpan>& window);

/// "certificate 4711 of 2026-02-03 by Laboratory; expanded uncertainty of speed 0.05 km/h (k = 2)".
std::string calibration_text(const Calibration& calibration);

/// "measurer: Ann, judge".
std::string officials_text(const std::vector<Official>& officials);

}  // namespace runcert
