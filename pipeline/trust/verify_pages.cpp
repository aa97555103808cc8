#include <fmt/format.h>
#include <fmt/ranges.h>

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
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/run_standing.h"
#include "trust/seal.h"
#include "trust/signature_files.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

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

/// The names of the fonts in a PDF, each once, without the tags of their subsets
/// ("IHAPJL+FreeSans").
std::set<std::string> fonts_of(const fs::path& pdf) {
    std::set<std::string> names;
    const std::vector<std::string> lines = lines_of(poppler({"pdffonts"}, pdf));
    for (std::size_t i = 2; i < lines.size(); ++i) {  // below the head of the table
        const std::string name = lines[i].substr(0, lines[i].find(' '));
        names.insert(name.substr(name.find('+') + 1));
    }
    return names;
}

/// What the first page says, without its margin below and without blanks: breaks of lines are the
/// renderer's.
std::string first_page_of(const fs::path& pdf) {
    std::string text = poppler(
        {"pdftotext", "-raw", "-f", "1", "-l", "1", "-x", "0", "-y", "0", "-W", "600", "-H", "800"},
        pdf, {"-"});
    std::erase_if(text, [](char c) { return c == ' ' || c == '\n' || c == '\f'; });
    return text;
}

/// Which renderer made a PDF, where it says that it was another than made the one here.
std::optional<std::string> other_renderer(const fs::path& pdf, const fs::path& own) {
    const std::string producer = facts_of(pdf)["Producer"];
    const std::string own_producer = facts_of(own)["Producer"];
    if (producer != own_producer)
        return fmt::format("it was made by {}, here is {}", escape_for_message(producer, 100),
                           own_producer);
    const std::set<std::string> fonts = fonts_of(pdf);
    if (const auto own_fonts = fonts_of(own); fonts != own_fonts)
        return fmt::format("it was made with the fonts {}, here are {}",
                           escape_for_message(fmt::format("{}", fmt::join(fonts, ", ")), 300),
                           fmt::join(own_fonts, ", "));
    return std::nullopt;
}

/// What a PDF has otherwise than another, in whatever fonts, or nothing.
std::optional<std::string> difference_of_kind(const fs::path& pdf, const fs::path& own) {
    auto facts = facts_of(pdf);
    auto own_facts = facts_of(own);
    for (const char* fact : {"Title", "Page size", "Page rot", "Encrypted"})
        if (facts[fact] != own_facts[fact])
            return fmt::format("its {} is \"{}\" where \"{}\" is rendered", lower_case(fact),
                               escape_for_message(facts[fact], 100), own_facts[fact]);
    return std::nullopt;
}

/// In what a PDF of the same renderer shows otherwise than another, or nothing.
std::optional<std::string> difference_shown(const fs::path& pdf, const fs::path& own) {
    const std::string pages = facts_of(pdf)["Pages"];
    if (const std::string own_pages = facts_of(own)["Pages"]; pages != own_pages)
        return fmt::format("its number of pages is {} where {} are rendered",
                           escape_for_message(pages, 100), own_pages);
    if (text_of(pdf) != text_of(own)) return "its text is not the one that is rendered";
    const auto pictures = pictures_of(pdf);
    const auto own_pictures = pictures_of(own);
    for (std::size_t i = 0; i < std::max(pictures.size(), own_pictures.size()); ++i)
        if (i >= pictures.size() || i >= own_pictures.size() || pictures[i] != own_pictures[i])
            return fmt::format("page {} does not look as it is rendered", i + 1);
    return std::nullopt;
}

constexpr const char* html_file = "report.html";
constexpr const char* report_json_file = "report.json";
constexpr const char* is_identical = ": identical when rendered again";
constexpr const char* differs =
    "it is not what the report renders to: do not go by what it shows, render it again";

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

}  // namespace

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

