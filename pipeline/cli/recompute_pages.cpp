#include "recompute_pages.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/failure.h"
#include "core/plain_text.h"
#include "files/atomic_file.h"
#include "files/program.h"
#include "recompute_file.h"
#include "run/chain.h"
#include "trust/report_facts.h"
#include "trust/signature_files.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* html_file = "report.html";
constexpr const char* pdf_file = "report.pdf";

/// Where what stands between two marks begins and ends; both at the end where it is not there.
struct Place {
    std::size_t begin = 0;
    std::size_t end = 0;
};

Place between(std::string_view text, std::string_view first, std::string_view last,
              std::size_t from = 0) {
    const std::size_t at = text.find(first, from);
    if (at == std::string_view::npos) return {text.size(), text.size()};
    const std::size_t begin = at + first.size();
    return {begin, std::min(text.find(last, begin), text.size())};
}

/// The names of the signature files that a page carries.
std::vector<std::string> signatures_in(const std::string& page) {
    const Place place =
        between(page, "<script type=\"application/json\" id=\"signature-files\">", "</script>");
    const auto list =
        nlohmann::json::parse(page.substr(place.begin, place.end - place.begin), nullptr, false);
    std::vector<std::string> names;
    if (!list.is_array()) return names;
    for (const auto& entry : list)
        if (entry.is_object() && entry.contains("file") && entry["file"].is_string())
            names.push_back(entry["file"].get<std::string>());
    return names;
}

/// A page without its drawings and their hashes, which differ between versions of gnuplot.
std::string without_drawings(std::string page) {
    constexpr std::string_view drawing = "src=\"data:image/svg+xml;base64,";
    for (Place at = between(page, drawing, "\""); at.begin < page.size();
         at = between(page, drawing, "\"", at.begin))
        page.erase(at.begin, at.end - at.begin);
    const Place hashes =
        between(page, "<script type=\"application/json\" id=\"drawing-hashes\">", "</script>");
    return page.erase(hashes.begin, hashes.end - hashes.begin);
}

/// The report, and of the folder's signatures those that the page was made with.
void take_report(const fs::path& run_dir, const fs::path& folder, const std::string& page) {
    write_file_atomically(folder / report_file, read_file(run_dir / report_file));
    const std::vector<std::string> carried = signatures_in(page);
    for (const SignatureFile& signature : signature_files(run_dir))
        if (std::ranges::find(carried, signature.name) != carried.end())
            write_file_atomically(folder / signature.name, signature.text);
}

void compare_html(const std::string& page, const std::string& own, const ReportFacts& report,
                  PageComparison& comparison) {
    const std::string name = html_file;
    const bool made_here =
        report.program_version == program_version() && report.source_revision == source_revision();
    if (page == own) {
        comparison.details.push_back(name + ": identical when rendered again");
    } else if (without_drawings(page) == without_drawings(own)) {
        comparison.details.push_back(
            name +
            ": note: its text is identical when rendered again, its drawings are not, as "
            "another version of gnuplot makes them");
    } else if (made_here) {
        comparison.passed = false;
        comparison.details.push_back(
            name +
            ": it is not what this program renders of report.json and the signatures it "
            "carries: do not go by what it shows, render it again");
    } else {
        comparison.details.push_back(
            name +
            ": NOTE: not what this program renders of report.json; the program that made "
            "the report may have, but do not go by what it shows");
    }
}

}  // namespace

PageComparison compare_pages(const fs::path& run_dir, const fs::path& folder) {
    PageComparison comparison;
    const bool html = fs::is_regular_file(run_dir / html_file);
    const bool pdf = fs::is_regular_file(run_dir / pdf_file);
    if ((!html && !pdf) || !fs::exists(run_dir / report_file)) return comparison;
    const std::string page = html ? read_file(run_dir / html_file) : std::string();
    take_report(run_dir, folder, page);
    try {
        run_step("render", {.attempt = folder / "attempt.yaml", .run_dir = folder});
    } catch (const StageFailed& failed) {
        comparison.details.push_back(
            plain_text("NOTE: the pages could not be made again, and what they show was not "
                       "compared: " +
                       failed.errors));
        return comparison;
    }
    if (html)
        compare_html(page, read_file(folder / html_file), read_report_facts(run_dir), comparison);
    if (pdf)
        comparison.details.emplace_back(
            read_file(folder / pdf_file) == read_file(run_dir / pdf_file)
                ? "report.pdf: identical when rendered again"
                : "report.pdf: NOTE: not the file that is rendered here; other fonts, a seal or "
                  "other signatures do that too, but do not go by what it shows");
    return comparison;
}

}  // namespace runcert
