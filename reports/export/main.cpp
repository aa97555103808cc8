#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/failure.h"
#include "reports/export/export.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "store/program.h"

using namespace runcert;

namespace {

struct Options {
    std::string run_dir;
    std::string format;
    std::string out;
    std::string table;
    std::string receiver;
    std::int64_t every = 1;
    bool force = false;
};

/// The table that no stage writes.
constexpr const char* of_rule_speeds = "rule_speeds";

std::string table_text(StageRun& run, const Receiver& receiver, const std::string& name) {
    if (name == of_rule_speeds)
        return rule_speeds_csv(run.read(products::trajectory, receiver, read_trajectory),
                               read_claimed_rules(run.run_dir(), run.attempt()));
    const ProductFile& product = *std::ranges::find(products::all, name, &ProductFile::name);
    if ((product.of_imu && !has_imu(receiver)) || (product.of_surface && !has_surface(receiver)))
        throw Failure("--table",
                      fmt::format("receiver {} has no table {}: the attempt hands in no {}",
                                  receiver.id, name, product.of_imu ? "IMU" : "surface"),
                      "Choose another table");
    const std::string file = run.file_of(product, receiver);
    return csv_text(run.read_text("table", file), (run.run_dir() / file).string());
}

std::string map_text(StageRun& run, const Receiver& receiver, std::int64_t every) {
    const TrajectoryTable trajectory = run.read(products::trajectory, receiver, read_trajectory);
    MapInput input{.attempt = &run.attempt(),
                   .receiver = &receiver,
                   .trajectory = &trajectory,
                   .every = every};
    Windows windows;
    Verdict verdict;
    if (receiver.id == run.attempt().receivers.front().id) {
        windows = run.read(products::windows, receiver, read_windows);
        verdict = run.read(products::verdict, read_verdict);
        input.windows = &windows;
        input.verdict = &verdict;
    }
    return kml_text(map_of(input));
}

std::filesystem::path out_file(const Attempt& attempt, const Receiver& receiver,
                               const Options& options) {
    if (!options.out.empty()) return options.out;
    std::string name = attempt.id;
    if (receiver.id != attempt.receivers.front().id) name += "." + receiver.id;
    if (options.format == "csv") name += "." + options.table;
    return name + "." + options.format;
}

void export_run(Options options) {
    const bool map = options.format == "kml";
    if (!options.table.empty() && map)
        throw Failure("--table", "only --format csv exports a table",
                      "Leave it out: a map is made of the trajectory");
    if (options.every != 1 && !map)
        throw Failure("--every", "a table is exported with all its rows",
                      "Leave it out, or export a map");
    if (options.table.empty()) options.table = products::trajectory.name;
    StageRun run = open_run("export", options.run_dir);
    const Receiver& receiver = receiver_of(run.attempt(), options.receiver);
    const std::filesystem::path out = out_file(run.attempt(), receiver, options);
    const bool printed = out == "-";
    if (!printed && !options.force && std::filesystem::exists(out))
        throw Failure(out.string(), "the file exists already",
                      "Choose another name with --out, or replace it with --force");
    const std::string text =
        map ? map_text(run, receiver, options.every) : table_text(run, receiver, options.table);
    if (printed) return fmt::print("{}", text);
    write_file_atomically(out, text);
    fmt::print("export    {}\n", out.string());
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, "export", "A run for maps and spreadsheets",
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder of a certified run",
                      CommandLine::Need::required);
            line.word("--format", options.format, "kml or csv", {"kml", "csv"},
                      CommandLine::Need::required);
            line.text("--out", options.out, "file to write, - for standard output");
            line.word("--table", options.table, "of csv: which table",
                      {"observations", "imu", "surface", "enu", "screened", "trajectory",
                       "attitude", of_rule_speeds});
            line.text("--receiver", options.receiver, "which receiver (default: the first)");
            line.integer("--every", options.every, "of a map: every so many epochs", 1,
                         1'000'000'000);
            line.flag("--force", options.force, "replace the file if it exists");
        },
        [&]() -> int {
            export_run(options);
            return 0;
        });
}
