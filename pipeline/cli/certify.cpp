#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "core/failure.h"
#include "core/prose.h"
#include "core/text.h"
#include "moving_line.h"
#include "recognised.h"
#include "reports/document/document_text.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "run/staging_folder.h"
#include "run/steps.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "schemas/verdict/figures.h"
#include "schemas/verdict/outcome.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/process.h"
#include "store/program.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

constexpr const char* run_times_name = "run.yaml";

struct CertifyOptions {
    std::string attempt;
    std::string out;
    std::string key;
    bool no_render = false;
    bool no_pdf = false;
    bool brief = false;
    bool quiet = false;
    bool json = false;
};

/// A line under a heading, broken at the terminal's width; a file gets it whole.
void say(const std::string& label, const std::string& text) {
    constexpr std::size_t indent = 11;
    fmt::print("  {:<8} ", label);
    if (isatty(STDOUT_FILENO) != 0)
        fmt::print("{}", wrapped(text, indent, indent, terminal_columns()));
    else
        fmt::print("{}\n", plain_text(text));
}

/// The speed as it is to be read, and what it had to reach.
void print_speed(const ProfileVerdict& verdict) {
    const std::string& own = verdict.own_arithmetic.shown;
    const std::string by_rule = own.empty() ? own : own + " by the rule's own arithmetic";
    if (!verdict.speed_m_s) {
        if (!by_rule.empty()) say("speed", "none measured; " + by_rule);
        return;
    }
    const ShownFigures shown = shown_of(verdict, "km/h");
    say("speed", measured_speed_text(shown, verdict.coverage_factor));
    if (!by_rule.empty()) say("", by_rule);
    if (!verdict.decision || verdict.outcome == Outcome::not_certifiable) return;
    say("required", fmt::format("{} {}; acceptance limit {} {}", shown.required_speed, shown.unit,
                                shown.acceptance_limit, shown.unit));
    say("", fmt::format("conformance probability {} (at least {} required)",
                        probability_text(verdict.decision->probability),
                        level_text(verdict.decision->level)));
    for (const std::string& more : decision_sentences(verdict, speed_unit(shown.unit)))
        say("", more);
}

std::string window_text(const WindowSpan& span) {
    return fmt::format("{} from {}{}", seconds_text(span.duration), seconds_text(span.start),
                       span.start_gps ? " (" + to_utc_iso(*span.start_gps, 3) + ")" : "");
}

void print_refused(const ProfileVerdict& verdict) {
    const RefusedWindow& indicated = *verdict.indicated;
    say("refused",
        fmt::format("{} at {}: {}",
                    speed_beside(verdict, indicated.speed_m_s,
                                 verdict.shown ? verdict.shown->unit : "km/h"),
                    seconds_text(indicated.span.start), fmt::join(indicated.refusals, "; ")));
}

/// What must be read with the verdict, the first of it.
void print_notes(const std::vector<std::string>& notes, const fs::path& run_dir) {
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < std::min(most, notes.size()); ++i)
        say("note", notes[i]);
    if (notes.size() > most)
        fmt::print("  ... and {} more: runcert explain {}\n", notes.size() - most,
                   run_dir.string());
}

/// Clauses of that status.
std::vector<std::string> clauses_of(const ProfileVerdict& verdict, RequirementStatus status) {
    std::vector<std::string> clauses;
    for (const Requirement& requirement : verdict.requirements)
        if (requirement.status == status) clauses.push_back(plain_text(requirement.clause));
    return clauses;
}

/// The command that explains what decided.
std::string explain_command(const ProfileVerdict& verdict, const fs::path& run_dir) {
    const auto failed = clauses_of(verdict, RequirementStatus::not_met);
    // What is refused for another reason than a clause is explained by that.
    const bool by_clause = !failed.empty() && (verdict.outcome != Outcome::not_certifiable ||
                                               verdict.reason.starts_with("Not met"));
    return fmt::format("runcert explain {} {}", shell_word(run_dir.string()),
                       by_clause ? shell_word(verdict.profile + "/" + failed.front())
                                 : "decision --profile " + shell_word(verdict.profile));
}

