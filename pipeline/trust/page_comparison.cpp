#include "trust/page_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "core/failure.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/external_program.h"
#include "files/process.h"
#include "files/sha256.h"
#include "trust/bundle_limits.h"
#include "trust/seal.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* identical = "identical when rendered again";
constexpr const char* differs =
    "it is not what the report renders to: do not go by what it shows, render it again";
constexpr const char* dots_per_inch = "100";

/// What a program of poppler says of a PDF, whose name stands behind the options and before `more`;
/// what it writes goes into `folder`.
std::string poppler(std::vector<std::string> command, const fs::path& pdf,
                    const std::vector<std::string>& more = {}, const fs::path& folder = {}) {
    const fs::path input = external_input(pdf);
    command.push_back(input.string());
    command.insert(command.end(), more.begin(), more.end());
    const ExternalCall call{
        .command = std::move(command), .folder = folder, .inputs = {input}, .limits = reading_pdf};
    const ProcessResult result = run_external(call);
    if (result.exit_status != 0)
        throw Failure(call.command.front(), external_problem(call, result),
                      "Render the page again from report.json");
    return result.output;
}

/// What `pdfinfo` says of a file: "Pages" is "14".
std::map<std::string, std::string> facts_of(const fs::path& pdf) {
    std::map<std::string, std::string> facts;
    const std::string said = poppler({"pdfinfo"}, pdf);
    for (std::size_t begin = 0; begin < said.size();) {
        const std::size_t end = std::min(said.find('\n', begin), said.size());
        const std::string line = said.substr(begin, end - begin);
        const std::size_t colon = line.find(':');
        if (colon != std::string::npos)
            facts[line.substr(0, colon)] = std::string(trim(line.substr(colon + 1)));
        begin = end + 1;
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

}  // namespace

// `pdfdetach -list` says "1 embedded files", then "1: report.json" for each.
std::optional<std::string> fault_of_attachment(const fs::path& pdf, const std::string& report) {
    const std::string list = poppler({"pdfdetach", "-list"}, pdf);
    if (list != "1 embedded files\n1: report.json\n")
        return "it does not carry report.json and no other file";
    const TemporaryFolder folder;
    (void)poppler({"pdfdetach", "-save", "1", "-o", "report.json"}, pdf, {}, folder.path());
    if (read_file(folder.path() / "report.json") != report)
        return "the report attached to it is not report.json";
    return std::nullopt;
}

PageComparison compare_bytes(const fs::path& page, const fs::path& own) {
    if (read_file(page) != read_file(own)) return {.words = differs};
    return {.same = true, .words = identical};
}

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

}  // namespace runcert
