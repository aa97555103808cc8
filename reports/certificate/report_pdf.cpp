#include <fmt/format.h>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_run.h"
#include "store/atomic_file.h"
#include "store/external_program.h"

namespace runcert {
namespace {

/// The PDF with the dates of what is attached to it set to 1970. WeasyPrint 62 takes them from the
/// clock whatever SOURCE_DATE_EPOCH says, and the same report must give the same bytes.
std::string without_dates(std::string pdf) {
    constexpr std::string_view epoch = "19700101000000Z";
    for (const std::string_view key : {"/CreationDate (D:", "/ModDate (D:"})
        for (std::size_t at = pdf.find(key); at != std::string::npos; at = pdf.find(key, at)) {
            at += key.size();
            if (pdf.find(')', at) == at + epoch.size()) pdf.replace(at, epoch.size(), epoch);
        }
    return pdf;
}

}  // namespace

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
    return without_dates(read_file(pdf));
}

}  // namespace runcert
