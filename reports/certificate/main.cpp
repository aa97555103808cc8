#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_html.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports/run/reader/read_run.h"
#include "run/stage_main.h"
#include "schemas/common/product_files.h"
#include "schemas/phase/declared.h"
#include "schemas/screened_phase/declared.h"
#include "store/atomic_file.h"
#include "trust/attestation.h"
#include "trust/receipt.h"
#include "trust/signature_files.h"
#include "trust/signing.h"
#include "witness/surface_input.h"

using namespace runcert;

namespace {

/// The phases of the judged receiver around the first certified window.
void view_phases(StageRun& run, ReportInputs& inputs) {
    constexpr double around_s = 10.0;
    const ReceiverResults& results = inputs.receivers.front();
    const auto entry = std::ranges::find_if(
        results.windows.profiles, [](const ProfileWindows& one) { return one.best.has_value(); });
    const ScreenedTable& screened = results.screened;
    if (!results.phase || entry == results.windows.profiles.end() || !screened.facts.first_epoch)
        return;
    auto phases = run.open(products::phase, results.receiver, open_phase);
    auto judged = run.open(products::screened_phase, results.receiver, open_screened_phase);
    const GpsTime first = phases.head().first_epoch;
    const WindowSpan& span = entry->best->span;
    const double start_s =
        span.start.seconds() +
        static_cast<double>(screened.facts.first_epoch->nanoseconds_since(first)) * 1e-9;
    inputs.phase_view = phase_view(
        judged_phases(phases, judged,
                      ReceiverTrack(screened.origin, screened.facts.first_epoch, screened.rows),
                      run.attempt().parameters.screen.phase_mask_deg, start_s - around_s,
                      start_s + span.duration.seconds() + around_s),
        first, results.trajectory, span.duration.seconds());
}

/// Reads the whole run. Every file noted on the way becomes a subject of the report.
ReportInputs gather(StageRun& run) {
    ReportInputs inputs{read_run_view(run, Reading::whole)};
    view_phases(run, inputs);
    for (const Receiver& receiver : run.attempt().receivers)
        inputs.handed_in.push_back(receipt_text(receiver, run.run_dir()));
    const ReceiverResults& judged = inputs.receivers.front();
    if (has_surface(judged.receiver))
        inputs.surface = surface_of(run.read(products::surface, judged.receiver, read_surface),
                                    judged.screened.origin);
    return inputs;
}

/// Where the run stands by its attestations, for the pages.
std::string standing_of(const std::filesystem::path& run_dir, const std::string& roster) {
    if (roster.empty() && envelope_files(run_dir).empty()) return "{}\n";
    const ReportFacts report = read_report_facts(run_dir);
    return report_text_of(standing_json(stated_standing(run_dir, report, read_roster(roster)),
                                        report.json->at("predicate")));
}

std::filesystem::path report_of(const StageRun& run) {
    return run.run_dir() / "report.json";
}

/// Signatures of an unchanged report stand; those of another one are void.
void write_report(const StageRun& run, const std::string& report) {
    const std::filesystem::path file = report_of(run);
    if (!std::filesystem::exists(file) || read_file(file) != report)
        supersede_signatures(run.run_dir());
    run.write("report.json", report);
}

}  // namespace

int main(int argc, char** argv) {
    std::string key;
    std::string roster;
    bool no_render = false;
    std::vector<std::string> pages;
    bool render_only = false;
    bool wait = false;
    std::optional<Rendering> rendering;
    return stage_main(
        argc, argv, "report", "The measurement report: report.json, and from it HTML and PDF",
        [&](StageRun& run) {
            if (!render_only) write_report(run, write_report_json(gather(run)));
            if (!key.empty())
                sign_report(run.run_dir(), read_report_facts(run.run_dir()), load_secret_key(key),
                            signing_role(run.attempt()));
            if (no_render) {
                run.say("report.json");
                return;
            }
            // Whether the signatures hold is for `runcert verify` to say.
            rendering->write(run.run_dir(), read_file(report_of(run)),
                             {.signatures = signature_files(run.run_dir()),
                              .standing = standing_of(run.run_dir(), roster)});
            run.say(fmt::format("report.json, {}", fmt::join(pages, ", ")));
        },
        [&](CommandLine& line) {
            line.text("--key", key, "secret key to sign report.json with");
            line.text("--roster", roster, "whose answers and signatures the pages count");
            line.flag("--no-render", no_render, "stop after report.json");
            line.texts("--page", pages, "a page to write, such as report.html (default: all)");
            line.flag("--render-only", render_only, "pages of the report.json there is");
            line.flag("--wait", wait, "begin when a byte comes on standard input");
        },
        [&] {
            if (pages.empty()) pages.assign(page_names.begin(), page_names.end());
            if (!no_render) rendering.emplace(pages);
            if (wait && std::getchar() == EOF)
                throw Failure("standard input", "it ended before a byte came", "Leave --wait out");
        });
}
