#include "reports/certificate/report_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_json.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/verification.h"

namespace runcert {

using Json = nlohmann::ordered_json;

std::string write_report_json(ReportInputs inputs) {
    return report_text_of(report_json(std::move(inputs)));
}

namespace {

std::vector<std::string> read_drawings(const std::filesystem::path& folder, const Json& predicate) {
    std::vector<std::string> drawings(predicate["figures"].size(), "<svg></svg>");
    for (std::size_t i = 0; i < drawings.size(); ++i)
        if (const auto file = folder / drawing_file_name(i); std::filesystem::exists(file))
            drawings[i] = read_file(file);
    return drawings;
}

/// A page of other parts, or with other drawings, would call itself altered.
void require_own_page(const Json& predicate, const std::vector<std::string>& drawings,
                      const std::string& where) {
    Json parts = predicate["page"];
    parts.erase("drawn_by_sha256");
    if (parts != page_parts_json())
        throw Failure(
            where,
            fmt::format(
                "its pages are of other parts than those of this program: it was "
                "made by runcert {}, source {}",
                escape_for_message(predicate["program"]["version"].get<std::string>()),
                escape_for_message(predicate["program"]["source_revision"].get<std::string>())),
            "Make its pages with that program");
    for (std::size_t i = 0; i < drawings.size(); ++i)
        if (predicate["figures"][i]["drawing_sha256"] != sha256_hex(drawings[i]))
            throw Failure(where,
                          fmt::format("the drawing of figure {} comes out other than the report "
                                      "names it, as another version of gnuplot makes it",
                                      i + 1),
                          "Make its pages on the computer that made the report");
}

}  // namespace

void write_drawings(const std::filesystem::path& folder, const std::string& report_text) {
    const auto report = parse_report(report_text, (folder / "report.json").string());
    const std::vector<std::string> drawings = draw_figures(report["predicate"]);
    for (std::size_t i = 0; i < drawings.size(); ++i)
        write_file_atomically(folder / drawing_file_name(i), drawings[i]);
}

void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options) {
    const auto report = parse_report(report_text, (run_folder / "report.json").string());
    const bool draws = options.drawings.empty();
    const std::vector<std::string> drawings =
        draws ? draw_figures(report["predicate"])
              : read_drawings(options.drawings, report["predicate"]);
    require_own_page(report["predicate"], draws ? drawings : std::vector<std::string>(),
                     (run_folder / "report.json").string());
    const std::string on_paper = report_print_page(
        report_text, report, drawings, options.signatures, options.standing, options.brief);
    write_file_atomically(
        run_folder / "report.html",
        report_page(report_text, report, drawings, options.signatures, options.standing));
    if (options.pdf)
        write_file_atomically(run_folder / "report.pdf", report_pdf(on_paper, report_text));
}

}  // namespace runcert
