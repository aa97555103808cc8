#pragma once

#include <string>
#include <string_view>

#include "schemas/common/header.h"

namespace runcert {

/// What an audit needs of report.json.
struct ReportRecord {
    Header header;  ///< program, source revision; the subjects as inputs
    std::string id;
};

/// Reads it. Failure where the text is not a measurement report.
ReportRecord read_report_record(std::string_view text, const std::string& where);

}  // namespace runcert
