#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "reports/certificate/report_html.h"
#include "reports/certificate/report_json.h"
#include "reports/certificate/report_run.h"
#include "reports/run/reader/read_run.h"
#include "run/stage_main.h"
#include "schemas/phase/declared.h"
#include "schemas/screened_phase/declared.h"
#include "store/atomic_file.h"
#include "trust/attestation.h"
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
                      ReceiverPlaces(screened.origin, screened.facts.first_epoch, screened.rows),
                      run.attempt().parameters.screen.phase_mask_deg, start_s - around_s,
                      start_s + span.duration.seconds() + around_s),
        first, results.trajectory, span.duration.seconds());
}

/// What the earlier report says of the computer that made it, and stays when it is made again.
void make_as(ReportInputs& inputs, const std::string& earlier) {
    using Json = nlohmann::ordered_json;
    try {
        const Json predicate = Json::parse(read_file(earlier)).at("predicate");
        inputs.program = report_program(predicate);
        inputs.drawn = drawn_figures(predicate);
    } catch (const Json::exception& error) {
        throw Failure(earlier,
                      fmt::format("this is no report: {}", escape_for_message(error.what(), 200)),
                      "Take the original");
    }
}

/// Reads the whole run. Every file noted on the way becomes a subject of the report.
ReportInputs gather(StageRun& run) {
    ReportInputs inputs{read_run_view(run, Reading::whole)};
    view_phases(run, inputs);
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
    std::string as;
    std::string drawings;
    bool draw_only = false;
    bool no_render = false;
    bool no_pdf = false;
    bool brief = false;
    bool render_only = false;
    return stage_main(
        argc, argv, "report", "The measurement report: report.json, and from it HTML and PDF",
        [&](StageRun& run) {
            if (draw_only) return write_drawings(run.run_dir(), read_file(report_of(run)));
            if (!render_only) {
                ReportInputs inputs = gather(run);
                if (!as.empty()) make_as(inputs, as);
                write_report(run, write_report_json(std::move(inputs)));
            }
            if (!key.empty())
                sign_report(run.run_dir(), read_report_facts(run.run_dir()), load_secret_key(key),
                            signing_role(run.attempt()));
            if (no_render) {
                run.say("report.json");
                return;
            }
            // Whether the signatures hold is for `runcert verify` to say.
            render_report(run.run_dir(), read_file(report_of(run)),
                          {.signatures = signature_files(run.run_dir()),
                           .standing = standing_of(run.run_dir(), roster),
                           .pdf = !no_pdf,
                           .brief = brief,
                           .drawings = drawings});
            run.say(no_pdf ? "report.json, report.html" : "report.json, report.html, report.pdf");
        },
        [&](CommandLine& line) {
            line.text("--key", key, "secret key to sign report.json with");
            line.text("--roster", roster, "whose answers and signatures the pages count");
            line.flag("--no-render", no_render, "stop after report.json");
            line.flag("--no-pdf", no_pdf, "no PDF, which takes longest");
            line.flag("--brief", brief, "of the PDF the first page alone");
            line.flag("--render-only", render_only, "HTML and PDF of the report.json there is");
            line.text("--drawings", drawings, "folder of the figures' drawings, else drawn");
            line.flag("--draw-only", draw_only, "the drawings of the report.json there is");
            line.text("--as", as, "report.json that says which program made it, and its drawings");
        });
}
