#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <iostream>

#include "attest_list.h"
#include "commands.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "recompute.h"
#include "run/run_lock.h"
#include "store/archive.h"
#include "store/atomic_file.h"
#include "store/sha256.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/roster.h"
#include "trust/signing.h"
#include "trust/ssh_signature.h"
#include "trust/verification.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct AttestOptions {
    std::string run_dir;
    std::vector<std::string> clauses;
    std::string profile, role, key, statement, paper, roster;
    std::vector<std::string> evidence, take;
    bool no = false, withdraw = false, recomputed = false, close = false, yes = false;
    bool render = false, no_render = false;

    bool signs() const { return !clauses.empty() || recomputed || close; }
    std::string_view answer() const {
        return withdraw ? answer_withdrawn : no ? answer_no : answer_yes;
    }
};

/// A file that goes along, with its bytes; blanks and letters of other alphabets in its name
/// become -.
struct TakenFile {
    EvidenceFile named{};
    std::string bytes{};
};

TakenFile take_file(const fs::path& path) {
    constexpr std::uintmax_t longest = std::uintmax_t{256} << 20;
    constexpr std::size_t longest_name = 100;
    std::string name = path.filename().string();
    std::ranges::replace_if(
        name,
        [](char c) {
            return !is_printable_ascii({&c, 1}) || c == ' ';
        },
        '-');
    if (!is_plain_name(name) || name.size() > longest_name)
        throw Failure(path.string(), "this is no name that every system can keep a file under",
                      "Give it a short name of letters and digits");
    if (fs::is_regular_file(path) && fs::file_size(path) > longest)
        throw Failure(path.string(), fmt::format("the file is longer than {} bytes", longest),
                      "Hand it over by itself, and name it in --statement");
    TakenFile file{.named = {.name = name}, .bytes = read_file(path)};
    if (holds_secret_key(file.bytes))
        throw Failure(path.string(), "the file holds a secret key, which evidence would hand on",
                      "Name another file; if others had this one, make a new key");
    file.named.sha256 = sha256_hex(file.bytes);
    return file;
}

/// A scan of a sheet, by how its bytes begin: PDF, PNG, JPEG, TIFF or HEIC.
TakenFile take_scan(const fs::path& path) {
    using namespace std::string_view_literals;
    TakenFile file = take_file(path);
    const std::string_view bytes = file.bytes;
    const std::array begins{"%PDF-"sv, "\x89PNG\r\n\x1a\n"sv, "\xFF\xD8\xFF"sv, "II*\0"sv,
                            "MM\0*"sv};
    const std::array brands{"ftypheic"sv, "ftypheix"sv, "ftyphevc"sv, "ftypmif1"sv};
    const std::string_view brand = bytes.substr(std::min<std::size_t>(4, bytes.size()), 8);
    if (std::ranges::any_of(begins, [&](auto one) { return bytes.starts_with(one); }) ||
        std::ranges::find(brands, brand) != brands.end())
        return file;
    throw Failure(path.string(), "this is no PDF and no picture, and so no scan of a sheet",
                  "Give --paper a PDF, PNG, JPEG, TIFF or HEIC file; other files are --evidence");
}

void require_statement(const std::string& statement) {
    constexpr std::size_t longest = 1000;
    if (statement.size() > longest || !is_printable_line(statement))
        throw Failure(
            "--statement",
            fmt::format("it is not one line of printable text of at most {} bytes", longest),
            "Shorten it, or hand it over as --evidence");
}

/// Refuses what this key has answered already, and to take back what it has not.
void require_sense(const AttestOptions& options, const std::vector<DueClause>& chosen,
                   const Attestations& there, const std::string& key) {
    for (const DueClause& clause : chosen) {
        const auto own = std::ranges::find_if(there.answers, [&](const GivenAnswer& one) {
            return one.key == key && one.profile == clause.profile && one.clause == clause.clause &&
                   one.counts && one.answer != answer_withdrawn;
        });
        const bool answered = own != there.answers.end();
        if (answered == options.withdraw) continue;
        const std::string name = clause.profile + "/" + clause.clause;
        if (answered)
            throw Failure(name, fmt::format("this key has answered it: {}", answer_words(*own)),
                          "Take that back first, with --withdraw");
        throw Failure(name, "this key has not answered it, so that there is nothing to take back",
                      "`runcert attest RUN` lists who answered what");
    }
}

/// Shows what is about to be signed. False where whoever types says no.
bool is_confirmed(const AttestOptions& options, const std::vector<DueClause>& chosen) {
    for (const DueClause& clause : chosen)
        fmt::print("{}{}      answer: {}\n\n", clause_heading(clause), clause_figures(clause),
                   options.answer());
    if (options.recomputed) fmt::print("every stage was run again, and every file is the same\n");
    std::fflush(stdout);
    if (options.yes) return true;
    if (isatty(STDIN_FILENO) == 0)
        throw Failure("the command line", "nobody is there to confirm what is signed",
                      "Read what is shown above, and give --yes");
    fmt::print(stderr, "Sign this as {}? [y/N] ", options.role);
    std::string word;
    std::getline(std::cin, word);
    return word == "y" || word == "Y" || word == "yes";
}

