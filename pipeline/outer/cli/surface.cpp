#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/failure.h"
#include "core/text.h"
#include "outer_commands.h"
#include "run/run_lock.h"
#include "run/stage_run.h"
#include "schemas/observations/observations.h"
#include "store/atomic_file.h"
#include "store/program.h"
#include "surface_of_runs/surface_of_runs.h"

namespace runcert {
namespace {

struct SurfaceOptions {
    std::vector<std::string> runs;
    std::string out;
    bool force = false;
};

/// What a surface takes from a run: its judged receiver's positions, and what they come from.
struct ReadRun {
    EarlierRun run;
    ScreenedTable positions;
    InputFile input;
};

ReadRun read_run(const std::filesystem::path& folder) {
    const RunLock lock(folder, RunUse::reads);
    StageRun run = open_run("surface", folder);
    const Receiver& receiver = run.attempt().receivers.front();
    if (!receiver.antenna_height_m)
        throw Failure(receiver.place,
                      fmt::format("the attempt \"{}\" does not say how high its antenna is above "
                                  "the ground",
                                  run.attempt().id),
                      "Add antenna_height_m to its receiver, as measured by tape, and certify it "
                      "again");
    const std::string& id = run.attempt().id;
    ReadRun read{
        .run = {.id = id, .recordings = {}, .antenna_height_m = *receiver.antenna_height_m},
        .positions = run.read(products::screened, receiver, read_screened),
        .input = run.inputs().back()};
    read.input.file = id + "/" + read.input.file;
    const auto observations = run.open(products::observations, receiver, open_observations);
    for (const InputFile& input : observations.head().header.inputs)
        if (input.role == "recording") read.run.recordings.push_back(input.sha256);
    return read;
}

int make_surface(const SurfaceOptions& options) {
    const std::filesystem::path out = options.out;
    if (std::filesystem::exists(std::filesystem::symlink_status(out)) && !options.force)
        throw Failure(out.string(), "the file exists already",
                      "Choose another name with --out, or replace it with --force");
    std::vector<ReadRun> read;
    for (const std::string& folder : options.runs)
        read.push_back(read_run(folder));
    std::vector<EarlierRun> runs;
    Header header;
    header.stage = "surface";
    header.program_version = program_version();
    header.source_revision = source_revision();
    header.parameters = nlohmann::ordered_json::object();
    for (ReadRun& one : read) {
        one.run.positions = &one.positions;
        runs.push_back(one.run);
        header.inputs.push_back(one.input);
    }
    SurfaceTable table = surface_of_runs(runs);
    table.header = std::move(header);
    write_file_atomically(out, write_surface(table));
    fmt::print("surface   {}\ntriangles {}, {} m2\nscatter   {} m\n", out.string(),
               table.found.triangles, format_fixed(table.found.area_m2, 0),
               format_fixed(table.vertical_sd_m, 3));
    for (const SurfaceRun& run : table.made_from)
        fmt::print("run       {}: {} positions\n", plain_text(run.id), run.positions);
    return 0;
}

}  // namespace

void add_surface(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<SurfaceOptions>(
        app, chosen, "surface", "Make the surface of a course from earlier runs over it",
        make_surface);
    line.texts("RUN", options.runs, "folders of certified runs over the course",
               CommandLine::required);
    line.text("--out", options.out, "file to write (ECSV)", CommandLine::required);
    line.flag("--force", options.force, "replace the file if it exists");
    line.footer(
        "The ground under the first receivers of the runs: heights on a grid of 5 m, by least\n"
        "squares. What has no positions on both sides is left out; five runs that cover the width\n"
        "of the course suffice. Each attempt states antenna_height_m.\n\n"
        "Another attempt names the file as its surface:\n\n"
        "  receivers:\n"
        "    - id: primary\n"
        "      antenna_height_m: 1.2\n"
        "      surface: {file: course.ecsv, source: runs of the day before}\n\n"
        "The file names the recordings that it was made from. An attempt with one of these is\n"
        "refused: a run cannot check itself.");
}

}  // namespace runcert
