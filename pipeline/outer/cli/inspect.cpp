#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/recognised.h"
#include "core/failure.h"
#include "core/text.h"
#include "outer_commands.h"
#include "reports/document/document_text.h"
#include "reports/inspection/described.h"
#include "schemas/document/document.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct InspectOptions {
    std::vector<std::string> recordings;
    std::string navigation;
    std::string plot;
    bool json = false;
};

/// What is piped in, as a file: its kind is known by its content.
fs::path kept_input(const TemporaryFolder& folder) {
    const fs::path file = folder.path() / "standard-input";
    std::ostringstream text;
    text << std::cin.rdbuf();
    write_file_unsynced(file, text.str());
    return file;
}

/// Writes the page on which a recording is drawn. Failure if it cannot be read or drawn.
void write_plot(const std::string& recording, const Document& document, const fs::path& file) {
    const ProcessResult track =
        run_process({(program_folder() / "runcert-import").string(), "--track", recording});
    fmt::print(stderr, "{}", track.errors);
    if (track.exit_status != 0)
        throw Failure(recording, "nothing of it can be drawn",
                      "Give a recording of positions that inspect reads by itself");
    write_file_atomically(file,
                          inspection_page(document, nlohmann::ordered_json::parse(track.output)));
}

/// Failure if the page would take the place of another file, or there is more than one recording.
void require_place_for_plot(const InspectOptions& options) {
    if (options.plot.empty()) return;
    if (options.recordings.size() > 1)
        throw Failure("--plot", "several recordings do not go on one page",
                      "Give one recording for each call");
    if (!options.plot.ends_with(".html"))
        throw Failure("--plot",
                      fmt::format("\"{}\" is no name for a page", escape_for_message(options.plot)),
                      "Give a name that ends with .html");
    if (fs::exists(fs::symlink_status(options.plot)))
        throw Failure(options.plot, "the file exists; nothing was written",
                      "Give another name, or remove the file first");
}

/// Each by itself; the exit status is the highest of theirs.
int inspect(const InspectOptions& options) {
    int status = 0;
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    require_place_for_plot(options);
    const TemporaryFolder folder;
    for (const std::string& recording : options.recordings) {
        const std::string file = recording == "-" ? kept_input(folder).string() : recording;
        const Recognised described = recognise(file, "{}", options.navigation);
        fmt::print(stderr, "{}", described.said.errors);
        status = std::max(status, described.said.exit_status);
        if (described.said.output.empty()) continue;
        const Document document =
            description_of(described.is, recording == "-" ? "standard input" : recording);
        if (!options.plot.empty()) write_plot(file, document, options.plot);
        if (options.json) {
            all.push_back(nlohmann::ordered_json::parse(described.said.output));
            continue;
        }
        fmt::print("{}{}", &recording == &options.recordings.front() ? "" : "\n",
                   document_text(document, terminal_columns()));
    }
    if (options.json && !all.empty())
        fmt::print("{}\n", (options.recordings.size() == 1 ? all[0] : all).dump(2, ' ', true));
    return status;
}

}  // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    auto [line, options] = add_command<InspectOptions>(
        app, chosen, "inspect", "Say what a recording is, in a few lines", inspect);
    line.texts("RECORDING", options.recordings, "the recording's file; - reads what is piped in",
               CommandLine::required);
    line.text(
        "--navigation", options.navigation,
        "broadcast orbits for raw measurements (RINEX); else a .nav file of the same name beside "
        "them");
    line.flag("--json", options.json,
              "one JSON document instead of text; of several recordings a list");
    line.text("--plot", options.plot,
              "draw speed, track, height, stated uncertainty and gaps as one page (HTML)");
}

}  // namespace runcert
