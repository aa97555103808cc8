#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/process.h"
#include "files/program.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "trust/page_comparison.h"
#include "trust/seal.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* html_file = "report.html";
constexpr const char* pdf_file = "report.pdf";
constexpr const char* report_json_file = "report.json";

/// What stands in the script that carries the names and texts of the signatures shown.
std::string signatures_shown(const std::string& page) {
    constexpr std::string_view begin = "<script type=\"application/json\" id=\"signature-files\">";
    const std::size_t at = page.find(begin);
    if (at == std::string::npos) return {};
    const std::size_t from = at + begin.size();
    return page.substr(from, page.find("</script>", from) - from);
}

/// The names of the signature files that a page was made with: others may have come later.
std::vector<std::string> signatures_in(const std::string& page) {
    const auto list = nlohmann::json::parse(signatures_shown(page), nullptr, false);
    std::vector<std::string> names;
    if (!list.is_array()) return names;
    for (const auto& entry : list)
        if (entry.is_object() && entry.contains("file") && entry["file"].is_string())
            names.push_back(entry["file"].get<std::string>());
    return names;
}

/// The folder's report, with those of its signatures that the page was made with, or all of them.
void take_report(const fs::path& run_dir, const fs::path& folder,
                 const std::optional<std::vector<std::string>>& shown) {
    write_file_atomically(folder / report_json_file, read_file(run_dir / report_json_file));
    for (const SignatureFile& signature : signature_files(run_dir))
        if (!shown || std::ranges::find(*shown, signature.name) != shown->end())
            write_file_atomically(folder / signature.name, signature.text);
}

/// The pages of the run folder's report, made in `folder`. Nothing where they are; else why not.
std::optional<std::string> render_again(const fs::path& run_dir, const fs::path& folder,
                                        const ReportFacts& report, bool with_pdf) {
    try {
        run_step("render",
                 {.attempt = run_dir / attempt_copy_name, .run_dir = folder, .pdf = with_pdf});
    } catch (const StageFailed& failed) {
        if (report.program_version != program_version() ||
            report.source_revision != source_revision())
            return fmt::format("not checked: made by runcert {}, source {}, and this is {}, {}",
                               escape_for_message(report.program_version),
                               escape_for_message(report.source_revision), program_version(),
                               source_revision());
        // "error: WHAT", then where, then what to do.
        const std::string_view said = failed.errors;
        return "not checked: they cannot be rendered again. " +
               escape_for_message(trim(said.substr(said.find(' ') + 1, said.find('\n') - 7)), 600);
    }
    return std::nullopt;
}

}  // namespace

VerificationStep verify_pages(const fs::path& run_dir, const ReportFacts& report) {
    VerificationStep step{
        .passed = true, .what = "pages", .finding = {}, .details = {}, .checked = true};
    const auto is_there = [&](const char* name) {
        return fs::is_regular_file(fs::symlink_status(run_dir / name));
    };
    const bool html = is_there(html_file);
    const bool pdf = is_there(pdf_file);
    if (!html && !pdf) {
        step.passed = step.checked = false;
        step.finding = "there are none";
        return step;
    }
    const TemporaryFolder folder;
    take_report(run_dir, folder.path(),
                html ? std::optional(signatures_in(read_file(run_dir / html_file))) : std::nullopt);
    if (const auto failed = render_again(run_dir, folder.path(), report, pdf)) {
        step.passed = false;
        step.finding = *failed;
        step.details.emplace_back(
            "Render them again with the program that made the report, or move them away.");
        return step;
    }
    const auto add = [&](const char* name, const PageComparison& compared) {
        step.passed = step.passed && compared.same;
        step.details.push_back(fmt::format("{}: {}", name, compared.words));
    };
    if (html) add(html_file, compare_bytes(run_dir / html_file, folder.path() / html_file));
    if (pdf) add(pdf_file, compare_pdf(run_dir / pdf_file, folder.path() / pdf_file, report.text));
    step.finding = step.passed ? "they are what the report renders to"
                               : "not all are what the report renders to";
    step.details.emplace_back("Pages are for reading; what is signed is report.json.");
    return step;
}

}  // namespace runcert
