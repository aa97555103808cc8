#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "reports/certificate/report_data.h"
#include "reports/certificate/report_html.h"

namespace runcert {

/// The bytes of report.json, which are what gets signed.
std::string write_report_json(ReportInputs inputs);

struct RenderOptions {
    std::vector<SignatureFile> signatures;  ///< none: every page says UNSIGNED
    std::string standing = "{}\n";          ///< the text of a standing_json
    bool pdf = true;
    bool brief = false;  ///< of the PDF the first page alone
    /// A folder of drawings, as `write_drawings` names them, whose hashes were compared with the
    /// report's; empty: they are drawn. Instead of one that is not there an empty one is shown.
    std::filesystem::path drawings = {};
};

/// Draws a report's figures into a folder, "drawing.0.svg" the first. Failure as of `draw_figures`.
void write_drawings(const std::filesystem::path& folder, const std::string& report_text);

/// Writes report.html and report.pdf into the run folder, from the bytes of report.json, its
/// signatures and its standing alone, so that anyone can make them again from what was signed.
void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options = {});

/// The page on A4 paper, as the bytes of a PDF file, by WeasyPrint, with `report_text` attached as
/// report.json; the same page gives the same bytes. Failure where WeasyPrint is missing or fails.
std::string report_pdf(const std::string& html, const std::string& report_text);

/// Draws the figures that a report holds, each as the text of an SVG, with gnuplot and from nothing
/// but the report; empty for a figure whose points the report does not hold. The same report gives
/// the same bytes. Failure where gnuplot is missing or fails.
std::vector<std::string> draw_figures(const nlohmann::ordered_json& predicate);

/// The part of a gnuplot script that draws one of the report's figures into the file named. Texts
/// are quoted, so that none of them is taken for an instruction.
std::string gnuplot_script(const nlohmann::ordered_json& figure, const std::string& svg_file);

}  // namespace runcert
