#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>

#include "commands.h"
#include "core/plain_text.h"
#include "core/prose.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/file_sync.h"
#include "files/program.h"
#include "files/yaml_input.h"
#include "run/attempt_files.h"
#include "run/chain.h"
#include "run/run_times.h"
#include "schemas/attempt/attempt.h"
#include "schemas/common/members.h"
#include "schemas/common/product_files.h"
#include "schemas/verdict/declared.h"
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
};

Outcome outcome_of(const YamlValue& profile) {
    return member::read<Outcome>(profile["outcome"]);
}

/// A speed of the verdict in km/h, rounded once, from the figure with the most digits.
std::string in_km_h(const YamlValue& speed_m_s) {
    return format_fixed(speed_m_s.real() * 3.6, 3);
}

/// The speed as the rule writes it, and in km/h where that is another unit.
void print_speed(const YamlValue& profile) {
    if (!profile["speed_m_s"].exists()) return;
    const double k = profile["coverage_factor"].real();
    const std::string km_h = fmt::format("{} km/h +/- {} km/h", in_km_h(profile["speed_m_s"]),
                                         in_km_h(profile["expanded_uncertainty_m_s"]));
    const YamlValue shown = profile["shown"];
    if (!shown.exists()) {
        fmt::print("  speed    {} (k = {:.2f})\n", km_h, k);
        return;
    }
    const std::string unit = shown["unit"].text();
    fmt::print("  speed    {} {} +/- {} {} (k = {:.2f}){}\n", shown["speed"].text(), unit,
               shown["expanded_uncertainty"].text(), unit, k, unit == "km/h" ? "" : "; " + km_h);
    const YamlValue decision = profile["decision"];
    if (decision.exists() && outcome_of(profile) != Outcome::not_certifiable)
        fmt::print("  required {} {}: conformance probability {} (at least {} required)\n",
                   shown["required_speed"].text_or("?"), unit,
                   probability_text(decision["probability"].real()),
                   level_text(decision["level"].real()));
}

void print_window(const YamlValue& window) {
    if (!window.exists()) return;
    fmt::print("  window   {} s from {} s{}\n", format_fixed(window["duration_s"].real(), 3),
               format_fixed(window["start_time_s"].real(), 3),
               window["start_utc"].exists() ? " (" + window["start_utc"].text() + ")" : "");
}

void print_refused(const YamlValue& indicated) {
    if (!indicated.exists()) return;
    std::string refusals;
    for (const YamlValue& refusal : indicated["refusals"].list())
        refusals += (refusals.empty() ? "" : "; ") + refusal.text();
    fmt::print("  refused  {} km/h at {} s: {}\n", in_km_h(indicated["speed_m_s"]),
               format_fixed(indicated["start_time_s"].real(), 3), plain_text(refusals));
}

/// What must be read with the verdict, the first of it.
void print_notes(const YamlValue& profile, const fs::path& run_dir) {
    constexpr std::size_t most = 5;
    if (!profile["notes"].exists()) return;
    const std::vector<YamlValue> notes = profile["notes"].list();
    for (std::size_t i = 0; i < std::min(most, notes.size()); ++i)
        fmt::print("  note     {}\n", plain_text(notes[i].text()));
    if (notes.size() > most)
        fmt::print("  ... and {} more: runcert explain {}\n", notes.size() - most,
                   run_dir.string());
}

/// Clauses of that status.
std::vector<std::string> clauses_of(const YamlValue& profile, RequirementStatus status) {
    std::vector<std::string> clauses;
    for (const YamlValue& requirement : profile["requirements"].list())
        if (requirement["status"].text() == to_text(status))
            clauses.push_back(plain_text(requirement["clause"].text()));
    return clauses;
}

