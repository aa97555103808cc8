#pragma once

#include <string>
#include <string_view>

#include "schemas/common/header.h"

namespace runcert {

/// Who made a report, and of what.
struct ReportRecord {
    Header header;  ///< program, source revision; the subjects as inputs
    /// The report's own id, `report_id` of its predicate.
    std::string id;
};

/// Reads it from the text of report.json; `where` names the file in messages. Failure where the
/// text is not a measurement report. Signatures and hashes are not checked.
ReportRecord read_report_record(std::string_view text, const std::string& where);

}  // namespace runcert
