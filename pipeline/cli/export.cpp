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
    std::vector<std::string> arguments{options.run_dir, "--format", options.format};
    if (options.force) arguments.emplace_back("--force");
    return run_companion("export", arguments,
                         {{"--out", options.out},
                          {"--table", options.table},
                          {"--receiver", options.receiver},
                          {"--every", options.every}});
}

}  // namespace

void add_export(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<ExportOptions>();
    CLI::App* command =
        app.add_subcommand("export", "A run for maps (KML, GeoJSON, GPX) and spreadsheets (CSV)");
    command->add_option("RUN_DIR", options->run_dir, "folder that certify wrote")->required();
    command->add_option("--format", options->format, "kml, geojson, gpx or csv")->required();
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
        "KML and GeoJSON: the smoothed track, cut at gaps; the best window of each rule, and "
        "faster\n"
        "ones that were refused, marked so; the course's lines. GPX: the track alone. CSV: a "
        "table\n"
        "of the run, one header row, no comments. Its table rule_speeds has, for each epoch and "
        "rule,\n"
        "the speed over the rule's time or distance that ends there, by the smoothed trajectory.\n"
        "Positions are WGS 84; heights are above the\n"
        "ellipsoid, not above sea level (in KML the lines lie on the ground). A run in "
        "engineering\n"
        "coordinates is on no map: of it, only CSV. Hashes are checked.");
    command->callback([&chosen, options] { chosen = [options] { return export_run(*options); }; });
}

}  // namespace runcert
