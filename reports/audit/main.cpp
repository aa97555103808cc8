#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

#include "core/claimed_text.h"
#include "core/failure.h"
#include "core/text.h"
#include "reports/audit/record.h"
#include "reports/document/document_html.h"
#include "reports/document/document_text.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "schemas/common/product_files.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "trust/verification.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string receiver;
    std::string html;
    std::vector<std::string> stages;
    bool all = false;
};

void require_known(const std::string& option, const std::string& word,
                   const std::vector<std::string>& known, const std::string& what) {
    if (std::ranges::find(known, word) != known.end()) return;
    throw Failure(option, fmt::format("{} \"{}\"", what, escape_for_message(word)),
                  fmt::format("Choose one of: {}", fmt::join(known, ", ")));
}

/// Reads a run folder. Every file that one names is hashed, and held against that.
class Witnesses {
  public:
    explicit Witnesses(StageRun run) : run_(std::move(run)) {}

    const StageRun& run() const { return run_; }
    /// Whether the folder itself holds the file; a name that leads elsewhere does not count.
    bool exists(const std::string& file) const {
        return file.find('/') == std::string::npos && file.find('\0') == std::string::npos &&
               std::filesystem::exists(run_.run_dir() / file);
    }
    void note(const std::string& role, const std::string& file) {
        if (exists(file)) run_.note_file(role, file);
    }
    /// A product, nothing where it is not there. The files it names are noted too.
    template <class Reader>
    auto read(const std::string& role, const std::string& file, Reader reader)
        -> std::optional<decltype(reader(std::string_view(), std::string()))> {
        if (!exists(file)) return std::nullopt;
        auto product = run_.read(role, file, reader);
        for (const InputFile& input : product.header.inputs) {
            named_by_[input.file].push_back(file);
            note(input.role, input.file);
        }
        return product;
    }
    void finish(RunRecord& record) && {
        for (const InputFile& file : run_.inputs())
            record.files[file.file] = file;
        record.named_by = std::move(named_by_);
    }

  private:
    StageRun run_;
    std::map<std::string, std::vector<std::string>> named_by_;
};

/// Both tables of phases, row by row: their heads, the slips, and the lines of those.
void read_phases(Witnesses& witnesses, ReceiverRecord& one) {
    one.screened_phase =
        witnesses.read("screened_phase", one.screened_phase_file,
                       [&](std::string_view text, const std::string& where) {
                           auto table = open_screened_phase(text, where);
                           std::size_t number = 0;
                           for (ScreenedPhase row; table.rows.next(row); ++number)
                               if (row.statistic)
                                   one.slips.push_back({.row = row, .table_row = number});
                           return std::move(table.head);
                       });
    one.phase = witnesses.read("phase", one.phase_file,
                               [&](std::string_view text, const std::string& where) {
                                   auto table = open_phase(text, where);
                                   auto slip = one.slips.begin();
                                   std::size_t number = 0;
                                   for (PhaseRow row; table.rows.next(row); ++number) {
                                       if (slip == one.slips.end() || slip->table_row != number)
                                           continue;
                                       if (row.source_line) slip->line = *row.source_line;
                                       if (row.source_byte) slip->byte = *row.source_byte;
                                       ++slip;
                                   }
                                   return std::move(table.head);
                               });
}

