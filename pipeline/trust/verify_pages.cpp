#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/seal.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* identical = "identical when rendered again";
constexpr const char* differs =
    "it is not what the report renders to: do not go by what it shows, render it again";
constexpr const char* dots_per_inch = "100";

/// What `pdfinfo` says of a file: "Pages" is "14".
std::map<std::string, std::string> facts_of(const fs::path& pdf) {
    std::map<std::string, std::string> facts;
    for (const std::string& line : lines_of(poppler({"pdfinfo"}, pdf))) {
        const std::size_t colon = line.find(':');
        if (colon != std::string::npos)
            facts[line.substr(0, colon)] = std::string(trim(line.substr(colon + 1)));
    }
    return facts;
}

std::string text_of(const fs::path& pdf) {
    return poppler({"pdftotext", "-layout"}, pdf, {"-"});
}

/// The hash of each page's picture, in their order.
std::vector<std::string> pictures_of(const fs::path& pdf) {
    const TemporaryFolder folder;
    (void)poppler({"pdftoppm", "-r", dots_per_inch}, pdf, {"page"}, folder.path());
    std::set<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder.path()))
        files.insert(entry.path());
    std::vector<std::string> hashes;
    for (const fs::path& file : files)
        hashes.push_back(digest_file(file).sha256);
    return hashes;
}

/// In what a PDF shows otherwise than another, or nothing.
std::optional<std::string> difference_shown(const fs::path& pdf, const fs::path& own) {
    auto facts = facts_of(pdf);
    auto own_facts = facts_of(own);
    if (facts["JavaScript"] != "no") return "it holds a script";
    for (const char* fact : {"Title", "Pages", "Page size", "Page rot", "Encrypted"})
        if (facts[fact] != own_facts[fact])
            return fmt::format("its {} is \"{}\" where \"{}\" is rendered", lower_case(fact),
                               escape_for_message(facts[fact], 100), own_facts[fact]);
    if (text_of(pdf) != text_of(own)) return "its text is not the one that is rendered";
    const auto pictures = pictures_of(pdf);
    const auto own_pictures = pictures_of(own);
    for (std::size_t i = 0; i < std::max(pictures.size(), own_pictures.size()); ++i)
        if (i >= pictures.size() || i >= own_pictures.size() || pictures[i] != own_pictures[i])
            return fmt::format(
                "page {} does not look as it is rendered{}", i + 1,
                facts["Producer"] == own_facts["Producer"]
                    ? std::string()
                    : " here; it was made by " + escape_for_message(facts["Producer"], 100));
    return std::nullopt;
}

/// What comparing a page with the one that was rendered again gave.
struct PageComparison {
    bool same = false;  ///< whether it shows just what was rendered
    std::string words{};
};

constexpr const char* html_file = "report.html";
constexpr const char* pdf_file = "report.pdf";
constexpr const char* report_json_file = "report.json";

/// What stands in one of the scripts that carry data: "signature-files", "standing".
std::string carried(const std::string& page, std::string_view id) {
    const std::string begin = fmt::format("<script type=\"application/json\" id=\"{}\">", id);
    const std::size_t at = page.find(begin);
    if (at == std::string::npos) return {};
    const std::size_t from = at + begin.size();
    return page.substr(from, page.find("</script>", from) - from);
}

/// The names of the signature files that a page was made with: others may have come later.
std::vector<std::string> signatures_in(const std::string& page) {
    const auto list = nlohmann::json::parse(carried(page, "signature-files"), nullptr, false);
    std::vector<std::string> names;
    if (!list.is_array()) return names;
    for (const auto& entry : list)
        if (entry.is_object() && entry.contains("file") && entry["file"].is_string())
            names.push_back(entry["file"].get<std::string>());
    return names;
}

/// The hash of the roster that a page's standing goes by; empty where it goes by none.
std::string roster_of(const std::string& page) {
    const auto standing = nlohmann::json::parse(carried(page, "standing"), nullptr, false);
    if (!standing.is_object()) return {};
    const auto roster = standing.find("roster_sha256");
    return roster != standing.end() && roster->is_string() ? roster->get<std::string>() : "";
}

