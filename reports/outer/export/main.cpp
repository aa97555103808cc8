#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "core/failure.h"
#include "reports/export/export.h"
#include "run/attempt_files.h"
#include "run/stage_main.h"
#include "store/atomic_file.h"
#include "trust/bundle.h"

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

int export_run(const std::filesystem::path& run_dir, Options options) {
    const bool map = options.format == "kml";
    if (!options.table.empty() && map)
        throw Failure("--table", "only --format csv exports a table",
                      "Leave it out: a map is made of the trajectory");
    if (options.every != 1 && !map)
        throw Failure("--every", "a table is exported with all its rows",
                      "Leave it out, or export a map");
    if (options.table.empty()) options.table = products::trajectory.name;
    StageRun run = open_run("export", run_dir);
    const Receiver& receiver = receiver_of(run.attempt(), options.receiver);
    const std::filesystem::path out = out_file(run.attempt(), receiver, options);
    const bool printed = out == "-";
    if (!printed && !options.force && std::filesystem::exists(out))
        throw Failure(out.string(), "the file exists already",
                      "Choose another name with --out, or replace it with --force");
    const std::string text =
        map ? map_text(run, receiver, options.every) : table_text(run, receiver, options.table);
    if (!printed) write_file_atomically(out, text);
    fmt::print("{}", printed ? text : fmt::format("export    {}\n", out.string()));
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Options options;
    return reader_main(
        argc, argv, export_program.summary,
        [&](CommandLine& line) {
            line.text("RUN_DIR", options.run_dir, "folder that certify wrote, or a bundle of one",
                      CommandLine::required);
            line.word("--format", options.format, "kml or csv", {"kml", "csv"},
                      CommandLine::required);
            line.text("--out", options.out,
                      "file to write, - for standard output (default: the attempt's id with the "
                      "format's ending, here)");
            line.word("--table", options.table,
                      "of csv: observations, imu, surface, enu, screened, trajectory (default), "
                      "attitude or rule_speeds",
                      {"observations", "imu", "surface", "enu", "screened", "trajectory",
                       "attitude", of_rule_speeds});
            line.text("--receiver", options.receiver,
                      "id of the receiver (default: the first of the attempt, the one judged)");
            line.integer("--every", options.every,
                         "of a map: only every so many epochs of the track (default: 1, all)", 1,
                         1'000'000'000);
            line.flag("--force", options.force, "replace the file if it exists");
            line.footer(
                "KML: the smoothed track, cut at gaps; the best window of each rule, and faster "
                "ones that\nwere refused, marked so; the course's lines. CSV: a table of the run, "
                "one header row, no\ncomments. Its table rule_speeds has, for each epoch and rule, "
                "the speed over the rule's\ntime or distance that ends there, by the smoothed "
                "trajectory. Positions are WGS 84;\nheights are above the ellipsoid, not above sea "
                "level (in KML the lines lie on the ground).\nA run in engineering coordinates is "
                "on no map: of it, only CSV. Hashes are checked.");
        },
        [&] {
            return read_given(options.run_dir, [&](const std::filesystem::path& run_dir) {
                return export_run(run_dir, options);
            });
        });
}
