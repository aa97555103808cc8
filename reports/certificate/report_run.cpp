#include "reports/certificate/report_run.h"

#include "files/atomic_file.h"
#include "reports/certificate/figures.h"
#include "reports/certificate/json_text.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_pdf.h"

namespace runcert {

std::string write_report_json(const ReportInputs& inputs) {
    return report_text_of(report_json(inputs));
}

void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options) {
    const auto report = parse_report(report_text, (run_folder / "report.json").string());
    const std::vector<std::string> drawings = draw_figures(report["predicate"]);
    const std::string on_paper = report_print_page(report, drawings, options.signatures);
    write_file_atomically(run_folder / "report.html",
                          report_page(report_text, report, drawings, options.signatures));
    if (options.pdf)
        write_file_atomically(run_folder / "report.pdf", report_pdf(on_paper, report_text));
}

}  // namespace runcert
