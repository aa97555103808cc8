#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <set>

#include "core/failure.h"
#include "files/program.h"
#include "run/evidence.h"
#include "run/stage_main.h"
#include "schemas/trajectory/trajectory.h"
#include "stages/audit/audit.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string receiver;
    bool all = false;
};

std::vector<Receiver> chosen_receivers(const Attempt& attempt, const Options& options) {
    if (options.receiver.empty()) return attempt.receivers;
    std::string known;
    for (const Receiver& receiver : attempt.receivers) {
        if (receiver.id == options.receiver) return {receiver};
        known += (known.empty() ? "" : ", ") + receiver.id;
    }
    throw Failure("--receiver", "the attempt has no receiver \"" + options.receiver + "\"",
                  "Choose one of: " + known);
}

/// Reads what a run folder holds of one receiver, so that every hash that one file names of another
/// is checked.
class Witnesses {
  public:
    explicit Witnesses(StageRun run) : run_(std::move(run)) {}

    /// A file that others name.
    void note(const std::string& role, const std::string& file) {
        if (std::find(files_.begin(), files_.end(), file) != files_.end()) return;
        files_.push_back(file);
        if (!exists(file)) return;
        run_.note_file(role, file);
        noted_.insert(file);
    }
    /// One that names others; nothing where it is not there.
    template <class Reader>
    auto read(const std::string& role, const std::string& file, Reader reader)
        -> std::optional<decltype(reader(std::string_view(), std::string()))> {
        if (!exists(file)) return std::nullopt;
        auto table = run_.read(role, file, reader);
        noted_.insert(file);
        for (const InputFile& input : table.header.inputs)
            named_.insert(input.file);
        return table;
    }
    /// The files noted that were checked, or were not.
    std::vector<std::string> files(bool checked) const {
        std::vector<std::string> some;
        for (const std::string& file : files_)
            if ((noted_.contains(file) && named_.contains(file)) == checked) some.push_back(file);
        return some;
    }

  private:
    bool exists(const std::string& file) const {
        return std::filesystem::exists(run_.run_dir() / file);
    }

    StageRun run_;
    std::vector<std::string> files_;
    std::set<std::string> noted_;
    std::set<std::string> named_;
};

std::string audit_receiver(const StageRun& run, const Receiver& receiver, bool all) {
    const auto product = [&](std::string_view stem) {
        return product_file(run.attempt(), receiver, stem, "ecsv");
    };
    Witnesses witnesses(run);
    witnesses.note("attempt", std::string(evidence_attempt_file));
    for (const EvidenceFile& file : evidence_files(receiver))
        witnesses.note(file.role, file.name);
    for (const EvidenceFile& file : solution_files(receiver))
        witnesses.note(file.role, file.name);
    witnesses.note("observations", product("1-observations"));
    witnesses.note("enu", product("2-enu"));
    witnesses.note("screened", product("3-screened"));
    const auto table = witnesses.read("screened", product("3-screened"), read_screened);
    if (!table)
        throw Failure((run.run_dir() / product("3-screened")).string(),
                      "the run folder does not hold the decisions of screening",
                      "Name a folder that `runcert certify` wrote");
    for (const InputFile& input : table->header.inputs)
        witnesses.note(input.role, input.file);
    witnesses.read("observations", product("1-observations"), read_observations);
    witnesses.read("enu", product("2-enu"), read_enu);
    witnesses.read("trajectory", product("4-trajectory"), read_trajectory);
    return audit_text(*table,
                      {.attempt = run.attempt().id,
                       .recording = recording_names(receiver),
                       .checked = witnesses.files(true),
                       .unchecked = witnesses.files(false)},
                      all);
}

std::string audit_run(const Options& options) {
    const std::filesystem::path run_dir(options.run_dir);
    if (!std::filesystem::is_directory(run_dir))
        throw Failure(options.run_dir, "there is no such run folder",
                      "Name a folder that `runcert certify` wrote");
    const StageRun run("audit", run_dir / evidence_attempt_file, run_dir);
    std::string text;
    for (const Receiver& receiver : chosen_receivers(run.attempt(), options))
        text += (text.empty() ? "" : "\n\n") + audit_receiver(run, receiver, options.all);
    return text;
}

}  // namespace

int main(int argc, char** argv) {
    return guarded_main([&]() -> int {
        CLI::App app("Every decision of screening in plain words", "runcert-audit");
        Options options;
        app.add_option("RUN_DIR", options.run_dir, "folder of a certified run")->required();
        app.add_option("--receiver", options.receiver, "which receiver (default: all)");
        app.add_flag("--all", options.all, "the epochs used too, one by one");
        app.set_version_flag("--version",
                             fmt::format("{} {}", program_version(), source_revision()));
        try {
            app.parse(argc, argv);
        } catch (const CLI::Success& help) {
            return app.exit(help);
        }
        fmt::print("{}", audit_run(options));
        return 0;
    });
}
