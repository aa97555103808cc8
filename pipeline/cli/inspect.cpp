#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "reports/document/document_text.h"
#include "schemas/document/document.h"
#include "store/atomic_file.h"
#include "store/process.h"

namespace runcert {
namespace {

namespace fs = std::filesystem;

struct InspectOptions {
    std::vector<std::string> recordings;
    std::string navigation;
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

/// The stage reads the recording, and says what it is as a document.
ProcessResult inspected(const std::string& recording, const std::string& navigation) {
    const TemporaryFolder folder;
    std::vector<std::string> command{(program_folder() / "runcert-import").string(), "--inspect",
                                     recording == "-" ? kept_input(folder).string() : recording};
    if (!navigation.empty()) command.push_back(navigation);
    return run_process(command);
}

/// Each by itself; the exit status is the highest of theirs.
int inspect(const InspectOptions& options) {
    int status = 0;
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const std::string& recording : options.recordings) {
        const ProcessResult said = inspected(recording, options.navigation);
        fmt::print(stderr, "{}", said.errors);
        status = std::max(status, said.exit_status);
        if (said.output.empty()) continue;
        if (options.json) {
            all.push_back(nlohmann::ordered_json::parse(said.output));
            continue;
        }
        auto document = read_members<Document>(
            YamlValue(parse_yaml(said.output, "runcert-import"), "runcert-import"));
        if (recording == "-") document.title = "standard input";
        fmt::print("{}{}", &recording == &options.recordings.front() ? "" : "\n",
                   document_text(document, terminal_columns()));
    }
    if (options.json && !all.empty())
        fmt::print("{}\n", (options.recordings.size() == 1 ? all[0] : all).dump(2, ' ', true));
    return status;
}

}  // namespace

void add_inspect(CLI::App& app, Command& chosen) {
    auto options = std::make_shared<InspectOptions>();
    CLI::App* command = app.add_subcommand("inspect", "Say what a recording is, in a few lines");
    command
        ->add_option("RECORDING", options->recordings,
                     "the recording's file; - reads what is piped in")
        ->required();
    command->add_option("--navigation", options->navigation,
                        "broadcast orbits for raw measurements (RINEX); else a .nav file of the "
                        "same name beside them");
    command->add_flag("--json", options->json,
                      "one JSON document instead of text; of several recordings a list");
    command->callback([&chosen, options] { chosen = [options] { return inspect(*options); }; });
}

}  // namespace runcert
