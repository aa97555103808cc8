#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "reports/certificate/pdf_making.h"
#include "reports/certificate/report_data.h"
#include "reports/certificate/report_html.h"
#include "schemas/common/product_files.h"

namespace runcert {

/// The bytes of report.json, which are what gets signed.
std::string write_report_json(ReportInputs inputs);

struct RenderOptions {
    std::vector<SignatureFile> signatures;  ///< none: every page says UNSIGNED
    std::string standing = "{}\n";          ///< the text of a standing_json
};

/// Pages of a report that are yet to be drawn: what draws them on paper is started at once.
class Rendering {
  public:
    /// `pages`: which of `page_names`; certificate.pdf is the first page of report.pdf.
    explicit Rendering(const std::vector<std::string>& pages = {page_names.begin(),
                                                                page_names.end()});

    /// Writes the pages into the run folder, from the bytes of report.json, its signatures and its
    /// standing alone, so that anyone can make them again from what was signed. To be called once.
    /// Failure where the report was made by a program whose pages have other parts.
    void write(const std::filesystem::path& run_folder, const std::string& report_text,
               const RenderOptions& options = {});

  private:
    bool html_ = false;
    std::optional<PdfMaking> certificate_, whole_;
};

}  // namespace runcert