namespace {

/// Why pages could not be made again.
struct Obstacle {
    std::string words{};
    bool is_here = false;  ///< another computer might do it
};

/// Renders; what stood against it, or nothing.
std::optional<Obstacle> obstacle_to(const StepCall& call, const ReportFacts& report) {
    try {
        run_step("render", call);
        return std::nullopt;
    } catch (const StageFailed& failed) {
        const std::string errors = message_of(failed);
        // "error: WHAT", then where, then what to do.
        const std::string_view line = std::string_view(errors).substr(0, errors.find('\n'));
        const std::string said = "they cannot be made again: " +
                                 escape_for_message(trim(line.substr(line.find(' ') + 1)), 600);
        if (const auto program = failed_call(failed)) {
            const std::string missing = missing_program_words(*program);
            return Obstacle{missing.empty() ? said : missing, true};
        }
        if (!is_made_here(report)) return Obstacle{made_by_another(report), true};
        return Obstacle{said};
    }
}

/// What could not be made again counts as its cause does.
void add(VerificationStep& step, const std::string& what, const Obstacle& obstacle) {
    if (obstacle.is_here)
        step.leave(fmt::format("{}: not checked here: {}", what, obstacle.words));
    else
        step.fail(fmt::format("{}: {}", what, obstacle.words));
}

/// Byte for byte. It carries the report whatever program made it.
void judge_html(VerificationStep& step, const fs::path& own, const std::string& page,
                const ReportFacts& report, const std::optional<Obstacle>& obstacle) {
    const std::string name(html_file);
    if (carried(page, "report-json") != report.text)
        step.fail(fmt::format("{}: it carries another report than report.json: {}", name, differs));
    else if (!fs::exists(own))
        add(step, name, *obstacle);
    else if (page != read_file(own))
        step.fail(fmt::format("{}: {}", name, differs));
    else
        step.details.push_back(name + is_identical);
}

/// A PDF that is not the one rendered here, byte for byte. It must hold the same text and show the
/// same pictures, page by page (poppler, 100 dots per inch), and a seal must hold for every byte.
/// Where another renderer made it, which only it says itself, its first page must say the same, and
/// the rest is not checked.
void judge_other_pdf(VerificationStep& step, const fs::path& pdf, const fs::path& own) {
    const std::string name = pdf.filename().string();
    const auto fail = [&](const std::string& fault) {
        step.fail(fmt::format("{}: {}: {}", name, fault, differs));
    };
    if (const auto fault = difference_of_kind(pdf, own)) return fail(*fault);
    auto difference = difference_shown(pdf, own);
    const SealCheck seal = check_seal(pdf);
    if (seal.present && !difference) difference = fault_under_seal(read_file(pdf), read_file(own));
    if (seal.present && !difference) {
        const std::string words =
            fmt::format("{}: it shows what is rendered again, page by page; {}", name, seal.words);
        return seal.holds() ? step.details.push_back(words) : step.fail(words);
    }
    if (const auto other = other_renderer(pdf, own)) {
        if (first_page_of(pdf) != first_page_of(own))
            return fail(fmt::format("its first page says other than is rendered ({})", *other));
        return step.leave(
            fmt::format("{}: not checked here: {}; the report that it carries and "
                        "the words of its first page are the same",
                        name, *other));
    }
    if (difference) return fail(*difference);
    step.fail(name +
              ": it shows what is rendered again, but is not that file, and no seal covers its "
              "bytes: render it again");
}

/// It must carry the report and nothing else, and run no script, whoever rendered it.
void judge_pdf(VerificationStep& step, const fs::path& pdf, const fs::path& own,
               const ReportFacts& report, const std::optional<Obstacle>& obstacle) {
    const std::string name = pdf.filename().string();
    try {
        require_readable_pdf(pdf);
        if (fs::exists(own) && read_file(pdf) == read_file(own))
            return step.details.push_back(name + is_identical);
        if (const std::string missing = missing_program_words("pdfdetach"); !missing.empty())
            return step.leave(fmt::format("{}: not checked here: {}", name, missing));
        auto fault = fault_of_attachment(pdf, report.text);
        if (!fault && facts_of(pdf)["JavaScript"] != "no") fault = "it holds a script";
        if (fault) return step.fail(fmt::format("{}: {}: {}", name, *fault, differs));
        if (!fs::exists(own)) return add(step, name, *obstacle);
        judge_other_pdf(step, pdf, own);
    } catch (const ComputerFailure&) {
        throw;
    } catch (const Failure& failure) {
        step.fail(fmt::format("{}: it cannot be read as a PDF: {}", name, failure.problem()));
    }
}

std::string finding_of(const VerificationStep& step, const char* verified, const char* not_so) {
    return step.is(LayerAnswer::verified)       ? verified
           : step.is(LayerAnswer::not_verified) ? not_so
                                                : "not all could be checked here";
}

/// The SHA-256 of the roster that report.html was made with, as it says; empty where it names none.
std::string roster_of_pages(const fs::path& run_dir) {
    if (!fs::is_regular_file(fs::symlink_status(run_dir / html_file))) return {};
    const auto standing =
        nlohmann::json::parse(carried(read_file(run_dir / html_file), "standing"), nullptr, false);
    if (!standing.is_object()) return {};
    const auto roster = standing.find("roster_sha256");
    return roster != standing.end() && roster->is_string() ? roster->get<std::string>() : "";
}

}  // namespace

