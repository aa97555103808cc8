#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/certificate/report_html.h"

namespace runcert {

/// The bytes of report.json, which are what gets signed.
std::string write_report_json(const ReportInputs& inputs);

struct RenderOptions {
    std::vector<SignatureText> signatures;  ///< none: every page says UNSIGNED
    std::string standing = "{}\n";          ///< the text of a standing_json
    bool pdf = true;
};

/// Writes report.html and report.pdf into the run folder, from the bytes of report.json, its
/// signatures and its standing alone, so that anyone can make them again from what was signed.
void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options = {});

}  // namespace runcert
