#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/failure.h"
#include "core/text.h"
#include "reports/audit/record.h"
#include "reports/document/document_html.h"
#include "reports/document/document_text.h"
#include "reports/run/reader/read_run.h"
#include "run/reported_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "trust/bundle.h"
#include "trust/verification.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string html;
    WalkOptions walk;
};

/// The files beside report.json that carry its name.
std::vector<std::string> signatures_in(const std::filesystem::path& run_dir) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(run_dir))
        if (entry.path().filename().string().starts_with("report.json."))
            files.push_back(entry.path().filename().string());
    std::ranges::sort(files);
    return files;
}

/// What report.json says of itself: its subjects are what it was made from.
void read_report(StageRun& run, RunRecord& record) {
    const std::string file = "report.json";
    if (!std::filesystem::exists(run.run_dir() / file)) return;
    run.note_file("report", file);
    const ReportFacts facts = read_report_facts(run.run_dir());
    record.report_id = facts.report_id;
    Header& header = record.report.emplace(reported_files(facts.text, file));
    header.stage = "report";
    header.program_version = facts.program_version;
    header.source_revision = facts.source_revision;
    for (const InputFile& subject : header.inputs) {
        record.named_by[subject.file].push_back(file);
        if (subject.file.find('/') == std::string::npos &&
            std::filesystem::exists(run.run_dir() / subject.file))
            run.note_file("subject", subject.file);
    }
    run.note_expected(file, header);
    record.files = run.inputs();
}

Document audit(const std::filesystem::path& run_dir, const Options& options) {
    const std::vector<std::string>& known = audited_stages();
    for (const std::string& stage : options.walk.stages)
        if (std::ranges::find(known, stage) == known.end())
            throw Failure("--stage",
                          fmt::format("there is no stage \"{}\"", escape_for_message(stage)),
                          fmt::format("Choose one of: {}", fmt::join(known, ", ")));
    StageRun run = open_run("audit", run_dir);
    RunRecord record{read_run_view(run, Reading::what_is_there)};
    record.signatures = signatures_in(run_dir);
    read_report(run, record);
    if (holds_nothing(record))
        throw Failure(run_dir.string(), "the folder holds no file of any stage",
                      "Name a folder that `runcert certify` wrote");
    if (!options.walk.receiver.empty()) receiver_of(record.attempt, options.walk.receiver);
    return walk_through(record, options.walk);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, audit_program.summary,
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder that certify wrote, or a bundle of one",
                      CommandLine::required);
            line.texts("--stage", options.walk.stages,
                       "import, enu, screen, smooth, window or check alone (may be repeated)");
            line.text("--receiver", options.walk.receiver, "id of the receiver (default: all)");
            line.flag("--all", options.walk.all,
                      "nothing cut: hashes in full, every parameter, the epochs used one by one");
            line.text("--html", options.html,
                      "write the walk to this file as one page, instead of printing it");
            line.footer(
                "What the run is and who made its files; then for each stage and receiver what "
                "came in,\nwith its hash, what went out, every decision with its evidence and its "
                "line in the\nrecording, and every parameter or figure of a rule that the attempt "
                "replaced. Files that\nare missing are named. Every hash that a file names of "
                "another is computed again; one\nthat does not hold ends the audit with status 2. "
                "In the run folder nothing is written.");
        },
        [&]() -> int {
            return read_given(options.run_dir, [&](const std::filesystem::path& run_dir) {
                const Document walk = audit(run_dir, options);
                if (options.html.empty()) {
                    fmt::print("{}", document_text(walk, terminal_columns()));
                    return 0;
                }
                write_file_atomically(options.html, document_page(walk));
                fmt::print("{}\n", escape_for_message(options.html, options.html.size()));
                return 0;
            });
        });
}
