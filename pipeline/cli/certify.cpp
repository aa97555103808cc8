#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>

#include "commands.h"
#include "core/text.h"
#include "files/atomic_file.h"
#include "files/program.h"
#include "files/yaml_input.h"
#include "files/yaml_output.h"
#include "run/chain.h"
#include "run/signing.h"
#include "schemas/attempt/attempt.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct CertifyOptions {
    std::string attempt;
    std::string out;
    std::string key;
    bool no_render = false;
};

/// run.yaml: when and how long; no other file depends on it.
std::string run_record(std::time_t started, const std::vector<StageDone>& stages) {
    nlohmann::ordered_json record;
    record["program"] = program_version();
    record["source_revision"] = source_revision();
    record["started_unix_s"] = started;
    for (const StageDone& stage : stages)
        record["stages"].push_back(
            {{"stage", stage.name}, {"seconds", rounded(stage.seconds, 3)}, {"said", stage.said}});
    return to_yaml_text(record);
}

std::string in_capitals(std::string word) {
    for (char& c : word) {
        if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
        if (c == '_') c = ' ';
    }
    return word;
}

/// A speed of the verdict in km/h, rounded once, from the figure with the most digits.
std::string in_km_h(const YamlValue& speed_mps) {
    return format_fixed(speed_mps.real() * 3.6, 3);
}

/// Prints one profile's verdict, to be read in five seconds. Returns whether the record is beaten.
bool print_verdict(const YamlValue& profile) {
    const std::string outcome = profile["outcome"].text();
    fmt::print("\n{}  {}\n", in_capitals(outcome), profile["profile"].text());
    if (profile["speed_km_h"].exists())
        fmt::print("  speed    {} km/h +/- {} km/h (k = {:.2f})\n", in_km_h(profile["speed_m_s"]),
                   in_km_h(profile["expanded_uncertainty_m_s"]), profile["coverage_factor"].real());
    if (const YamlValue window = profile["window"]; window.exists())
        fmt::print("  window   {} s from {} s{}\n", format_fixed(window["duration_s"].real(), 3),
                   format_fixed(window["start_time_s"].real(), 3),
                   window["start_utc"].exists() ? " (" + window["start_utc"].text() + ")" : "");
    fmt::print("  why      {}\n", profile["reason"].text());
    if (const YamlValue indicated = profile["indicated"]; indicated.exists()) {
        std::string refusals;
        for (const YamlValue& refusal : indicated["refusals"].list())
            refusals += (refusals.empty() ? "" : "; ") + refusal.text();
        fmt::print("  refused  {} km/h at {} s: {}\n", in_km_h(indicated["speed_m_s"]),
                   format_fixed(indicated["start_time_s"].real(), 3), refusals);
    }
    std::string attest;
    for (const YamlValue& requirement : profile["requirements"].list())
        if (requirement["status"].text() == "attest")
            attest += (attest.empty() ? "" : ", ") + requirement["clause"].text();
    if (!attest.empty()) fmt::print("  attest   {}\n", attest);
    return outcome == "beaten";
}

bool print_verdicts(const fs::path& run_dir, bool signed_report, bool rendered) {
    const fs::path file = run_dir / "6-verdict.yaml";
    const YamlValue verdict(parse_yaml(read_file(file), file.string()), file.string());
    bool all_beaten = true;
    for (const YamlValue& profile : verdict["profiles"].list())
        all_beaten = print_verdict(profile) && all_beaten;
    if (!verdict["georeferenced"].boolean())
        fmt::print(
            "\nnote     not georeferenced: local-plane coordinates, whose scale on the ground is "
            "not stated\n");
    fmt::print("\nreport   {}{}\n", (run_dir / (rendered ? "report.html" : "report.json")).string(),
               signed_report ? " (signed)" : " (UNSIGNED: give --key to sign it)");
    return all_beaten;
}

void print_stage(const StageDone& stage) {
    const std::string said = stage.said.empty() ? "" : stage.said.front();
    fmt::print("{:<8} {:<72} {:>6.2f} s\n", stage.name, said, stage.seconds);
    for (std::size_t i = 1; i < stage.said.size(); ++i)
        fmt::print("{:<8} {}\n", "", stage.said[i]);
    std::fflush(stdout);
}

int certify(const CertifyOptions& options) {
    const std::time_t started = std::time(nullptr);
    const Attempt attempt = read_attempt(read_handwritten(options.attempt), options.attempt);
    std::optional<SecretKey> key;
    if (!options.key.empty()) key = load_secret_key(options.key);
    const fs::path run_dir =
        options.out.empty() ? fs::path("out") / attempt.id : fs::path(options.out);
    Workshop workshop(run_dir);
    std::vector<StageDone> stages;
    const auto done = [&](const StageDone& stage) {
        StageDone shown = stage;
        if (stage.name == "check") shown.said = {"verdict below"};
        print_stage(shown);
        stages.push_back(stage);
    };
    try {
        run_stages(options.attempt, workshop.path(), {}, done);
        const std::vector<std::string> report{"--attempt",
                                              (workshop.path() / "attempt.yaml").string(),
                                              "--run-dir", workshop.path().string()};
        auto with = [&](const char* flag) {
            auto arguments = report;
            arguments.emplace_back(flag);
            return arguments;
        };
        StageDone written = run_stage("report", with("--no-render"));
        if (key) sign_report(workshop.path(), *key, signing_role(attempt));
        if (!options.no_render) {
            const StageDone rendered = run_stage("report", with("--render-only"));
            written.seconds += rendered.seconds;
            written.said = rendered.said;
        }
        done(written);
    } catch (const StageFailed& failed) {
        fmt::print(stderr, "{}", failed.errors);
        return 2;
    }
    write_file_atomically(workshop.path() / "run.yaml", run_record(started, stages));
    workshop.publish();
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
    command->add_flag("--no-render", options->no_render, "stop after report.json: no HTML, no PDF");
    command->footer(fmt::format(
        "Exit status: 0 every profile says beaten, 1 one does not, 2 it could not be done.\n\n"
        "An attempt (schema attempt/1.3; examples/ has some that run as they are):\n\n"
        "  schema: attempt/1.3\n"
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
