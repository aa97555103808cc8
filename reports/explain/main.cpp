#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "reports/document/document_text.h"
#include "reports/explain/explain.h"
#include "run/attempt_files.h"
#include "run/reported_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "trust/attestation.h"
#include "trust/bundle.h"
#include "trust/roster.h"
#include "trust/run_standing.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir, roster;
    ExplainOptions what;
    bool profiles = false, clauses = false, inputs = false;
};

/// Hashes what report and verdict were made from, and is in the run folder. The names of what is
/// not.
std::vector<std::string> check_inputs(StageRun& run, const Verdict& verdict) {
    std::vector<std::string> missing;
    std::vector<InputFile> inputs = verdict.header.inputs;
    const std::filesystem::path report = run.run_dir() / "report.json";
    if (std::filesystem::exists(report)) {
        const Header reported = reported_files(read_file(report), report.string());
        for (const InputFile& subject : reported.inputs)
            if (std::ranges::find(inputs, subject.file, &InputFile::file) == inputs.end())
                inputs.push_back(subject);
    }
    for (const InputFile& input : inputs) {
        const std::filesystem::path name(input.file);
        if (name.has_parent_path() || !std::filesystem::is_regular_file(run.run_dir() / name))
            missing.push_back(input.file);
        else
            run.note_file(input.role, input.file);
    }
    return missing;
}

/// Adds what was answered since the verdict was made, and where each rule stands by it. Returns
/// whether second files count.
bool add_answers(Verdict& verdict, const std::filesystem::path& run_dir, Options& options) {
    if (options.roster.empty() && envelope_files(run_dir).empty()) return false;
    const RunStanding standing =
        stated_standing(run_dir, read_report_facts(run_dir), read_roster(options.roster));
    if (standing.with_files) verdict.profiles = verdict.with_files;
    for (const RuleStanding& rule : standing.rules) {
        options.what.vouched_by = rule.state.vouched_by;
        for (ProfileVerdict& profile : verdict.profiles)
            if (profile.profile == rule.profile) profile.standing = rule.state.standing;
        for (const ClauseStanding& clause : rule.clauses)
            options.what.answers[rule.profile + "/" + clause.due.clause] = clause_words(clause);
    }
    return standing.with_files;
}

std::string explain_run(const std::filesystem::path& run_dir, Options& options) {
    StageRun run = open_run("explain", run_dir);
    run.note_attempt();
    Verdict verdict = run.read(products::verdict, read_verdict);
    const std::vector<Profile> profiles = read_claimed_rules(run_dir, run.attempt());
    for (const std::string& claimed : run.attempt().profiles)
        run.note_file("profile", profile_copy_name(claimed));
    const std::vector<std::string> missing = check_inputs(run, verdict);
    const bool with_files = add_answers(verdict, run_dir, options);
    Windows& windows = options.what.windows;
    const Receiver& judged = run.attempt().receivers.front();
    if (std::filesystem::exists(run.run_dir() / run.file_of(products::windows, judged)))
        windows = run.read(products::windows, judged, read_windows);
    if (with_files && !windows.with_files.empty()) windows.profiles = windows.with_files;
    Document document = explained(run.attempt(), verdict, profiles, options.what);
    if (!missing.empty())
        document.sections.push_back(
            {.anchor = "missing",
             .title = "Not checked",
             .blocks = {paragraph(fmt::format("The folder does not hold {}.", listed(missing)))}});
    return document_text(document, terminal_columns());
}

/// The rules that come with the program, or the one of that id.
std::string builtin_profiles_text(const Options& options) {
    const std::string& wanted = options.what.profile;
    std::vector<Profile> profiles;
    for (const std::string& name : builtin_profiles())
        if (wanted.empty() || name == wanted)
            profiles.push_back(read_profile(builtin_profile(name), name + ".yaml"));
    if (profiles.empty())
        throw Failure(
            "--profile",
            fmt::format("no profile \"{}\" comes with the program", escape_for_message(wanted)),
            fmt::format("Use one of: {}", fmt::join(builtin_profiles(), ", ")));
    return options.clauses ? citations_text(profiles)
                           : document_text(profiles_document(profiles), terminal_columns());
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, explain_program.summary,
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder that certify wrote, or a bundle of one");
            line.text("CLAUSE", options.what.clause,
                      "flat-course, nalsa/flat-course, or outcome (default: all in short)");
            line.text("--profile", options.what.profile, "id of the profile (default: all)");
            line.text("--roster", options.roster, "whose answers and signatures count");
            line.flag("--profiles", options.profiles,
                      "list the profiles that come with the program");
            line.flag("--clauses", options.clauses,
                      "with --profiles: a table of their clauses, and where each is known from");
            line.flag("--inputs", options.inputs,
                      "list who says what of an attempt, and who answers for it");
            line.footer(
                "Of a clause: its text and source, how its figure is computed and compared, the "
                "figures\nwith their uncertainties, the limit, what the attempt replaced, the "
                "outcome, and what a\nofficial must attest where the recording does not decide. "
                "`outcome` or `decision` as\nCLAUSE explains how the record was compared with. "
                "Hashes are checked; nothing is written.");
        },
        [&]() -> int {
            require_own_roster(options.roster, options.run_dir);
            if (options.clauses && !options.profiles)
                throw Failure("--clauses", "it is about the profiles that come with the program",
                              "Give --profiles, too");
            if (options.profiles || options.inputs) {
                if (!options.run_dir.empty())
                    throw Failure("the command line",
                                  fmt::format("RUN_DIR excludes {}",
                                              options.profiles ? "--profiles" : "--inputs"),
                                  "See --help");
                fmt::print("{}",
                           options.profiles ? builtin_profiles_text(options) : inputs_table_text());
                return 0;
            }
            if (options.run_dir.empty())
                throw Failure("the command line", "no run folder is named",
                              "Name a folder that `runcert certify` wrote, or give --profiles or "
                              "--inputs");
            return read_given(options.run_dir, [&](const std::filesystem::path& run_dir) {
                fmt::print("{}", explain_run(run_dir, options));
                return 0;
            });
        });
}
