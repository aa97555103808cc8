#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <filesystem>

#include "commands.h"
#include "core/text.h"
#include "reports/words/attempt.h"
#include "reports/words/decision.h"
#include "reports/words/figures.h"
#include "reports/words/outcome.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "run/staging_folder.h"
#include "run/steps.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
#include "store/atomic_file.h"
#include "store/external_program.h"
#include "store/program.h"
#include "trust/signature_files.h"
#include "trust/signing.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct CertifyOptions {
    std::string attempt;
    std::string out;
    std::string key;
    bool no_render = false;
    bool no_pdf = false;
    bool brief = false;
};

/// The speed as it is to be read, and what it had to reach.
void print_speed(const ProfileVerdict& verdict) {
    const auto& own = verdict.own_arithmetic;
    const std::string by_rule =
        own && !own->shown.empty() ? own->shown + " by the rule's own arithmetic" : std::string();
    if (!verdict.speed_m_s) {
        if (!by_rule.empty()) fmt::print("  speed    none measured; {}\n", by_rule);
        return;
    }
    const ShownFigures shown = shown_of(verdict, "km/h");
    fmt::print("  speed    {}\n", measured_speed_text(shown, verdict.coverage_factor));
    if (!by_rule.empty()) fmt::print("           {}\n", by_rule);
    if (!verdict.decision || verdict.outcome == Outcome::not_certifiable) return;
    fmt::print("  required {} {}; acceptance limit {} {}\n", shown.required_speed, shown.unit,
               shown.acceptance_limit, shown.unit);
    fmt::print("           conformance probability {} (at least {} required)\n",
               probability_text(verdict.decision->probability),
               level_text(verdict.decision->level));
    for (const std::string& more : decision_sentences(verdict, speed_unit(shown.unit)))
        fmt::print("           {}\n", more);
}

void print_window(const WindowSpan& span) {
    fmt::print("  window   {} from {}{}\n", seconds_text(span.duration), seconds_text(span.start),
               span.start_gps ? " (" + to_utc_iso(*span.start_gps, 3) + ")" : "");
}

void print_refused(const ProfileVerdict& verdict) {
    const RefusedWindow& indicated = *verdict.indicated;
    fmt::print(
        "  refused  {} at {}: {}\n",
        speed_beside(verdict, indicated.speed_m_s, verdict.shown ? verdict.shown->unit : "km/h"),
        seconds_text(indicated.span.start),
        plain_text(fmt::format("{}", fmt::join(indicated.refusals, "; "))));
}

/// What must be read with the verdict, the first of it.
void print_notes(const std::vector<std::string>& notes, const fs::path& run_dir) {
    constexpr std::size_t most = 5;
    for (std::size_t i = 0; i < std::min(most, notes.size()); ++i)
        fmt::print("  note     {}\n", plain_text(notes[i]));
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

/// Prints one profile's verdict, to be read in five seconds. Returns whether the record is beaten.
bool print_verdict(const ProfileVerdict& verdict, const Attempt& attempt, const fs::path& run_dir) {
    fmt::print("\n{}: {}\n", verdict.profile, outcome_words(state_of(verdict)).title);
    print_speed(verdict);
    if (verdict.decision && verdict.outcome != Outcome::not_certifiable)
        fmt::print("           {}\n",
                   plain_text(agreement_text(attempt.decision_rule_agreed, verdict.window)));
    if (verdict.window) print_window(*verdict.window);
    for (const std::string& witness : verdict.witnesses)
        fmt::print("  witness  {}\n", plain_text(witness));
    if (verdict.unseen_drift_m_s)
        fmt::print("  witness  none. {}\n", positions_alone_text(*verdict.unseen_drift_m_s));
    fmt::print("  why      {}\n", plain_text(verdict.reason));
    if (verdict.indicated) print_refused(verdict);
    print_notes(verdict.notes, run_dir);
    fmt::print("  standing {}\n", standing_text(verdict.standing));
    if (const auto attest = clauses_of(verdict, RequirementStatus::attest); !attest.empty())
        fmt::print("  attest   {}\n", fmt::join(attest, ", "));
    if (const auto failed = clauses_of(verdict, RequirementStatus::not_met); !failed.empty())
        fmt::print("  not met  {}\n  explain  runcert explain {} {}\n", fmt::join(failed, ", "),
                   shell_word(run_dir.string()),
                   shell_word(verdict.profile + "/" + failed.front()));
    return verdict.outcome == Outcome::beaten;
}

Verdict verdict_in(const fs::path& run_dir) {
    const fs::path file = run_dir / products::verdict_file;
    return read_verdict(read_file(file), file.string());
}

bool print_verdicts(const Verdict& verdict, const Attempt& attempt, const fs::path& run_dir) {
    bool all_beaten = true;
    for (const ProfileVerdict& profile : verdict.profiles)
        all_beaten = print_verdict(profile, attempt, run_dir) && all_beaten;
    if (!verdict.georeferenced)
        fmt::print(
            "\nnote     not georeferenced: engineering coordinates, whose scale on the ground is "
            "not stated\n");
    if (const std::string missing = missing_sandbox(); !missing.empty())
        fmt::print("\nnote     {}\n", plain_text(missing));
    fmt::print("\n");
    std::fflush(stdout);
    return all_beaten;
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

int certify(const CertifyOptions& options) {
    const std::time_t started = std::time(nullptr);
    const std::string text = read_handwritten(options.attempt);
    const Attempt attempt = read_attempt(text, options.attempt);
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
                          .sign = [&] {
                              return sign_report(staging.path(), read_report_facts(staging.path()),
                                                 *key, role);
                          }};
    std::vector<StageDone> stages;
    bool all_beaten = false;
    const auto show = [&](const StageDone& stage) {
        StageDone shown = stage;
        if (stage.name == "check") shown.said = {"verdict below"};
        print_stage(shown);
        stages.push_back(stage);
        // The answer is there before anything is drawn.
        if (stage.name == "check")
            all_beaten = print_verdicts(verdict_in(staging.path()), attempt, run_dir);
    };
    StageDone report;  // one to the user, with its pages
    try {
        make_run(
            run, [](const Step&) { return false; },
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
        fmt::print(stderr, "{}", message_of(failed));
        return 2;
    }
    write_file_unsynced(staging.path() / "run.yaml", run_times_text(started, stages));
    const bool is_signed = !signature_files(staging.path()).empty();
    staging.publish();
    fmt::print("         {}{}\n",
               (run_dir / (options.no_render ? "report.json" : "report.html")).string(),
               is_signed ? " (signed)" : " (UNSIGNED: give --key to sign it)");
    return all_beaten ? 0 : 1;
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
    command->footer(fmt::format(
        "Exit status: 0 the outcome of every profile is beaten, 1 one is not, 2 no certificate\n"
        "could be made. It goes by the outcome alone: requirements that remain to be attested and\n"
        "missing signatures do not change it.\n"
        "RUNCERT_THREADS=N in the environment: no more than N threads (left out: one for each\n"
        "processor). The results are the same.\n\n"
        "An attempt (schema attempt/1.0; examples/ has some that run as they are):\n\n"
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
