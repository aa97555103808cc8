#include <CLI/CLI.hpp>

#include "commands.h"

namespace runcert {
namespace {

struct ExportOptions {
    std::string run_dir;
    std::string format;
    std::string out;
    std::string table;
    std::string receiver;
    std::string every;
    bool force = false;
};

int export_run(const ExportOptions& options) {
    std::vector<std::string> arguments{"--format", options.format};
    if (options.force) arguments.emplace_back("--force");
    return run_companion("export", options.run_dir, arguments,
                         {{"--out", options.out},
                          {"--table", options.table},
                          {"--receiver", options.receiver},
                          {"--every", options.every}});
}

}  // namespace

void add_export(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command = app.add_subcommand("export", "A run for maps (KML) and spreadsheets (CSV)");
    command
        ->add_option("RUN_DIR", options->run_dir, "folder that certify wrote, or a bundle of one")
        ->required();
    command->add_option("--format", options->format, "kml or csv")->required();
    command->add_option("--out", options->out,
                        "file to write, - for standard output (default: the attempt's id with "
                        "the format's ending, here)");
    command->add_option("--table", options->table,
                        "of csv: observations, imu, surface, enu, screened, trajectory (default), "
                        "attitude or rule_speeds");
    command->add_option("--receiver", options->receiver,
                        "id of the receiver (default: the first of the attempt, the one judged)");
    command->add_option("--every", options->every,
                        "of a map: only every so many epochs of the track (default: 1, all)");
    command->add_flag("--force", options->force, "replace the file if it exists");
    command->footer(
        "KML: the smoothed track, cut at gaps; the best window of each rule, and faster ones that\n"
        "were refused, marked so; the course's lines. CSV: a table of the run, one header row, no\n"
        "comments. Its table rule_speeds has, for each epoch and rule, the speed over the rule's\n"
        "time or distance that ends there, by the smoothed trajectory. Positions are WGS 84;\n"
        "heights are above the ellipsoid, not above sea level (in KML the lines lie on the "
        "ground).\n"
        "A run in engineering coordinates is on no map: of it, only CSV. Hashes are checked.");
    command->callback([&chosen, options] { chosen = [options] { return export_run(*options); }; });
}

}  // namespace runcert