UtcSecond now() {
    return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
}

/// Where the run stands by the roster given, as of now.
RunStanding standing_now(const AttestOptions& options, const ReportFacts& report) {
    std::optional<Roster> roster = read_roster(options.roster);
    if (options.close && (!roster || roster->closing_role() != options.role))
        throw Failure("--close", "the role that closes, and what counts, are the roster's to say",
                      fmt::format("Give the body's --roster, and --role {}",
                                  roster.value_or(Roster{}).closing_role()));
    return stated_standing(options.run_dir, report, std::move(roster), now());
}

Attestation statement_of(const AttestOptions& options, const ReportFacts& report,
                         const std::vector<DueClause>& chosen) {
    Attestation said{.report_sha256 = sha256_hex(report.text),
                     .role = options.role,
                     .report_id = report.report_id,
                     .attempt_id = report.attempt_id,
                     .statement = options.statement};
    for (const DueClause& clause : chosen)
        said.answers.push_back({.profile = clause.profile,
                                .clause = clause.clause,
                                .text = clause.text,
                                .shown = clause.shown,
                                .answer = std::string(options.answer())});
    if (options.recomputed) said.policies = policies_of(report);
    if (!options.close) return said;
    const RunStanding standing = standing_now(options, report);
    for (const std::string& line : standing_lines(standing, true))
        fmt::print("{}\n", plain_text(line));
    said.closes = standing.to_close;
    for (const EvidenceFile& file : said.closes)
        fmt::print("closes  {}\n", plain_text(file.name));
    return said;
}

/// Signs and writes, under the run's lock, what was shown.
std::string sign_and_write(const AttestOptions& options, const ReportFacts& report,
                           const std::vector<DueClause>& chosen, Attestation said) {
    std::vector<std::string> bytes;
    for (const std::string& file : options.evidence) {
        TakenFile taken = take_file(file);
        said.evidence.push_back(taken.named);
        bytes.push_back(std::move(taken.bytes));
    }
    if (!options.paper.empty()) {
        TakenFile taken = take_scan(options.paper);
        said.on_paper = taken.named;
        bytes.push_back(std::move(taken.bytes));
    }
    const SecretKey key = load_secret_key(options.key);
    const PublicKey public_key = public_key_of(key);
    const RunLock lock(options.run_dir);
    if (read_file(fs::path(options.run_dir) / "report.json") != report.text)
        throw Failure((fs::path(options.run_dir) / "report.json").string(),
                      "the report was changed after it was shown; nothing was signed",
                      "Find out who writes into the folder, and answer again");
    const RunStanding standing = standing_now(options, report);
    if (!standing.given.faults.empty())
        throw Failure(options.run_dir, standing.given.faults.front(),
                      "Nothing was signed. Bring back the original, or move it away");
    require_sense(options, chosen, standing.given, ssh_key_text(ssh_key_of(public_key.key)));
    if (options.close && (said.closes.empty() || said.closes != standing.to_close))
        throw Failure(options.run_dir,
                      "there is nothing to close, or it changed while it was shown",
                      "Nothing was signed. See what lies there, and close again");
    if (!options.close) said.after = standing.given.before;  // a close names them as files
    said.key = public_key_line(public_key);
    said.time = iso_text(now());
    return write_attestation(options.run_dir, said, bytes, key);
}

int sign_answers(const AttestOptions& options) {
    if (options.role.empty() || options.key.empty())
        throw Failure("the command line", "an answer needs who gives it",
                      "Give --role ROLE and --key KEY");
    require_role(options.role, "--role");
    require_statement(options.statement);
    const fs::path run_dir = options.run_dir;
    const ReportFacts report = read_report_facts(run_dir);
    constexpr const char* bring_back = "Bring back the original files, or certify again";
    require_signable(run_dir, report, bring_back);
    require_passed(run_dir, verify_report_text(run_dir, report), bring_back);
    const std::vector<DueClause> chosen =
        chosen_clauses(report, options.clauses, options.profile, options.role);
    if (options.recomputed)
        require_passed(run_dir, verify_recomputation(run_dir, report), bring_back);
    const Attestation said = statement_of(options, report, chosen);
    if (!is_confirmed(options, chosen)) {
        fmt::print("nothing was signed\n");
        return 1;
    }
    const std::string file = sign_and_write(options, report, chosen, said);
    fmt::print("signed  report {} of {}, as {}\nfile    {}\n", report.report_id, report.attempt_id,
               options.role, (run_dir / file).string());
    return options.no_render ? 0 : render_pages(run_dir, options.roster, "the answer is signed");
}

