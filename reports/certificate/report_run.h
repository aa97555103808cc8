#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/certificate/report_html.h"
#include "schemas/common/product_files.h"

namespace runcert {

/// The bytes of report.json, which are what gets signed.
std::string write_report_json(ReportInputs inputs);

struct RenderOptions {
    std::vector<SignatureFile> signatures;  ///< none: every page says UNSIGNED
    std::string standing = "{}\n";          ///< the text of a standing_json
    /// Which of `page_names` are written; certificate.pdf is the first page of report.pdf.
    std::vector<std::string> pages = {page_names.begin(), page_names.end()};
};

/// Writes report.html, certificate.pdf and report.pdf into the run folder, from the bytes of
/// report.json, its signatures and its standing alone, so that anyone can make them again from what
/// was signed. Failure where the report was made by a program whose pages have other parts.
void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options = {});

/// The page on A4 paper, as the bytes of a PDF file, by WeasyPrint, with `report_text` attached as
/// report.json; the same page gives the same bytes. Failure where WeasyPrint is missing or fails.
std::string report_pdf(const std::string& html, const std::string& report_text);

}  // namespace runcert