/// The folder's report, with those of its signatures that the page was made with, or all of them.
void take_report(const fs::path& run_dir, const fs::path& folder,
                 const std::optional<std::vector<std::string>>& shown) {
    write_file_atomically(folder / report_json_file, read_file(run_dir / report_json_file));
    for (const SignatureFile& signature : signature_files(run_dir))
        if (!shown || std::ranges::find(*shown, signature.name) != shown->end())
            write_file_atomically(folder / signature.name, signature.text);
    // All of these: a page that left out a no would say another thing.
    for (const std::string& name : attestation_names(run_dir)) {
        make_directory((folder / name).parent_path());
        if (fs::is_regular_file(fs::symlink_status(run_dir / name)))
            fs::copy_file(run_dir / name, folder / name);
    }
}

/// The pages of the run folder's report, made in `folder`. Nothing where they are; else why not.
std::optional<std::string> render_again(const fs::path& run_dir, const fs::path& folder,
                                        const ReportFacts& report, const fs::path& roster,
                                        bool with_pdf, bool brief) {
    try {
        run_step("render", {.attempt = run_dir / attempt_copy_name,
                            .run_dir = folder,
                            .pdf = with_pdf,
                            .brief = brief,
                            .roster = roster});
    } catch (const StageFailed& failed) {
        const std::string errors = message_of(failed);
        if (report.program_version != program_version() ||
            report.source_revision != source_revision())
            return fmt::format("not checked: made by runcert {}, source {}, and this is {}, {}",
                               escape_for_message(report.program_version),
                               escape_for_message(report.source_revision), program_version(),
                               source_revision());
        // "error: WHAT", then where, then what to do.
        const std::string_view said = errors;
        return "not checked: they cannot be rendered again. " +
               escape_for_message(trim(said.substr(said.find(' ') + 1, said.find('\n') - 7)), 600);
    }
    return std::nullopt;
}

/// Whether a PDF is the first page alone; one that cannot be read is not.
bool is_brief(const fs::path& pdf) {
    try {
        require_readable_pdf(pdf);
        return facts_of(pdf)["Pages"] == "1";
    } catch (const Failure&) {
        return false;
    }
}

PageComparison compare_bytes(const fs::path& page, const fs::path& own) {
    if (read_file(page) != read_file(own)) return {.words = differs};
    return {.same = true, .words = identical};
}

/// Byte for byte; a PDF that a seal was put on must carry the same report and nothing else, run no
/// script, hold the same text and show the same pictures, page by page (poppler, 100 dots per
/// inch), and its seal must hold for every byte. Where one is not the same, the words say in what,
/// and that another renderer made it where one did.
PageComparison compare_pdf(const fs::path& pdf, const fs::path& own,
                           const std::string& report_text) {
    try {
        require_readable_pdf(pdf);
        if (compare_bytes(pdf, own).same) return {.same = true, .words = identical};
        auto fault = fault_of_attachment(pdf, report_text);
        if (!fault) fault = difference_shown(pdf, own);
        if (fault) return {.words = fmt::format("{}: {}", *fault, differs)};
        const SealCheck seal = check_seal(pdf);
        if (!seal.present)
            return {.words =
                        "it shows what is rendered again, but is not that file, and no seal "
                        "covers its bytes: render it again"};
        return {.same = seal.holds(),
                .words = "it shows what is rendered again, page by page; " + seal.words};
    } catch (const Failure& failure) {
        return {.words = fmt::format("it cannot be read as a PDF: {}", failure.problem())};
    }
}

}  // namespace

VerificationStep verify_pages(const fs::path& run_dir, const ReportFacts& report,
                              const SignatureRules& rules) {
    VerificationStep step{.passed = true, .what = "pages", .checked = true};
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
    const std::string page = html ? read_file(run_dir / html_file) : std::string();
    const std::string roster = roster_of(page);
    if (!roster.empty() && (!rules.vouches() || roster != sha256_hex(rules.roster->text))) {
        step.passed = false;
        step.finding = fmt::format(
            "their standing goes by a roster that was not given here, "
            "SHA-256 {}",
            shown(roster));
        step.details.emplace_back(
            "Render them again, by your own roster or by none: runcert attest RUN --render.");
        return step;
    }
    const TemporaryFolder roster_folder;
    const fs::path roster_file = roster_folder.path() / "roster";
    if (!roster.empty()) write_file_atomically(roster_file, rules.roster->text);
    take_report(run_dir, folder.path(), html ? std::optional(signatures_in(page)) : std::nullopt);
    if (const auto failed =
            render_again(run_dir, folder.path(), report, roster.empty() ? fs::path() : roster_file,
                         pdf, pdf && is_brief(run_dir / pdf_file))) {
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