/// Prints one profile's verdict, to be read in five seconds. Returns whether the record is beaten.
bool print_verdict(const YamlValue& profile, const fs::path& run_dir) {
    const Outcome outcome = outcome_of(profile);
    fmt::print("\n{}  {}\n", upper_case(words_of(outcome)), profile["profile"].text());
    print_speed(profile);
    print_window(profile["window"]);
    fmt::print("  why      {}\n", plain_text(profile["reason"].text()));
    print_refused(profile["indicated"]);
    print_notes(profile, run_dir);
    if (const auto attest = clauses_of(profile, RequirementStatus::attest); !attest.empty())
        fmt::print("  attest   {}\n", fmt::join(attest, ", "));
    if (const auto failed = clauses_of(profile, RequirementStatus::not_met); !failed.empty())
        fmt::print("  not met  {}\n  explain  runcert explain {} {}\n", fmt::join(failed, ", "),
                   shell_word(run_dir.string()),
                   shell_word(profile["profile"].text() + "/" + failed.front()));
    return outcome == Outcome::beaten;
}

bool print_verdicts(const fs::path& run_dir, bool signed_report, bool rendered) {
    const fs::path file = run_dir / products::verdict_file;
    const YamlValue verdict(parse_yaml(read_file(file), file.string()), file.string());
    bool all_beaten = true;
    for (const YamlValue& profile : verdict["profiles"].list())
        all_beaten = print_verdict(profile, run_dir) && all_beaten;
    if (!verdict["georeferenced"].boolean())
        fmt::print(
            "\nnote     not georeferenced: engineering coordinates, whose scale on the ground is "
            "not stated\n");
    fmt::print("\nreport   {}{}\n", (run_dir / (rendered ? "report.html" : "report.json")).string(),
               signed_report ? " (signed)" : " (UNSIGNED: give --key to sign it)");
    return all_beaten;
}

void print_stage(const StageDone& stage) {
    const std::string said = stage.said.empty() ? "" : plain_text(stage.said.front());
    fmt::print("{:<8} {:<72} {:>6.2f} s\n", stage.name, said, stage.seconds);
    for (std::size_t i = 1; i < stage.said.size(); ++i)
        fmt::print("{:<8} {}\n", "", plain_text(stage.said[i]));
    std::fflush(stdout);
}

int certify(const CertifyOptions& options) {
    const std::time_t started = std::time(nullptr);
    const Attempt attempt = read_attempt(read_handwritten(options.attempt), options.attempt);
    std::optional<SecretKey> key;
    std::string role;
    if (!options.key.empty()) {
        role = signing_role(attempt);
        key = load_secret_key(options.key);
    }
    const fs::path run_dir =
        options.out.empty() ? fs::path("out") / attempt.id : fs::path(options.out);
    StagingFolder staging(run_dir);
    std::vector<StageDone> stages;
    const auto done = [&](const StageDone& stage) {
        StageDone shown = stage;
        if (stage.name == "check") shown.said = {"verdict below"};
        print_stage(shown);
        stages.push_back(stage);
    };
    try {
        run_stages(options.attempt, staging.path(), {}, done);
        const StepCall call{.attempt = staging.path() / attempt_copy_name,
                            .run_dir = staging.path(),
                            .pdf = !options.no_pdf};
        const ProcessOptions unsynced{.environment = {synced_by_caller()}};
        StageDone written = run_step("report", call, unsynced);
        if (key) sign_report(staging.path(), read_report_facts(staging.path()), *key, role);
        if (!options.no_render) {
            const StageDone rendered = run_step("render", call, unsynced);
            written.seconds += rendered.seconds;
            written.said = rendered.said;
        }
        done(written);
    } catch (const StageFailed& failed) {
        fmt::print(stderr, "{}", failed.errors);
        return 2;
    }
    write_file_unsynced(staging.path() / "run.yaml", run_times_text(started, stages));
    staging.publish();
    return print_verdicts(run_dir, key.has_value(), !options.no_render) ? 0 : 1;
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
    command->add_flag("--no-render", options->no_render, "stop after report.json: no HTML, no PDF");
    command->footer(fmt::format(
        "Exit status: 0 every profile says beaten, 1 one does not, 2 it could not be done.\n"
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
