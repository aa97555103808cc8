#include "reports/report_run.h"

#include "files/atomic_file.h"
#include "reports/figures.h"
#include "reports/report_json.h"
#include "reports/report_pdf.h"

namespace runcert {

std::string write_report_json(const ReportInputs& inputs) {
    return report_text_of(report_json(inputs));
}

void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options) {
    const auto report = parse_report(report_text, (run_folder / "report.json").string());
    const std::string html =
        report_html(report, draw_figures(run_folder, report["predicate"]), options.signers);
    write_file_atomically(run_folder / "report.html", html);
    if (options.pdf) write_file_atomically(run_folder / "report.pdf", report_pdf(html));
}

}  // namespace runcert