/// Brings in what others answered on copies of the run.
int take(const AttestOptions& options) {
    const ReportFacts report = read_report_facts(options.run_dir);
    std::vector<std::string> brought;
    {
        const RunLock lock(options.run_dir);
        try {
            for (const std::string& one : options.take) {
                const GivenRun copy(one);
                for (std::string& name : take_answers(options.run_dir, copy.folder()))
                    brought.push_back(std::move(name));
            }
            const RunStanding standing = standing_now(options, report);
            if (!standing.given.faults.empty())
                throw Failure(options.run_dir, standing.given.faults.front(),
                              "Nothing was taken. Ask for the answer again");
            for (const std::string& line : standing_lines(standing, true))
                fmt::print("{}\n", plain_text(line));
        } catch (const Failure&) {
            for (const std::string& name : brought)
                fs::remove(fs::path(options.run_dir) / name);
            throw;
        }
    }
    fmt::print("taken   {}\n", brought.empty() ? "nothing: all of it is there already"
                                               : plain_text(listed(brought)));
    return options.no_render || brought.empty()
               ? 0
               : render_pages(options.run_dir, options.roster, "the answers are taken");
}

/// The run, unpacked to stay where a bundle is answered in.
fs::path folder_of(const AttestOptions& options, GivenRun& given) {
    if (!given.is_bundle() || (!options.signs() && options.take.empty() && !options.render))
        return given.folder();
    const fs::path kept = given.run_folder_to_write();
    fmt::print("unpacked to {}: send that, or `runcert bundle` of it, back to who holds the run\n",
               kept.string());
    return kept;
}

int attest(AttestOptions options) {
    const std::string known_as = options.run_dir;
    GivenRun given(options.run_dir);
    options.run_dir = folder_of(options, given).string();
    require_known_versions(options.run_dir);
    require_own_roster(options.roster, options.run_dir,
                       options.signs() || !options.take.empty()
                           ? !options.no_render
                           : options.render && options.roster.empty());
    require_in_force(options.roster);
    if (!options.take.empty()) return take(options);
    if (options.signs()) return sign_answers(options);
    if (options.render) return render_pages(options.run_dir, options.roster, "nothing is lost");
    return list_clauses(options.run_dir, known_as, options.roster);
}

}  // namespace

void add_attest(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<AttestOptions>(
        app, chosen, "attest",
        "Answer, signed, for what a recording cannot decide; or list what is open", attest);
    line.text("RUN_DIR", options.run_dir,
              "the folder of a certified run, or a bundle, which is unpacked here",
              CommandLine::required);
    line.texts("CLAUSE", options.clauses,
               "observers, or nalsa/observers; none: list what is to be attested");
    line.text("--profile", options.profile, "of which rule (default: of all that have it)");
    line.text("--role", options.role, "what whoever answers is: judge, measurer, board");
    line.text("--key", options.key, "secret key of whoever answers (runcert keygen)");
    line.flag("--no", options.no, "the answer is no");
    line.flag("--withdraw", options.withdraw, "take back what this key answered");
    line.exclude("--withdraw", {"--no"});
    line.text("--statement", options.statement, "a line in your own words");
    line.texts("--evidence", options.evidence, "a file to go along; may be repeated");
    line.text(
        "--paper", options.paper,
        "scan (PDF or picture) of the report's last page, signed by hand: you sign that it was");
    line.exclude("--paper", {"--withdraw"});
    line.flag("--recomputed", options.recomputed,
              "run every stage again, and sign that all is the same");
    line.exclude("--recomputed", {"CLAUSE"});
    line.flag("--close", options.close,
              "sign the list of all answers and signatures: only then is a run complete");
    line.exclude("--close", {"CLAUSE", "--no", "--withdraw", "--recomputed"});
    line.texts(
        "--take", options.take,
        "a copy of this run, or a bundle of it, whose answers and signatures are brought in; may "
        "be repeated");
    line.exclude("--take", {"CLAUSE", "--no", "--withdraw", "--recomputed", "--close"});
    line.flag("--yes", options.yes, "do not ask before signing");
    line.text("--roster", options.roster,
              "whose answers and signatures list and pages count; verify with it too");
    line.flag("--render", options.render, "render the pages again, and sign nothing");
    line.flag("--no-render", options.no_render, "leave the pages as they are");
    line.footer(
        "Writes attestations/answer-ID.json, a DSSE envelope with an in-toto statement about the "
        "hash of\nreport.json, with evidence beside it. report.json never changes: where the run "
        "stands is computed from\nit and from what lies beside it. A no is a no; --withdraw takes "
        "an answer back, which is signed too.\nOnly a closed run is complete (--close, by the "
        "board or by the roster's line #runcert close ROLE).\nExit status: 0 signed or listed, 1 "
        "not confirmed, 2 it could not be done.");
}

}  // namespace runcert
