#pragma once

#include <nlohmann/json.hpp>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The signatures that the report needs: those of its rules and of its attempt, for each role the
/// largest count.
nlohmann::ordered_json signatures_required_json(const ReportInputs& inputs);

/// What every certificate of a measurement says (ISO/IEC 17025:2017 7.8.2), in the words of PTB's
/// Digital Calibration Certificate where it has one (https://www.ptb.de/dcc/).
nlohmann::ordered_json certificate_json(const ReportInputs& inputs, const std::string& report_id);

/// The report that this one replaces; null where there is none.
nlohmann::ordered_json amends_json(const Attempt& attempt);

}  // namespace runcert
