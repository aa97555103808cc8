#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"

// The values of a report's predicate (`v1.yaml`), which `report_json` puts together. Figures are in
// full; how they are read is for its document.

namespace runcert {

using Json = nlohmann::ordered_json;

/// The signatures that its rules and its attempt require, for each role the largest count.
Json signatures_required_json(const ReportInputs& inputs);
/// What every certificate of a measurement says (ISO/IEC 17025:2017 7.8.2), in the words of PTB's
/// Digital Calibration Certificate where it has one (https://www.ptb.de/dcc/).
Json certificate_json(const ReportInputs& inputs, const std::string& report_id);
/// The report that this one replaces; null where there is none.
Json amends_json(const Attempt& attempt);

}  // namespace runcert
