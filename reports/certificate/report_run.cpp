#include "reports/certificate/report_run.h"

#include <fmt/format.h>

#include <algorithm>
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

void render_report(const std::filesystem::path& run_folder, const std::string& report_text,
                   const RenderOptions& options) {
    const std::string where = (run_folder / "report.json").string();
    const Json report = parse_report(report_text, where);
    require_own_page(report["predicate"], where);
    const auto is_wanted = [&](const char* page) {
        return std::ranges::find(options.pages, page) != options.pages.end();
    };
    const auto write_pdf = [&](const char* name, bool first_page_alone) {
        if (!is_wanted(name)) return;
        const std::string page = report_print_page(report_text, report, options.signatures,
                                                   options.standing, first_page_alone);
        write_file_atomically(run_folder / name, report_pdf(page, report_text));
    };
    std::future<void> whole = std::async(std::launch::async, write_pdf, "report.pdf", false);
    if (is_wanted("report.html"))
        write_file_atomically(
            run_folder / "report.html",
            report_page(report_text, report, options.signatures, options.standing));
    write_pdf("certificate.pdf", true);
    whole.get();
}

}  // namespace runcert