/// Prints one profile's verdict, to be read in five seconds.
void print_verdict(const ProfileVerdict& verdict, const Attempt& attempt, const fs::path& run_dir) {
    fmt::print("\n{}: {}\n", verdict.profile, outcome_words(state_of(verdict)).title);
    print_speed(verdict);
    if (verdict.decision && verdict.outcome != Outcome::not_certifiable)
        say("", agreement_text(attempt.decision_rule_agreed, verdict.window));
    if (verdict.window) say("window", window_text(*verdict.window));
    for (const std::string& witness : verdict.witnesses)
        say("witness", witness);
    if (verdict.unseen_drift_m_s)
        say("witness", (verdict.witnesses.empty() ? "none. " : "none that confirms. ") +
                           positions_alone_text(verdict));
    say("why", verdict.reason);
    if (verdict.indicated) print_refused(verdict);
    print_notes(verdict.notes, run_dir);
    say("standing", standing_text(verdict.standing));
    if (const auto attest = clauses_of(verdict, RequirementStatus::attest); !attest.empty())
        say("attest", fmt::format("{}", fmt::join(attest, ", ")));
    if (const auto failed = clauses_of(verdict, RequirementStatus::not_met); !failed.empty()) {
        say("not met", fmt::format("{}", fmt::join(failed, ", ")));
        fmt::print("  explain  {}\n", explain_command(verdict, run_dir));
    }
}

/// What is read last of what was refused: the reason, the place, what helps.
void print_refusals(const Verdict& verdict, const fs::path& run_dir) {
    for (const ProfileVerdict& profile : verdict.profiles) {
        if (profile.outcome != Outcome::not_certifiable) continue;
        fmt::print("\n{}: {}\n", profile.profile, outcome_words(state_of(profile)).title);
        say("why", profile.reason);
        if (profile.indicated) say("where", window_text(profile.indicated->span));
        fmt::print("  explain  {}\n", explain_command(profile, run_dir));
    }
}

Verdict verdict_in(const fs::path& run_dir) {
    const fs::path file = run_dir / products::verdict_file;
    return read_verdict(read_file(file), file.string());
}

void print_verdicts(const Verdict& verdict, const Attempt& attempt, const fs::path& run_dir) {
    for (const ProfileVerdict& profile : verdict.profiles)
        print_verdict(profile, attempt, run_dir);
    if (!verdict.georeferenced)
        fmt::print(
            "\nnote     not georeferenced: engineering coordinates, whose scale on the ground is "
            "not stated\n");
    if (const std::string missing = missing_sandbox(); !missing.empty())
        fmt::print("\nnote     {}\n", plain_text(missing));
    fmt::print("\n");
    std::fflush(stdout);
}

/// The answer for programs.
void print_json(const Verdict& verdict, const fs::path& run_dir, bool is_signed, int status) {
    nlohmann::ordered_json answer{
        {"run_folder", run_dir.string()}, {"signed", is_signed}, {"exit_status", status}};
    answer["georeferenced"] = verdict.georeferenced;
    for (const ProfileVerdict& profile : verdict.profiles)
        answer["profiles"].push_back(members_json(profile));
    fmt::print("{}\n", answer.dump(2, ' ', true));
}

void print_stage(const StageDone& stage) {
    const std::string said = stage.said.empty() ? "" : plain_text(stage.said.front());
    fmt::print("{:<8} {:<72} {:>6.2f} s\n", stage.name, said, stage.seconds);
    for (std::size_t i = 1; i < stage.said.size(); ++i)
        fmt::print("{:<8} {}\n", "", plain_text(stage.said[i]));
    std::fflush(stdout);
}

/// Whether a step is one that the user sees by itself: not what it takes no time to do.
bool is_shown(const StageDone& step) {
    return !step_named(step.name).program.empty();
}

/// The attempt and its text. What is no attempt may be a recording: the likeliest first try.
std::pair<Attempt, std::string> attempt_in(const std::string& file) {
    try {
        std::string text = read_handwritten(file);
        Attempt attempt = read_attempt(text, file);
        return {std::move(attempt), std::move(text)};
    } catch (const Failure&) {
        const std::string suffix = lower_case(fs::path(file).extension().string());
        if (suffix == ".yaml" || suffix == ".yml" || !fs::is_regular_file(file)) throw;
        const Recognised recognised = recognise(file);
        const Recognition& is = recognised.is;
        // Any text of a few words a line may be a table.
        if (recognised.said.exit_status != 0 || is.kind == RecordingKind::table) throw;
        throw Failure(file,
                      fmt::format("this is a recording ({}), and no attempt",
                                  is.format.empty() ? "a series" : is.format),
                      fmt::format("Write an attempt from it first: runcert new {}",
                                  shell_word(plain_text(file))));
    }
}