std::vector<std::string> pages_in(const fs::path& run_dir) {
    std::vector<std::string> pages(page_names.begin(), page_names.end());
    std::erase_if(pages, [&](const std::string& name) {
        return !fs::is_regular_file(fs::symlink_status(run_dir / name));
    });
    return pages;
}

bool lies_in(const fs::path& file, const fs::path& run_dir) {
    std::error_code ignored;
    const fs::path inner = fs::weakly_canonical(file, ignored);
    const fs::path outer = fs::weakly_canonical(run_dir, ignored);
    return std::ranges::mismatch(outer, inner).in1 == outer.end();
}

void require_own_roster(const std::string& roster, const fs::path& run_dir, bool for_pages) {
    if (!roster.empty() && lies_in(roster, run_dir))
        throw Failure(roster, "this roster lies in the run, and vouches for nothing",
                      "Give the roster that you have from the body itself");
    const std::string shown_by = for_pages ? roster_of_pages(run_dir) : "";
    if (shown_by.empty() || (!roster.empty() && sha256_hex(read_handwritten(roster)) == shown_by))
        return;
    throw Failure((run_dir / "report.html").string(),
                  "the pages go by the roster with the SHA-256 " + shown(shown_by),
                  "Give that one with --roster; or first make them again by yours: runcert attest "
                  "RUN --render --roster ROSTER");
}

VerificationStep verify_pages(const fs::path& run_dir, const ReportFacts& report,
                              const SignatureRules& rules, const RunStanding& found) {
    VerificationStep step{.what = "pages"};
    const bool html = fs::is_regular_file(fs::symlink_status(run_dir / html_file));
    const std::vector<std::string> pages = pages_in(run_dir);
    if (pages.empty()) {
        step.finding = "there are none";
        return step;
    }
    const std::string page = html ? read_file(run_dir / html_file) : std::string();
    const std::string roster = roster_of_pages(run_dir);
    if (!roster.empty() && (!rules.vouches() || roster != sha256_hex(rules.roster->text))) {
        step.finding = fmt::format(
            "their standing goes by a roster that was not given here, "
            "SHA-256 {}",
            shown(roster));
        step.fail("Render them again by your own: runcert attest RUN --render --roster ROSTER.");
        return step;
    }
    step.answer = LayerAnswer::verified;
    const TemporaryFolder folder, others;
    const fs::path roster_file = others.path() / "roster";
    if (!roster.empty()) write_file_atomically(roster_file, rules.roster->text);
    take_report(run_dir, folder.path(), html ? std::optional(signatures_in(page)) : std::nullopt);
    const auto obstacle = obstacle_to({.attempt = run_dir / attempt_copy_name,
                                       .run_dir = folder.path(),
                                       .pages = pages,
                                       .roster = roster.empty() ? fs::path() : roster_file},
                                      report);
    if (html) judge_html(step, folder.path() / html_file, page, report, obstacle);
    for (const std::string& pdf : pages)
        if (pdf != html_file) judge_pdf(step, run_dir / pdf, folder.path() / pdf, report, obstacle);
    if (rules.vouches()) {
        const RunStanding on_pages =
            stated_standing(folder.path(), report, roster.empty() ? std::nullopt : rules.roster);
        for (std::size_t i = 0; i < found.rules.size(); ++i)
            if (on_pages.rules.at(i).state.standing.state != found.rules[i].state.standing.state)
                step.fail(found.rules[i].profile +
                          ": they show another standing than was found: "
                          "runcert attest RUN --render --roster ROSTER");
    }
    step.finding = finding_of(step, "they are what the report renders to",
                              "not all are what the report renders to");
    step.details.emplace_back("Pages are for reading; what is signed is report.json.");
    return step;
}

}  // namespace runcert
