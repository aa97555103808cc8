#include "reports/certificate/report_pdf.h"

#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/process.h"

namespace runcert {

std::string report_pdf(const std::string& html, const std::string& report_text) {
    const TemporaryFolder folder;
    const std::filesystem::path page = folder.path() / "report.html";
    const std::filesystem::path pdf = folder.path() / "report.pdf";
    const std::filesystem::path attachment = folder.path() / "report.json";
    write_file_atomically(page, html);
    write_file_atomically(attachment, report_text);
    // WeasyPrint writes the time of making into the file unless it is told another.
    const ProcessResult result = run_process(
        {"weasyprint", "--quiet", "--encoding", "utf-8", "--attachment", attachment.string(),
         page.string(), pdf.string()},
        {.environment = {{"SOURCE_DATE_EPOCH", "0"}, {"LC_ALL", "C.UTF-8"}, {"TZ", "UTC"}}});
    if (result.exit_status != 0 || !std::filesystem::exists(pdf)) {
        // Of a traceback, the last line says what was wrong.
        const std::string_view said = trim(result.errors);
        const std::string_view reason = said.substr(said.find_last_of('\n') + 1);
        throw Failure("weasyprint",
                      fmt::format("the PDF could not be made (exit status {}): {}",
                                  result.exit_status, escape_for_message(reason, 500)),
                      "Install the package weasyprint, or leave the PDF out with --no-render");
    }
    return read_file(pdf);
}

}  // namespace runcert