int certify(const CertifyOptions& options) {
    const std::time_t started = std::time(nullptr);
    const auto read = attempt_in(options.attempt);
    const Attempt& attempt = read.first;
    const std::string& text = read.second;
    std::optional<SecretKey> key;
    std::string role;
    if (!options.key.empty()) {
        role = signing_role(attempt);
        key = load_secret_key(options.key);
    }
    const fs::path run_dir =
        options.out.empty() ? fs::path("out") / attempt.id : fs::path(options.out);
    StagingFolder staging(run_dir);
    require_a_run(staging.earlier(), inventory_of(attempt).files);
    const RunInMaking run{.attempt = attempt,
                          .text = text,
                          .source = {.file = options.attempt},
                          .folder = staging.path(),
                          .known_as = run_dir,
                          .report = {.render = !options.no_render,
                                     .pdf = !options.no_pdf,
                                     .brief = options.brief,
                                     .signer = options.key},
                          .latest = end_of_tomorrow(started),
                          .sign = [&] {
                              return sign_report(staging.path(), read_report_facts(staging.path()),
                                                 *key, role);
                          }};
    std::vector<StageDone> stages;
    Verdict verdict;
    MovingLine line(options.json || options.quiet ? nullptr : stdout,
                    seconds_of_steps(run_dir / run_times_name));
    const bool says_stages = !options.json && !options.quiet;
    const auto show = [&](const StageDone& stage) {
        StageDone shown = stage;
        stages.push_back(stage);
        if (stage.name == "check") {
            verdict = verdict_in(staging.path());
            shown.said = {"verdict below"};
        }
        line.clear();
        if (says_stages) print_stage(shown);
        // The answer is there before anything is drawn; where time may run out, at the end.
        if (stage.name == (time_is_limited() ? "report" : "check") && !options.json)
            print_verdicts(verdict, attempt, run_dir);
    };
    StageDone report;  // one to the user, with its pages
    try {
        make_run(
            run,
            [&](const Step& step) {
                line.begins(step.name);
                return false;
            },
            [&](const StageDone& done) {
                if (done.name == "report") {
                    report = done;
                    carry_over(staging.earlier(), staging.folder());
                } else if (done.name == "render") {
                    report.seconds += done.seconds;
                    report.said = done.said;
                } else if (is_shown(done)) {
                    show(done);
                }
            });
        show(report);
    } catch (const StageFailed& failed) {
        line.clear();
        fmt::print(stderr, "{}", message_of(failed));
        return 2;
    }
    require_time();
    write_file_unsynced(staging.path() / run_times_name, run_times_text(started, stages));
    const bool is_signed = !signature_files(staging.path()).empty();
    staging.publish();
    const bool all_beaten = std::ranges::all_of(
        verdict.profiles, [](const auto& one) { return one.outcome == Outcome::beaten; });
    const int status = all_beaten ? 0 : 1;
    if (options.json) {
        print_json(verdict, run_dir, is_signed, status);
        return status;
    }
    fmt::print("         {}{}\n",
               (run_dir / (options.no_render ? "report.json" : "report.html")).string(),
               is_signed ? " (signed)" : " (UNSIGNED: give --key to sign it)");
    if (says_stages) print_refusals(verdict, run_dir);
    return status;
}

}  // namespace

void add_certify(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<CertifyOptions>();
    CLI::App* command = app.add_subcommand(
        "certify", "Measure an attempt: recordings in, a signed measurement report out");
    command->add_option("ATTEMPT", options->attempt, "the attempt's file (YAML)")->required();
    command->add_option("--out", options->out, "run folder to write (default: out/ID)");
    command->add_option("--key", options->key, "secret key to sign the report with");
    command->add_flag("--no-pdf", options->no_pdf, "report.json and HTML alone");
    command->add_flag("--brief", options->brief,
                      "of the PDF the first page alone, the certificate");
    command->add_flag("--no-render", options->no_render, "stop after report.json: no HTML, no PDF");
    CLI::Option* quiet = command->add_flag("--quiet", options->quiet,
                                           "print the verdict, and nothing of the stages");
    command->add_flag("--json", options->json, "print one JSON document instead")->excludes(quiet);
    add_time_limit(*command);
    command->footer(fmt::format(
        "Exit status: 0 the outcome of every profile is beaten, 1 one is not, 2 no certificate\n"
        "could be made. It goes by the outcome alone: requirements that remain to be attested and\n"
        "missing signatures do not change it.\n"
        "RUNCERT_THREADS=N in the environment: no more than N threads (left out: one for each\n"
        "processor). The results are the same.\n\n"
        "An attempt (schema attempt/1.0; runcert new RECORDING writes one, and examples/ has some\n"
        "that run as they are):\n\n"
        "  schema: attempt/1.0\n"
        "  id: lake-run-1\n"
        "  craft: {{name: yacht, class: land-yacht}}\n"
        "  officials: [{{role: measurer}}]\n"
        "  receivers:\n"
        "    - {{id: primary, recording: rover.pos}}\n"
        "  record: {{speed: 202.9, unit: km/h, source: where it is published}}\n"
        "  profiles: [nalsa]\n\n"
        "Every key:\n{}",
        attempt_schema().field_table()));
    command->callback([&chosen, options] { chosen = [options] { return certify(*options); }; });
}

}  // namespace runcert
