#include <fmt/format.h>

#include <algorithm>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/external_program.h"
#include "trust/bundle_limits.h"
#include "trust/seal.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view script_begin = "<script type=\"application/json\" id=\"report-json\">";
constexpr std::string_view script_end = "</script";
constexpr std::string_view script_id = "id=\"report-json\"";

const char* const render_again = "render the page again from report.json";

/// What a look at one page found.
struct PageFinding {
    bool passed = false;
    bool checked = true;
    std::string words{};
};

std::size_t count_of(std::string_view text, std::string_view part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string_view::npos;
         at = text.find(part, at + part.size()))
        ++count;
    return count;
}

PageFinding check_html(const fs::path& file, const ReportFacts& report) {
    const std::string page = read_file(file);
    const std::size_t begin = page.find(script_begin);
    if (begin == std::string::npos)
        return {.words = fmt::format("it does not carry the report, as pages of an earlier version "
                                     "of the program: {}",
                                     render_again)};
    // A browser would take the first of several, whichever of them is checked here; it ends a
    // comment where this program looks for none.
    const std::string_view before = std::string_view(page).substr(0, begin);
    if (count_of(before, "<!--") > 0 || count_of(before, "<plaintext") > 0)
        return {.words = fmt::format("what it carries stands in a comment: {}", render_again)};
    if (count_of(page, script_id) != 1 || count_of(lower_case(before), "report-json") > 0)
        return {.words = fmt::format("it carries more than one report: {}", render_again)};
    const std::size_t text = begin + script_begin.size();
    const std::size_t end = page.find(script_end, text);
    if (end == std::string::npos || page.compare(text, end - text, report.text) != 0)
        return {.words =
                    fmt::format("the report that it carries is not report.json: {}", render_again)};
    // What ends a script or begins a comment would make a browser read on elsewhere.
    if (report.text.find_first_of("<>&") != std::string::npos)
        return {.words = "report.json holds <, > or &, which a page cannot carry as they are"};
    return {.passed = true,
            .words =
                "it carries report.json, byte for byte; what it shows was not compared "
                "(--recompute does)"};
}

PageFinding check_pdf(const fs::path& file, const ReportFacts& report) {
    const TemporaryFolder folder;
    const fs::path saved = folder.path() / "report.json";
    require_readable_pdf(file);
    const fs::path pdf = external_input(file);
    ExternalCall call{.command = {"pdfdetach", "-list", pdf.string()},
                      .folder = folder.path(),
                      .inputs = {pdf},
                      .limits = reading_pdf};
    ProcessResult list;
    try {
        list = run_external(call);
    } catch (const Failure&) {
        return {.checked = false,
                .words = "not checked: pdfdetach is missing (install poppler-utils)"};
    }
    // "1 embedded files", then a line "1: report.json" for each.
    if (list.exit_status != 0)
        return {.words =
                    fmt::format("it cannot be read as a PDF: {}", external_problem(call, list))};
    const std::size_t named = count_of(list.output, ": report.json\n");
    if (named == 1 && !list.output.starts_with("1 embedded files\n"))
        return {.words = fmt::format("there are other files attached to it beside report.json: {}",
                                     render_again)};
    if (named == 0)
        return {.words = fmt::format("report.json is not attached to it, as in pages of an earlier "
                                     "version of the program: {}",
                                     render_again)};
    if (named > 1)
        return {.words =
                    fmt::format("more than one report.json is attached to it: {}", render_again)};
    const std::size_t at = list.output.find(": report.json\n");
    const std::size_t line = list.output.rfind('\n', at) + 1;
    const std::string number = list.output.substr(line, at - line);
    call.command = {"pdfdetach", "-save", number, "-o", "report.json", pdf.string()};
    const ProcessResult save = run_external(call);
    if (save.exit_status != 0 || !fs::exists(saved) || read_file(saved) != report.text)
        return {.words =
                    fmt::format("the report attached to it is not report.json: {}", render_again)};
    std::string words =
        "report.json is attached to it, byte for byte; what it shows was not compared";
    const SealCheck seal = check_seal(file);
    if (seal.present) words += "; " + seal.words;
    return {.passed = !seal.present || seal.holds(), .words = std::move(words)};
}

}  // namespace

VerificationStep verify_pages(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{
        .passed = true, .what = "pages", .finding = {}, .details = {}, .checked = false};
    const auto look = [&](const char* name,
                          PageFinding (*check)(const fs::path&, const ReportFacts&)) {
        const fs::path file = run_dir / name;
        if (!fs::is_regular_file(fs::symlink_status(file))) return;
        const PageFinding found = check(file, report);
        step.details.push_back(fmt::format("{}: {}", name, found.words));
        if (!found.checked) return;
        step.checked = true;
        step.passed = step.passed && found.passed;
    };
    look("report.html", check_html);
    look("report.pdf", check_pdf);
    if (!step.checked) {
        step.passed = false;
        step.finding = step.details.empty() ? "there are none" : "not checked";
    } else {
        step.finding = step.passed ? "they carry the report that is signed"
                                   : "they do not carry the report that is signed";
        step.details.emplace_back("pages are for reading; what is signed is report.json");
    }
    return step;
}

}  // namespace runcert
