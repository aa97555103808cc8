#pragma once

#include <string>

namespace runcert {

/// The page on A4 paper, as the bytes of a PDF file, by WeasyPrint, with `report_text` attached as
/// report.json; the same page gives the same bytes. Failure where WeasyPrint is missing or fails.
std::string report_pdf(const std::string& html, const std::string& report_text);

}  // namespace runcert
