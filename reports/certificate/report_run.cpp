#include "reports/certificate/report_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <future>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_json.h"
#include "store/atomic_file.h"

namespace runcert {

using Json = nlohmann::ordered_json;

namespace {

/// A page of other parts would call itself altered.
void require_own_page(const Json& predicate, const std::string& where) {
    if (predicate["page"] == page_parts_json()) return;
    throw Failure(
        where,
        fmt::format("its pages are of other parts than those of this program: it was "
                    "made by runcert {}, source {}",
                    escape_for_message(predicate["program"]["version"].get<std::string>()),
                    escape_for_message(predicate["program"]["source_revision"].get<std::string>())),
        "Make its pages with that program");
}

}  // namespace

std::string write_report_json(ReportInputs inputs) {
    return report_text_of(report_json(std::move(inputs)));
}

Rendering::Rendering(const std::vector<std::string>& pages) {
    const auto is_wanted = [&pages](const char* page) {
        return std::ranges::find(pages, page) != pages.end();
    };
    html_ = is_wanted("report.html");
    if (is_wanted("certificate.pdf")) certificate_.emplace();
    if (is_wanted("report.pdf")) whole_.emplace();
}

void Rendering::write(const std::filesystem::path& run_folder, const std::string& report_text,
                      const RenderOptions& options) {
    const std::string where = (run_folder / "report.json").string();
    const Json report = parse_report(report_text, where);
    require_own_page(report["predicate"], where);
    const auto write_pdf = [&](std::optional<PdfMaking>& making, const char* name,
                               bool first_page_alone) {
        if (!making) return;
        const std::string page = report_print_page(report_text, report, options.signatures,
                                                   options.standing, first_page_alone);
        write_file_atomically(run_folder / name, making->pdf(page, report_text));
    };
    std::future<void> whole =
        std::async(std::launch::async, write_pdf, std::ref(whole_), "report.pdf", false);
    if (html_)
        write_file_atomically(
            run_folder / "report.html",
            report_page(report_text, report, options.signatures, options.standing));
    write_pdf(certificate_, "certificate.pdf", true);
    whole.get();
}

}  // namespace runcert
