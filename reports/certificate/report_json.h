#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"

namespace runcert {

/// The measurement report: an in-toto Statement v1 (https://in-toto.io/Statement/v1) whose
/// predicate, `reports/certificate/v1.yaml`, holds everything that the HTML and the PDF show. The
/// same inputs give the same report: no clock, host, user or path is in it. Failure where the
/// inputs do not belong together, and where the predicate deviates from its field table.
nlohmann::ordered_json report_json(ReportInputs inputs);

/// Reads a report.json. `where` names it in messages. Failure where it is not JSON, not a report,
/// or of a version that this program does not read.
nlohmann::ordered_json parse_report(const std::string& text, const std::string& where);

/// The name of a set of files: the first 16 hexadecimal digits of the SHA-256 of one line
/// "HASH  NAME" for each, as `sha256sum` prints them.
std::string report_id(const std::vector<InputFile>& subjects);

/// The bytes of report.json: UTF-8, indented by 2, lists of numbers on one line, a line end at its
/// end; `<`, `>` and `&` as escapes, so that the text can stand in a page as it is.
std::string report_text_of(const nlohmann::ordered_json& report);

}  // namespace runcert
