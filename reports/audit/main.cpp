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
#include "trust/verification.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string html;
    WalkOptions walk;
};

void require_known(const std::string& option, const std::string& word,
                   const std::vector<std::string>& known, const std::string& what) {
    if (std::ranges::find(known, word) != known.end()) return;
    throw Failure(option, fmt::format("{} \"{}\"", what, escape_for_message(word)),
                  fmt::format("Choose one of: {}", fmt::join(known, ", ")));
}

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

Document audit(const Options& options) {
    for (const std::string& stage : options.walk.stages)
        require_known("--stage", stage, audited_stages(), "there is no stage");
    StageRun run = open_run("audit", options.run_dir);
    RunRecord record{read_run_view(run, Reading::what_is_there)};
    record.signatures = signatures_in(options.run_dir);
    read_report(run, record);
    if (holds_nothing(record))
        throw Failure(options.run_dir, "the folder holds no file of any stage",
                      "Name a folder that `runcert certify` wrote");
    std::vector<std::string> receivers;
    for (const Receiver& receiver : record.attempt.receivers)
        receivers.push_back(receiver.id);
    if (!options.walk.receiver.empty())
        require_known("--receiver", options.walk.receiver, receivers,
                      "the attempt has no receiver");
    return walk_through(record, options.walk);
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, "audit", "A walk through a run: every input, decision and result",
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder of a certified run",
                      CommandLine::Need::required);
            line.texts("--stage", options.walk.stages, "this stage alone (may be repeated)");
            line.text("--receiver", options.walk.receiver, "which receiver (default: all)");
            line.flag("--all", options.walk.all, "hashes, parameters and epochs used in full");
            line.text("--html", options.html, "write the walk to this file, as one page");
        },
        [&]() -> int {
            const Document walk = audit(options);
            if (options.html.empty()) {
                fmt::print("{}", document_text(walk, terminal_columns()));
                return 0;
            }
            write_file_atomically(options.html, document_page(walk));
            fmt::print("{}\n", escape_for_message(options.html, options.html.size()));
            return 0;
        });
}
