#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_run.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert {

std::string report_pdf(const std::string& html, const std::string& report_text) {
    const TemporaryFolder folder;
    const std::filesystem::path pdf = folder.path() / "report.pdf";
    write_file_atomically(folder.path() / "report.html", html);
    write_file_atomically(folder.path() / "report.json", report_text);
    // Tagged, for those who have it read to them: WeasyPrint 57 takes one variant of PDF, so that
    // PDF/A, for archives, is not to be had beside it. It writes the time of making into the file
    // unless it is told another.
    const ExternalCall call{
        .command = {"weasyprint", "--quiet", "--encoding", "utf-8", "--pdf-variant", "pdf/ua-1",
                    "--attachment", "report.json", "report.html", "report.pdf"},
        .folder = folder.path(),
        .environment = {{"SOURCE_DATE_EPOCH", "0"}}};
    ProcessResult result = run_external(call);
    if (result.exit_status != 0 || !std::filesystem::exists(pdf)) {
        // Of a traceback, the last line says what was wrong.
        const std::string_view said = trim(result.errors);
        result.errors = said.substr(said.find_last_of('\n') + 1);
        throw Failure(
            "weasyprint",
            fmt::format("the PDF could not be made: {}", external_problem(call, result)),
            "Install the package weasyprint again, or leave the PDF out with --no-render");
    }
    return read_file(pdf);
}

}  // namespace runcert
