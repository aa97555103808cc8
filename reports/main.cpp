#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "files/atomic_file.h"
#include "files/sha256.h"
#include "reports/report_html.h"
#include "reports/report_run.h"
#include "run/evidence.h"
#include "run/signing.h"
#include "run/stage_main.h"

using namespace runcert;

namespace {

/// Every file that the stages read or wrote becomes a subject, in the order in which the chain
/// made them.
class Gatherer {
  public:
    Gatherer(StageRun& run, ReportInputs& inputs) : run_(run), inputs_(inputs) {}

    template <class Reader>
    auto product(const std::string& role, const std::string& file, Reader reader) {
        auto result = run_.read(role, file, reader);
        subject(role, file, {});
        return result;
    }

    void subject(const std::string& role, const std::string& file, const std::string& original) {
        const FileDigest digest = digest_file(run_.run_dir() / file);
        inputs_.subjects.push_back({.role = role,
                                    .file = file,
                                    .sha256 = digest.sha256,
                                    .bytes = digest.bytes,
                                    .original = original == file ? "" : original});
    }

  private:
    StageRun& run_;
    ReportInputs& inputs_;
};

ReceiverResults gather_receiver(Gatherer& files, const Attempt& attempt, const Receiver& receiver) {
    const auto name = [&](std::string_view stem, std::string_view extension) {
        return product_file(attempt, receiver, stem, extension);
    };
    files.subject("recording", evidence_recording_file(receiver),
                  std::filesystem::path(receiver.recording).filename().string());
    ReceiverResults results;
    results.observations =
        files.product("observations", name("1-observations", "ecsv"), read_observations);
    results.enu_header = files.product("enu", name("2-enu", "ecsv"), read_enu).header;
    results.screened = files.product("screened", name("3-screened", "ecsv"), read_screened);
    results.trajectory = files.product("trajectory", name("4-trajectory", "ecsv"), read_trajectory);
    results.windows = files.product("windows", name("5-windows", "yaml"), read_windows);
    return results;
}

ReportInputs gather(StageRun& run) {
    ReportInputs inputs;
    inputs.attempt = run.attempt();
    Gatherer files(run, inputs);
    files.subject("attempt", std::string(evidence_attempt_file), {});
    for (const std::string& claimed : run.attempt().profiles) {
        inputs.profiles.push_back(read_claimed_profile(run.run_dir(), claimed));
        files.subject("profile", evidence_profile_file(claimed), {});
    }
    for (const Receiver& receiver : run.attempt().receivers)
        inputs.receivers.push_back(gather_receiver(files, run.attempt(), receiver));
    inputs.verdict = files.product("verdict", "6-verdict.yaml", read_verdict);
    return inputs;
}

/// The signature that goes with the report, if there is one. Whether it holds is for
/// `runcert verify` to say, with the signer's public key.
std::vector<ReportSigner> signers_of(const std::filesystem::path& run_dir) {
    const std::filesystem::path file = run_dir / "report.json.minisig";
    if (!std::filesystem::exists(file)) return {};
    return {read_signer(read_file(file), file.string())};
}

/// A new report makes the signature of an earlier one void.
void write_report(const StageRun& run, const std::string& report) {
    std::filesystem::remove(run.run_dir() / "report.json.minisig");
    run.write("report.json", report);
}

}  // namespace

int main(int argc, char** argv) {
    std::string key;
    bool no_render = false;
    bool render_only = false;
    return stage_main(
        argc, argv, "report", "The measurement report: report.json, and from it HTML and PDF",
        [&](StageRun& run) {
            run.note_attempt();
            if (!render_only) write_report(run, write_report_json(gather(run)));
            if (!key.empty())
                sign_report(run.run_dir(), load_secret_key(key), signing_role(run.attempt()));
            if (no_render) {
                run.say("report.json");
                return;
            }
            render_report(run.run_dir(), read_file(run.run_dir() / "report.json"),
                          {.signers = signers_of(run.run_dir())});
            run.say("report.json, report.html, report.pdf");
        },
        [&](CLI::App& app) {
            app.add_option("--key", key, "secret key to sign report.json with");
            app.add_flag("--no-render", no_render, "stop after report.json");
            app.add_flag("--render-only", render_only, "HTML and PDF of the report.json there is");
        });
}