ReceiverRecord read_receiver(Witnesses& witnesses, const Receiver& receiver) {
    const auto named = [&](const ProductFile& product) {
        return witnesses.run().file_of(product, receiver);
    };
    for (const AttemptFile& file : files_of_receiver(receiver))
        witnesses.note(file.role, file.name);
    ReceiverRecord one{.receiver = receiver,
                       .recording = claimed_value(recording_names(receiver)),
                       .observations_file = named(products::observations),
                       .enu_file = named(products::enu),
                       .screened_file = named(products::screened),
                       .trajectory_file = named(products::trajectory),
                       .windows_file = named(products::windows),
                       .phase_file = named(products::phase),
                       .screened_phase_file = named(products::screened_phase),
                       .imu_file = named(products::imu),
                       .surface_file = named(products::surface),
                       .attitude_file = named(products::attitude)};
    one.observations = witnesses.read("observations", one.observations_file, read_observations);
    one.enu = witnesses.read("enu", one.enu_file, read_enu);
    one.screened = witnesses.read("screened", one.screened_file, read_screened);
    if (has_phases(receiver)) read_phases(witnesses, one);
    if (has_imu(receiver))
        one.imu = witnesses.read("imu", one.imu_file,
                                 [](std::string_view text, const std::string& where) {
                                     auto table = open_imu(text, where);
                                     for (ImuRow row; table.rows.next(row);) {
                                     }
                                     return std::move(table.head);
                                 });
    if (has_surface(receiver))
        one.surface = witnesses.read("surface", one.surface_file,
                                     [](std::string_view text, const std::string& where) {
                                         auto table = open_surface(text, where);
                                         for (SurfaceRow row; table.rows.next(row);) {
                                         }
                                         return std::move(table.head);
                                     });
    if (has_imu(receiver))
        one.attitude = witnesses.read("attitude", one.attitude_file, read_attitude);
    one.trajectory = witnesses.read("trajectory", one.trajectory_file, read_trajectory);
    one.windows = witnesses.read("windows", one.windows_file, read_windows);
    return one;
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
struct AuditedReport {
    Header header;
    std::string id;
};

AuditedReport read_audited_report(const std::filesystem::path& run_dir) {
    const ReportFacts facts = read_report_facts(run_dir);
    AuditedReport report{.header = {}, .id = facts.report_id};
    report.header.stage = "report";
    report.header.program_version = facts.program_version;
    report.header.source_revision = facts.source_revision;
    for (const std::string& name : facts.subject_names)
        report.header.inputs.push_back({.role = "subject",
                                        .file = name,
                                        .sha256 = facts.subjects.at(name),
                                        .bytes = 0,
                                        .original = {}});
    return report;
}

RunRecord read_run(const std::filesystem::path& run_dir) {
    Witnesses witnesses(open_run("audit", run_dir));
    RunRecord record{.attempt = witnesses.run().attempt(),
                     .verdict_file = std::string(products::verdict_file),
                     .signatures = signatures_in(run_dir)};
    witnesses.note("attempt", std::string(attempt_copy_name));
    for (const std::string& claimed : record.attempt.profiles)
        if (witnesses.exists(profile_copy_name(claimed)))
            record.profiles.push_back(read_claimed_profile(run_dir, claimed, record.attempt));
    for (const Receiver& receiver : record.attempt.receivers)
        record.receivers.push_back(read_receiver(witnesses, receiver));
    record.verdict = witnesses.read("verdict", record.verdict_file, read_verdict);
    if (const auto report = witnesses.read(
            "report", "report.json",
            [&](std::string_view, const std::string&) { return read_audited_report(run_dir); })) {
        record.report = report->header;
        record.report_id = report->id;
    }
    const bool nothing =
        !record.verdict && !record.report &&
        std::ranges::none_of(record.receivers, [](const ReceiverRecord& one) {
            return one.observations || one.enu || one.screened || one.trajectory || one.windows;
        });
    if (nothing)
        throw Failure(run_dir.string(), "the folder holds no file of any stage",
                      "Name a folder that `runcert certify` wrote");
    std::move(witnesses).finish(record);
    return record;
}

Document audit(const Options& options) {
    for (const std::string& stage : options.stages)
        require_known("--stage", stage, audited_stages(), "there is no stage");
    const RunRecord record = read_run(options.run_dir);
    std::vector<std::string> receivers;
    for (const Receiver& receiver : record.attempt.receivers)
        receivers.push_back(receiver.id);
    if (!options.receiver.empty())
        require_known("--receiver", options.receiver, receivers, "the attempt has no receiver");
    return walk_through(record, {.stages = {options.stages.begin(), options.stages.end()},
                                 .receiver = options.receiver,
                                 .all = options.all});
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, "audit", "A walk through a run: every input, decision and result",
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder of a certified run",
                      CommandLine::Need::required);
            line.texts("--stage", options.stages, "this stage alone (may be repeated)");
            line.text("--receiver", options.receiver, "which receiver (default: all)");
            line.flag("--all", options.all, "hashes, parameters and epochs used in full");
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
